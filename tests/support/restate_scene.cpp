#include "tests/support/restate_scene.h"

#include <algorithm>
#include <random>
#include <type_traits>
#include <utility>
#include <vector>

#include "model/bezier.h"
#include "model/bspline.h"
#include "tests/support/transform_scene.h"

namespace lamella::test {

namespace {

/// Applies a map of (u, v), linear up to a shift, to all pcurves and the bounds of a face.
template <class MapPoint, class MapVector>
void map_parameters(Scene& scene, Face& face, const MapPoint& point, const MapVector& vector) {
  const Box2 bounds = face.uv_bounds;
  face.uv_bounds = Box2();
  face.uv_bounds.extend(point(bounds.min()));
  face.uv_bounds.extend(point(bounds.max()));
  for (const LoopId loop : face.loops) {
    for (const HalfEdgeId id : scene.loops[loop].half_edges) {
      Curve2& pcurve = scene.half_edges[id].pcurve;
      pcurve = map_curve<2, 2>(pcurve, point, vector);
    }
  }
}

BSplineSurface swapped(const BSplineSurface& surface) {
  BSplineSurface result{
      surface.degree_v, surface.degree_u, surface.count_v, surface.count_u, surface.knots_v, surface.knots_u, {}, {}};
  for (int i = 0; i < result.count_u; ++i) {
    for (int j = 0; j < result.count_v; ++j) {
      const auto at = static_cast<std::size_t>(j * surface.count_v + i);
      result.poles.push_back(surface.poles[at]);
      if (!surface.weights.empty()) result.weights.push_back(surface.weights[at]);
    }
  }
  return result;
}

/// u runs from lo + hi - u.
BSplineSurface reversed_u(BSplineSurface surface) {
  const Interval u = surface.domain_u();
  for (double& knot : surface.knots_u) knot = u.lo + (u.hi - knot);
  std::reverse(surface.knots_u.begin(), surface.knots_u.end());
  const auto row = static_cast<std::ptrdiff_t>(surface.count_v);
  for (std::ptrdiff_t i = 0, j = surface.count_u - 1; i < j; ++i, --j) {
    std::swap_ranges(surface.poles.begin() + i * row, surface.poles.begin() + (i + 1) * row,
                     surface.poles.begin() + j * row);
    if (surface.weights.empty()) continue;
    std::swap_ranges(surface.weights.begin() + i * row, surface.weights.begin() + (i + 1) * row,
                     surface.weights.begin() + j * row);
  }
  return surface;
}

template <class Change>
Scene with_splines(Scene scene, const Change& change) {
  for (Face& face : scene.faces) {
    if (auto* spline = std::get_if<BSplineSurface>(&face.surface)) *spline = change(*spline);
  }
  return scene;
}

}  // namespace

Scene with_swapped_parameters(Scene scene) {
  const auto swap = [](const Vec2& uv) -> Vec2 { return {uv[1], uv[0]}; };
  for (Face& face : scene.faces) {
    auto* spline = std::get_if<BSplineSurface>(&face.surface);
    if (spline == nullptr) continue;
    *spline = swapped(*spline);
    face.same_sense = !face.same_sense;
    map_parameters(scene, face, swap, swap);
  }
  return scene;
}

Scene with_reversed_parameters(Scene scene) {
  for (Face& face : scene.faces) {
    Vec2 sign(-1.0, 1.0);
    Vec2 shift = Vec2::Zero();
    std::visit(
        [&](auto& s) {
          using T = std::decay_t<decltype(s)>;
          if constexpr (requires { s.frame; }) {
            s.frame.y = -s.frame.y;
          } else if constexpr (std::is_same_v<T, Extrusion>) {
            s.direction = -s.direction;
          } else if constexpr (std::is_same_v<T, Revolution>) {
            s.axis_direction = -s.axis_direction;
          } else if constexpr (std::is_same_v<T, BSplineSurface>) {
            shift[0] = s.domain_u().lo + s.domain_u().hi;
            s = reversed_u(std::move(s));
          } else {
            shift[0] = s.fit.domain_u().lo + s.fit.domain_u().hi;
            s.fit = reversed_u(std::move(s.fit));
          }
          if constexpr (std::is_same_v<T, Plane> || std::is_same_v<T, Extrusion>) sign = Vec2(1.0, -1.0);
        },
        face.surface);
    face.same_sense = !face.same_sense;
    map_parameters(
        scene, face, [&](const Vec2& uv) -> Vec2 { return shift + sign.cwiseProduct(uv); },
        [&](const Vec2& way) -> Vec2 { return sign.cwiseProduct(way); });
  }
  return scene;
}

Scene with_inserted_knots(Scene scene, int count, unsigned seed) {
  std::mt19937 random(seed);
  const auto draw = [&](Interval domain) {
    std::vector<double> knots;
    for (int i = 0; i < count; ++i) {
      knots.push_back(domain.lo + domain.length() * (static_cast<double>(random()) + 0.5) / 4294967296.0);
    }
    std::sort(knots.begin(), knots.end());
    return knots;
  };
  return with_splines(std::move(scene), [&](const BSplineSurface& surface) {
    return refine_v(refine_u(surface, draw(surface.domain_u())), draw(surface.domain_v()));
  });
}

Scene with_full_knots(Scene scene) {
  return with_splines(std::move(scene), [&](const BSplineSurface& surface) {
    const BSplineSurface finer = refine_u(surface, bezier_knots(surface.knots_u, surface.degree_u));
    return refine_v(finer, bezier_knots(finer.knots_v, finer.degree_v));
  });
}

Scene with_shuffled_faces(Scene scene, unsigned seed) {
  std::mt19937 random(seed);
  for (const Shell& shell : scene.shells) {
    const std::size_t first = shell.faces.first.value();
    for (std::size_t i = shell.faces.count; i > 1; --i) {
      std::swap(scene.faces[FaceId{first + i - 1}], scene.faces[FaceId{first + random() % i}]);
    }
    for (const FaceId face : shell.faces) {
      for (const LoopId loop : scene.faces[face].loops) scene.loops[loop].face = face;
    }
  }
  return scene;
}

}  // namespace lamella::test
