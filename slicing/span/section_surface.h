#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/geometry.h"
#include "model/evaluate.h"
#include "model/surface.h"
#include "slicing/span/bezier_nets.h"

namespace lamella::span {

/// Share of a cell by which a point beyond its limit is still on it: rounding only. At a corner of four cells more
/// would let a section over two limits at once.
inline constexpr double kCellSlack = 1e-12;

/// One part of a surface within which it has continuous second derivatives, by its number along u and v; zeros for
/// surfaces that are smooth all over. Knots of less continuity are the limits between cells; arcs have points on them.
struct Cell {
  int u = 0;
  int v = 0;

  bool operator==(const Cell&) const = default;
};

/// A place on a surface, as one of its cells sees it.
struct CellPlace {
  Vec2 uv = Vec2::Zero();
  Cell cell;
};

/// A face's surface as the tracer needs it: first and second derivatives, cell by cell. A cell's own limits are not
/// limits of its evaluation: beyond them the piece goes on analytically.
class SectionSurface {
 public:
  /// `surface` must outlive this.
  explicit SectionSurface(const Surface& surface);

  [[nodiscard]] SurfacePoint2 evaluate(const Vec2& uv, const Cell& cell) const;
  /// Without second derivatives, for less.
  [[nodiscard]] SurfacePoint evaluate_slopes(const Vec2& uv, const Cell& cell) const;

  /// The same at some places, at most kLanes, each in its own cell: in the first lanes of `out`.
  void evaluate_lanes(std::span<const CellPlace> places, bool bends, JetLanes& out) const;

  /// The cell that holds `uv`; on a break, or nearer to one than rounding, the one that a step along `heading` enters.
  [[nodiscard]] Cell find_cell(const Vec2& uv, const Vec2& heading) const;

  /// Limits of a cell along u (axis 0) or v (axis 1), infinite where the surface has none.
  [[nodiscard]] Interval limits(const Cell& cell, int axis) const;
  /// Whether `uv` lies in a cell, to rounding; along `free_axis` it may lie anywhere (-1: along none).
  [[nodiscard]] bool holds(const Cell& cell, const Vec2& uv, int free_axis) const;
  /// Whether a point of a cell lies so near to one of its limits that it may as well be in the cell beyond.
  [[nodiscard]] bool is_near_limit(const Cell& cell, const Vec2& uv) const;
  /// Whether there is another cell beyond the cell's upper (or lower) limit.
  [[nodiscard]] bool has_neighbor(const Cell& cell, int axis, bool upper) const;

  [[nodiscard]] bool has_cells() const { return !breaks_[0].empty() || !breaks_[1].empty(); }
  /// Whether there is more than one.
  [[nodiscard]] bool is_divided() const { return breaks_[0].size() > 2 || breaks_[1].size() > 2; }
  /// Whether a knot with continuous second derivatives lies between two points of one cell.
  [[nodiscard]] bool crosses_knot(const Vec2& a, const Vec2& b, const Cell& cell) const;
  /// Limits along one axis of the polynomial piece that a step from `place` along `heading` runs in. Between pieces of
  /// one cell second derivatives are continuous, the next ones are not.
  [[nodiscard]] Interval piece_limits(int axis, double place, double heading, const Cell& cell) const;

  /// Period along u or v, or the length of a spline's domain; infinite where there is neither.
  [[nodiscard]] double extent(int axis) const;
  [[nodiscard]] const Vec2& periods() const { return periods_; }
  [[nodiscard]] const Surface& surface() const { return *surface_; }

 private:
  [[nodiscard]] CurvePoint2<3> basis_point(double t, int piece) const;
  /// Bezier piece along one axis that serves a place in a cell.
  [[nodiscard]] int piece_of(int axis, double place, int cell) const {
    if (pieces_[axis].empty()) return 0;
    return pieces_[axis].part_of(place, first_piece_[axis][cell], first_piece_[axis][cell + 1]);
  }
  void set_breaks(int axis, const Breaks& pieces, const std::vector<double>& knots, int degree);

  enum class Kind { analytic, spline, extrusion, revolution };

  const Surface* surface_;
  Kind kind_ = Kind::analytic;
  SurfaceNets nets_;              ///< of a spline
  CurveNets<3> basis_;            ///< of an extrusion's basis or a meridian that is a spline
  std::array<Breaks, 2> pieces_;  ///< limits of the Bezier pieces along u and v; empty where there are none
  std::array<std::vector<double>, 2> breaks_;    ///< limits of the cells
  std::array<std::vector<int>, 2> first_piece_;  ///< of each cell, and one more
  Vec2 periods_ = Vec2::Zero();
};

}  // namespace lamella::span
