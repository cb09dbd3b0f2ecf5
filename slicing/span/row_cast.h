#pragma once

#include <cstdint>
#include <vector>

#include "model/scene.h"
#include "slicing/slab.h"
#include "slicing/span/depth_kernel.h"
#include "slicing/span/section.h"

namespace lamella::span {

/// Scan conversion of the sections of one layer: from arcs to the spans of every row.
///
/// Each stretch of an arc over which y runs one way covers the rows between its two heights, half open; neighbours
/// share their heights bit for bit, and so do the arcs that meet in a node. So on every row the crossings up and down
/// cancel in integers, however inaccurate the arcs are. Memory is reused from layer to layer.
class RowCast {
 public:
  explicit RowCast(const Scene& scene);

  /// `section` holds the arcs of all solids on the layer. Writes the spans of lattice number `number` of the layer, and
  /// adds to its counters and failed checks.
  void cast(const Section& section, const RowLattice& lattice, std::size_t number, LayerSpans& out);

 private:
  /// Rows [first_row, last_row), from 0, that a stretch covers.
  struct Stretch {
    std::uint32_t arc = 0;
    std::uint32_t piece = 0;
    std::uint32_t first_row = 0;
    std::uint32_t last_row = 0;
    double t_begin = 0.0;
    double t_end = 1.0;
    bool rises = false;
    bool is_round = false;  ///< `piece` is an index in rounds_
  };
  struct RowHit {
    double x;
    std::uint32_t tag;  ///< 2 * arc + (1 for an exit)
  };

  void lay_rows(const RowLattice& lattice);
  void turn_pieces(const Section& section, const RowLattice& lattice);
  void collect(const Section& section, const RowLattice& lattice);
  void collect_ellipse(const SectionArc& arc, const EllipseArc& ellipse, std::uint32_t index,
                       const RowLattice& lattice);
  void collect_arc(const SectionArc& arc, std::uint32_t index, const RowLattice& lattice);
  void add_stretch(std::uint32_t arc, std::uint32_t piece, double y_begin, double y_end, double t_begin, double t_end);
  [[nodiscard]] std::uint32_t first_row_at(double y) const;
  std::size_t solve(const Stretch& stretch, bool straight, double* xs) const;
  void note_winding(SolidId solid, FaceId face, std::int32_t before, double x, LayerSpans& out);
  void check_balance(const Section& section, const RowLattice& lattice);
  void fill(const Section& section, LayerSpans& out);
  void fill_straight(const Stretch& stretch, double* xs) const;
  void emit(const Section& section, SpanRows& rows, LayerSpans& out);
  void emit_row(const Section& section, RowHit* first, RowHit* last, SpanRows& rows, LayerSpans& out);

  const Scene* scene_;
  std::vector<double> rows_;  ///< y of each row
  double inverse_spacing_ = 1.0;
  std::vector<ArcPiece> turned_;  ///< pieces in the lattice's axes, when those aren't the machine's
  const ArcPiece* pieces_ = nullptr;
  std::vector<Stretch> stretches_;
  std::vector<RoundTask> rounds_;
  std::vector<std::uint32_t> row_begin_;  ///< per row: first hit; one more at the end
  std::vector<std::uint32_t> cursor_;
  std::vector<RowHit> hits_;
  std::vector<double> xs_;
  std::vector<SolidId> solid_of_arc_;
  std::vector<std::uint8_t> is_unbalanced_;  ///< per arc
  std::vector<std::int32_t> winding_;        ///< per solid
  std::vector<std::uint64_t> open_span_;     ///< per solid
  std::vector<double> off_since_;            ///< per solid: where its winding left {0, 1}
  std::vector<double> tolerance_;            ///< per solid, mm: how long it may be off
};

}  // namespace lamella::span
