#pragma once

#include <cstdint>
#include <vector>

#include "model/scene.h"
#include "slicing/slab.h"
#include "slicing/span/row_columns.h"

namespace lamella::span {

/// Over what length, mm, hits of a solid may come in the wrong order.
[[nodiscard]] double order_tolerance(const Solid& solid);

/// Sweeps over the rows of a lattice with the columns that cross each, ascending in x, and writes the spans between
/// them. From one row on which a column begins or ends to the next, the same columns are crossed, nearly always in the
/// same order: then each solid's spans are bounded by the same columns too, so that only xs are left to be written.
/// Where two solids touch, rounding orders their crossings anew on every row; that matters to neither's bounds, so only
/// those of each solid, and the entries of all spans, must keep their order.
class RowSweep {
 public:
  explicit RowSweep(const Scene& scene);

  /// Writes the spans of all rows; counts rows that aren't closed or whose winding leaves {0, 1} and notes them as
  /// failed.
  void sweep(const RowColumns& columns, SpanRows& rows, LayerSpans& out);

 private:
  /// A column that crosses the current row.
  struct Crossing {
    const double* xs = nullptr;  ///< from the current row on
    const Column* column = nullptr;

    [[nodiscard]] bool is_before(const Crossing& other) const {
      return *xs != *other.xs ? *xs < *other.xs : column->tag < other.column->tag;
    }
  };
  /// A span between two of the crossings, numbers in crossings_.
  struct Bounds {
    std::uint32_t enters = 0;
    std::uint32_t leaves = 0;
  };
  /// Crossings whose order decides on bounds_, numbers in crossings_.
  struct Order {
    std::uint32_t before = 0;
    std::uint32_t after = 0;
  };
  struct SolidState {
    std::int32_t winding = 0;
    std::uint32_t last = 0;  ///< its last crossing so far, if it was met
    std::uint64_t met = 0;   ///< number of the search in which it was
    std::size_t open = 0;    ///< its last span
    double off_since = 0.0;  ///< where its winding left {0, 1}
    double tolerance = 0.0;  ///< mm: how long it may be off
  };

  void start(const RowColumns& columns, SpanRows& rows);
  void end_columns(std::uint32_t row);
  std::size_t begin_columns(const RowColumns& columns, std::uint32_t row);
  [[nodiscard]] std::uint32_t next_change(std::uint32_t row) const;
  void sort_crossings(std::size_t added);
  void find_bounds();
  void find_order();
  void write_run(std::uint32_t row, std::uint32_t end, std::uint64_t* row_end, LayerSpans& out);
  std::size_t rows_in_order(std::size_t count);
  void write_rows(std::size_t count, std::uint64_t* row_end, LayerSpans& out);
  void write_bounded(std::size_t count, std::uint64_t* row_end);
  void write_by_winding(std::uint64_t* row_end, LayerSpans& out);
  void close_solids(LayerSpans& out);
  void note_winding(const Column& column, std::int32_t before, double x, LayerSpans& out);

  std::vector<std::uint32_t> begins_at_;   ///< per row: 1 + number of a column that begins on it, 0 for none
  std::vector<std::uint32_t> begins_too_;  ///< per column: the same, for another one on the same row
  std::vector<Crossing> crossings_;        ///< of the current row, ascending
  std::vector<Bounds> bounds_;             ///< in the order of their entries
  std::vector<Order> order_;
  std::uint64_t searches_ = 0;
  bool is_regular_ = true;   ///< no solid's winding leaves {0, 1}; else there are no bounds_
  bool has_ties_ = false;    ///< among the rows last looked at
  std::vector<Span> spans_;  ///< room for as many as there can be
  std::size_t span_count_ = 0;
  std::vector<SolidState> solids_;
};

}  // namespace lamella::span
