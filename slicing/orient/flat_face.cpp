#include "slicing/orient/flat_face.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "model/evaluate.h"

namespace lamella {

namespace {

constexpr double kFlat = 1e-9;  // of the net's size

std::optional<Vec3> net_normal(const BSplineSurface& surface) {
  const Vec2 middle(surface.domain_u().middle(), surface.domain_v().middle());
  const SurfacePoint at = evaluate(Surface(surface), middle);
  const Vec3 normal = at.normal().stableNormalized();
  if (!normal.allFinite() || !(normal.norm() > 0.5)) return std::nullopt;
  Box3 box;
  double off = 0.0;
  for (const Vec3& pole : surface.poles) {
    box.extend(pole);
    off = std::max(off, std::abs(normal.dot(pole - at.point)));
  }
  if (!(off <= kFlat * box.diagonal().norm())) return std::nullopt;
  return normal;
}

}  // namespace

std::optional<Vec3> flat_normal(const Face& face) {
  const double sense = face.same_sense ? 1.0 : -1.0;
  return std::visit(
      [sense](const auto& s) -> std::optional<Vec3> {
        using T = std::decay_t<decltype(s)>;
        if constexpr (std::is_same_v<T, Plane>) {
          return Vec3(sense * s.frame.x.cross(s.frame.y).stableNormalized());
        } else if constexpr (std::is_same_v<T, BSplineSurface>) {
          const auto normal = net_normal(s);
          return normal ? std::optional<Vec3>(sense * *normal) : std::nullopt;
        } else {
          return std::nullopt;
        }
      },
      face.surface);
}

}  // namespace lamella
