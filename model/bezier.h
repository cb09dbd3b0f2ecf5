#pragma once

#include <span>
#include <utility>
#include <vector>

#include "core/geometry.h"
#include "model/surface.h"

namespace lamella {

/// Stated limits of the exact model; beyond them reading throws GeometryError.
inline constexpr int kMaxDegree = 25;
inline constexpr double kMaxWeightRatio = 1e9;  ///< largest over smallest weight of one surface

/// A rational tensor-product Bezier net over [u.lo, u.hi] x [v.lo, v.hi].
/// net[i * (degree_v + 1) + j] = (w x, w y, w z, w), i along u. All w > 0.
struct BezierPatch {
  int degree_u = 0;
  int degree_v = 0;
  Interval u;
  Interval v;
  std::vector<Vec4> net;
};

/// A rational Bezier curve piece over [t.lo, t.hi]; net[i] = (w x, w y, w), all w > 0. t.lo > t.hi in a piece that
/// runs against its curve's parameter.
struct BezierCurve2 {
  Interval t;
  std::vector<Vec3> net;
};

/// Inserts `new_knots` (ascending, inside the domain, repeats allowed) by the Oslo algorithm (Cohen, Lyche,
/// Riesenfeld 1980; paper, step 2). The surface's shape and parametrisation don't change.
[[nodiscard]] BSplineSurface refine_u(const BSplineSurface& surface, std::span<const double> new_knots);
[[nodiscard]] BSplineSurface refine_v(const BSplineSurface& surface, std::span<const double> new_knots);

/// All non-degenerate Bezier pieces, u-major, their domains tiling the surface's. By Oslo insertion to full
/// multiplicity.
[[nodiscard]] std::vector<BezierPatch> split_to_bezier(const BSplineSurface& surface);

/// The two halves of a patch at parameter `u` (or `v`), by the Oslo algorithm's special case, de Casteljau.
[[nodiscard]] std::pair<BezierPatch, BezierPatch> split_u(const BezierPatch& patch, double u);
[[nodiscard]] std::pair<BezierPatch, BezierPatch> split_v(const BezierPatch& patch, double v);
/// The part of the patch over a smaller parameter rectangle (clamped to the patch's own).
[[nodiscard]] BezierPatch restrict_to(const BezierPatch& patch, Interval u, Interval v);

/// Box of the control net; holds the whole patch by the convex-hull property.
[[nodiscard]] Box3 control_box(const BezierPatch& patch);

/// Largest distance in mm between the patch and the bilinear patch of its corners, bounded from the control net.
/// Rational patches included: what their weights move along the bilinear patch is bounded as well.
[[nodiscard]] double flatness(const BezierPatch& patch);

[[nodiscard]] Vec3 evaluate_point(const BezierPatch& patch, double u, double v);

/// (w x, w y, w z, w) and its first derivatives by the patch's parameters u and v.
struct HomogeneousPoint {
  Vec4 value;
  Vec4 du;
  Vec4 dv;
};
[[nodiscard]] HomogeneousPoint evaluate_homogeneous(const BezierPatch& patch, double u, double v);

/// Point of the piece at `t` in its interval `curve.t`.
[[nodiscard]] Vec2 evaluate_point(const BezierCurve2& curve, double t);
/// The two halves at `t`; they share the point there bit for bit.
[[nodiscard]] std::pair<BezierCurve2, BezierCurve2> split(const BezierCurve2& curve, double t);
/// Box of the control points; holds the piece.
[[nodiscard]] Box2 control_box(const BezierCurve2& curve);
/// The same piece run through the other way; `t` runs from its high to its low end.
[[nodiscard]] BezierCurve2 reversed(BezierCurve2 curve);

}  // namespace lamella
