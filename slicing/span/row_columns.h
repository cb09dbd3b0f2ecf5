#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "model/scene.h"
#include "slicing/slab.h"
#include "slicing/span/depth_kernel.h"
#include "slicing/span/section.h"

namespace lamella::span {

/// Successive stretches of one arc over which y runs one way: a crossing on each of a run of rows.
struct Column {
  std::uint32_t tag = 0;        ///< 2 * arc + (1 for an exit): settles the order of crossings at the same x
  std::uint32_t first_row = 0;  ///< rows [first_row, last_row), from 0
  std::uint32_t last_row = 0;
  std::uint32_t failed = 0;  ///< rows that don't meet the arc
  std::size_t first_x = 0;   ///< its first row's x; the other rows' follow
  SolidId solid;
  FaceId face;

  [[nodiscard]] std::uint32_t arc() const { return tag >> 1; }
  [[nodiscard]] bool is_exit() const { return (tag & 1) != 0; }
  [[nodiscard]] std::uint32_t rows() const { return last_row - first_row; }
};

/// The crossings of a layer's arcs with the rows of a lattice, column by column in the order of the arcs. Memory is
/// reused from layer to layer.
class RowColumns {
 public:
  /// Finds the rows that each arc crosses, and where.
  void find(const Scene& scene, const Section& section, const RowLattice& lattice);

  [[nodiscard]] std::size_t rows() const { return rows_.size(); }
  [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }
  [[nodiscard]] const double* xs(const Column& column) const { return xs_.data() + column.first_x; }

 private:
  /// What a stretch is a part of.
  enum class Shape : std::uint8_t { quintic, straight, round };
  struct Stretch {
    std::uint32_t column = 0;
    std::uint32_t piece = 0;  ///< index in rounds_ for Shape::round
    std::uint32_t first_row = 0;
    std::uint32_t last_row = 0;
    double t_begin = 0.0;
    double t_end = 1.0;
    Shape shape = Shape::quintic;
  };
  /// The arc whose stretches are being collected.
  struct Source {
    std::uint32_t arc = 0;
    SolidId solid;
    FaceId face;
    std::size_t first_column = 0;
  };

  void lay_rows(const RowLattice& lattice);
  void turn_pieces(const Section& section, const RowLattice& lattice);
  void collect(const Scene& scene, const Section& section, const RowLattice& lattice);
  void collect_ellipse(const SectionArc& arc, const EllipseArc& part, const Source& source, const RowLattice& lattice);
  void collect_pieces(const SectionArc& arc, const Source& source, const RowLattice& lattice);
  void add_stretch(const Source& source, std::uint32_t from_row, std::uint32_t to_row, Stretch stretch);
  [[nodiscard]] std::uint32_t first_row_at(double y) const;
  void solve();
  void add_tasks(std::span<const Stretch> parts, const Column& column);
  void solve_directly(const Stretch& part, const Column& column);

  std::vector<double> rows_;  ///< y of each row
  double inverse_spacing_ = 1.0;
  std::vector<ArcPiece> turned_;  ///< pieces in the lattice's axes, when those aren't the machine's
  const ArcPiece* pieces_ = nullptr;
  std::vector<Stretch> stretches_;
  std::vector<RoundTask> rounds_;
  std::vector<Column> columns_;
  std::size_t quintic_rows_ = 0;  ///< crossings of quintics, whose xs come first
  std::size_t other_rows_ = 0;
  std::vector<DepthTask> tasks_;
  std::vector<std::uint32_t> task_columns_;
  std::vector<double> xs_;
};

}  // namespace lamella::span
