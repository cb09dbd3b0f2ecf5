#pragma once

#include <type_traits>

#include "model/scene.h"
#include "tests/support/solids.h"

/// Scenes moved, mirrored and turned inside out as a whole.
namespace lamella::test {

/// The curve with `point` applied to its points and `vector` to its directions.
template <int Dim, int From, class MapPoint, class MapVector>
Curve<Dim> map_curve(const Curve<From>& curve, const MapPoint& point, const MapVector& vector) {
  return std::visit(
      [&](const auto& c) -> Curve<Dim> {
        using T = std::decay_t<decltype(c)>;
        if constexpr (std::is_same_v<T, Line<From>>) {
          return Line<Dim>{point(c.origin), vector(c.direction)};
        } else if constexpr (std::is_same_v<T, Ellipse<From>>) {
          return Ellipse<Dim>{point(c.center), vector(c.major), vector(c.minor)};
        } else if constexpr (std::is_same_v<T, Parabola<From>>) {
          return Parabola<Dim>{point(c.apex), vector(c.axis), vector(c.tangent)};
        } else if constexpr (std::is_same_v<T, Hyperbola<From>>) {
          return Hyperbola<Dim>{point(c.center), vector(c.major), vector(c.minor)};
        } else {
          BSplineCurve<Dim> result{c.degree, c.knots, {}, c.weights};
          for (const auto& pole : c.poles) result.poles.push_back(point(pole));
          return result;
        }
      },
      curve);
}

[[nodiscard]] Curve3 placed(const Curve3& curve, const Placement& placement);
/// The same (u, v) on the placed surface.
[[nodiscard]] Surface placed(Surface surface, const Placement& placement);
/// All geometry placed; a mirroring placement turns the faces' senses and loops, so that solids stay solids.
[[nodiscard]] Scene placed(Scene scene, const Placement& placement);

/// Turns the loops of a face round.
void turn_loops(Scene& scene, FaceId face);
/// Turns a face's outward normal, its loops with it.
void turn_face(Scene& scene, FaceId face);

/// A uniformly distributed rotation, the same for the same seed on every platform.
[[nodiscard]] Placement random_rotation(unsigned seed);

}  // namespace lamella::test
