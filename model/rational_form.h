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
    same,     ///< u = s
    angle,    ///< s = angle breakpoint index + rational parameter in [0,1]; u from tan of the half angle
    hyperbola ///< u = 2 atanh of the rational parameter, as for cosh / sinh meridians
  };
  Map map_u = Map::same;
  Map map_v = Map::same;
  std::vector<double> breaks_u;  ///< surface parameters at the integer s, for Map::angle and Map::hyperbola
  std::vector<double> breaks_v;

  [[nodiscard]] Vec2 to_surface(const Vec2& st) const;
  [[nodiscard]] Vec2 from_surface(const Vec2& uv) const;
};

/// Converts the part of `surface` over `uv_bounds` (padded outward by nothing: the caller pads). Throws GeometryError
/// beyond kMaxDegree or kMaxWeightRatio.
[[nodiscard]] RationalForm rational_form(const Surface& surface, const Box2& uv_bounds);

/// A pcurve piece over `range` as rational Bezier curves whose *shape* in (u, v) is exact (hyperbolas and conics become
/// rational quadratics; their parameter differs from the pcurve's own).
[[nodiscard]] std::vector<BezierCurve2> rational_pieces(const Curve2& curve, Interval range);

}  // namespace lamella
