#include "tests/support/transform_scene.h"

#include <cmath>
#include <random>
#include <vector>

namespace lamella::test {

namespace {

Frame placed(const Frame& frame, const Placement& placement) {
  return {placement.apply(frame.origin), placement.linear * frame.x, placement.linear * frame.y,
          placement.linear * frame.z};
}

}  // namespace

Curve3 placed(const Curve3& curve, const Placement& placement) {
  const auto point = [&](const Vec3& p) -> Vec3 { return placement.apply(p); };
  const auto vector = [&](const Vec3& d) -> Vec3 { return placement.linear * d; };
  return map_curve<3, 3>(curve, point, vector);
}

Surface placed(Surface surface, const Placement& placement) {
  std::visit(
      [&](auto& s) {
        using T = std::decay_t<decltype(s)>;
        if constexpr (requires { s.frame; }) {
          s.frame = placed(s.frame, placement);
        } else if constexpr (std::is_same_v<T, Extrusion>) {
          s.basis = placed(s.basis, placement);
          s.direction = placement.linear * s.direction;
        } else if constexpr (std::is_same_v<T, Revolution>) {
          s.meridian = placed(s.meridian, placement);
          s.axis_origin = placement.apply(s.axis_origin);
          // The axis is a pseudovector: turning by u stays turning by u only if it flips with a mirror.
          s.axis_direction = placement.linear * s.axis_direction * (placement.mirrors() ? -1.0 : 1.0);
        } else if constexpr (std::is_same_v<T, BSplineSurface>) {
          for (Vec3& pole : s.poles) pole = placement.apply(pole);
        } else {
          for (Vec3& pole : s.fit.poles) pole = placement.apply(pole);
        }
      },
      surface);
  return surface;
}

Scene placed(Scene scene, const Placement& placement) {
  for (Solid& solid : scene.solids) solid.info.instance.reset();
  for (Vertex& vertex : scene.vertices) vertex.point = placement.apply(vertex.point);
  for (Edge& edge : scene.edges) edge.curve = placed(edge.curve, placement);
  for (const FaceId face : scene.faces.ids()) {
    scene.faces[face].surface = placed(std::move(scene.faces[face].surface), placement);
    // Su x Sv turns against the material, and so does the sense in which a loop runs round its face.
    if (placement.mirrors()) turn_face(scene, face);
  }
  return scene;
}

void turn_loops(Scene& scene, FaceId face) {
  for (const LoopId loop : scene.faces[face].loops) {
    const IdRange<HalfEdgeId> ids = scene.loops[loop].half_edges;
    const std::size_t sum = 2 * std::size_t{ids.first.value()} + ids.count - 1;
    const auto is_own = [&](HalfEdgeId id) { return id >= ids.first && id.value() < ids.first.value() + ids.count; };
    std::vector<HalfEdge> uses;
    for (const HalfEdgeId id : ids) uses.push_back(scene.half_edges[id]);
    for (const HalfEdgeId id : ids) {
      HalfEdge& use = scene.half_edges[id] = uses.back();
      uses.pop_back();
      use.forward = !use.forward;
      if (!use.twin.valid()) continue;
      if (is_own(use.twin)) {
        use.twin = HalfEdgeId{sum - use.twin.value()};
      } else {
        scene.half_edges[use.twin].twin = id;
      }
    }
  }
}

void turn_face(Scene& scene, FaceId face) {
  scene.faces[face].same_sense = !scene.faces[face].same_sense;
  turn_loops(scene, face);
}

Placement random_rotation(unsigned seed) {
  std::mt19937 random(seed);
  const auto unit = [&] { return (static_cast<double>(random()) + 0.5) / 4294967296.0; };
  // Shoemake (1992): a uniform unit quaternion.
  const double a = unit();
  const double b = kTwoPi * unit();
  const double c = kTwoPi * unit();
  const Eigen::Quaterniond q(std::sqrt(a) * std::cos(c), std::sqrt(1.0 - a) * std::sin(b),
                             std::sqrt(1.0 - a) * std::cos(b), std::sqrt(a) * std::sin(c));
  return {q.toRotationMatrix(), Vec3::Zero()};
}

}  // namespace lamella::test
