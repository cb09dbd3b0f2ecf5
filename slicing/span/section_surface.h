#pragma once

#include <vector>

#include "core/geometry.h"
#include "model/curve.h"
#include "model/evaluate.h"
#include "model/surface.h"

namespace lamella::span {

/// One smooth part of a surface: the Bezier piece number along u and v; zeros for surfaces that are smooth all over.
struct Cell {
  int u = 0;
  int v = 0;

  bool operator==(const Cell&) const = default;
};

/// Rational Bezier nets of a surface or curve, evaluated with second derivatives.
/// Poles are kept relative to an origin near the part, (w (x - o), w), so that parts far from the origin keep digits.
class BezierNets {
 public:
  BezierNets() = default;
  explicit BezierNets(const BSplineSurface& surface);
  explicit BezierNets(const BSplineCurve<3>& curve);

  [[nodiscard]] const std::vector<double>& breaks_u() const { return breaks_u_; }
  [[nodiscard]] const std::vector<double>& breaks_v() const { return breaks_v_; }
  [[nodiscard]] SurfacePoint2 evaluate(const Vec2& uv, const Cell& cell) const;
  /// For nets of a curve.
  [[nodiscard]] CurvePoint2<3> evaluate(double t, int cell) const;

 private:
  int degree_u_ = 0;
  int degree_v_ = 0;
  std::vector<double> breaks_u_;
  std::vector<double> breaks_v_;
  std::vector<Vec4> poles_;  ///< net of cell (i, j) begins at (i * cells_v + j) * (degree_u + 1) * (degree_v + 1)
  Vec3 origin_ = Vec3::Zero();
};

/// A face's surface as the tracer needs it: first and second derivatives, cell by cell. A cell's own limits are not
/// limits of its evaluation: beyond them the piece goes on analytically.
class SectionSurface {
 public:
  /// `surface` must outlive this.
  explicit SectionSurface(const Surface& surface);

  [[nodiscard]] SurfacePoint2 evaluate(const Vec2& uv, const Cell& cell) const;

  /// The cell that holds `uv`; on a break the one that a step along `heading` enters.
  [[nodiscard]] Cell find_cell(const Vec2& uv, const Vec2& heading) const;

  /// Limits of a cell along u (axis 0) or v (axis 1), infinite where the surface has none.
  [[nodiscard]] Interval limits(const Cell& cell, int axis) const;
  /// Whether there is another cell beyond the cell's upper (or lower) limit.
  [[nodiscard]] bool has_neighbor(const Cell& cell, int axis, bool upper) const;

  [[nodiscard]] bool has_cells() const { return !breaks_u_.empty() || !breaks_v_.empty(); }
  /// Whether second derivatives agree on both sides of every limit between cells.
  [[nodiscard]] bool is_smooth() const { return is_smooth_; }

  [[nodiscard]] const Vec2& periods() const { return periods_; }
  [[nodiscard]] const Surface& surface() const { return *surface_; }

 private:
  [[nodiscard]] CurvePoint2<3> basis_point(double t, int cell) const;
  [[nodiscard]] const std::vector<double>& breaks(int axis) const { return axis == 0 ? breaks_u_ : breaks_v_; }

  enum class Kind { analytic, spline, extrusion, revolution };

  const Surface* surface_;
  Kind kind_ = Kind::analytic;
  bool is_smooth_ = true;
  bool has_nets_ = false;  ///< the basis or meridian is a B-spline
  BezierNets nets_;
  std::vector<double> breaks_u_;  ///< ascending, empty where there are no cells
  std::vector<double> breaks_v_;
  Vec2 periods_ = Vec2::Zero();
};

}  // namespace lamella::span
