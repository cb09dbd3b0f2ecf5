#pragma once

#include "core/geometry.h"
#include "model/bezier.h"
#include "model/surface.h"

namespace lamella {

/// A face's surface as rational Bezier nets that cover its (u, v) bounds.
///
/// Analytic surfaces are converted exactly (circles as rational quadratics in arcs of at most 90 degrees), so that the
/// net parameters (s, t) differ from the surface's own (u, v) by a monotone map of each coordinate alone.
struct RationalForm {
  std::vector<BezierPatch> patches;

  /// How one coordinate of the nets maps to the surface's own.
  enum class Map {
    same,      ///< u = s
    angle,     ///< s = angle breakpoint index + rational parameter in [0,1]; u from tan of the half angle
    hyperbola  ///< u = 2 atanh of the rational parameter, as for cosh / sinh meridians
  };
  Map map_u = Map::same;
  Map map_v = Map::same;
  std::vector<double> breaks_u;  ///< surface parameters at the integer s, for Map::angle and Map::hyperbola
  std::vector<double> breaks_v;

  [[nodiscard]] Vec2 to_surface(const Vec2& st) const;
  [[nodiscard]] Vec2 from_surface(const Vec2& uv) const;
};

/// Converts the part of `surface` over `uv_bounds` (padded outward by nothing: the caller pads); what lies beyond a
/// B-spline's domain or a sphere's poles is left out. Patches tile the rest, u-major; bounds without area give none.
/// Exact up to rounding, about 1e-15 of the distance from the origin. Throws GeometryError beyond kMaxDegree or
/// kMaxWeightRatio, for bounds that are not finite or beyond 1e10, and for surfaces that would need too many patches.
[[nodiscard]] RationalForm rational_form(const Surface& surface, const Box2& uv_bounds);

/// A pcurve over `range` (clamped to a B-spline's domain) as rational Bezier curves whose *shape* in (u, v) is exact;
/// hyperbolas and conics become rational quadratics, arcs of at most 90 degrees. Each piece's `t` is the pcurve's own
/// parameter at its ends; between them a conic's differs. range.lo > range.hi runs backwards; no length, no pieces.
/// Throws GeometryError for ranges that are not finite or beyond 1e10, and for coordinates that are not finite.
[[nodiscard]] std::vector<BezierCurve2> rational_pieces(const Curve2& curve, Interval range);

}  // namespace lamella
