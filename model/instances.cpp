#include "model/instances.h"

#include <cstddef>

namespace lamella {

namespace {

/// Coordinates are at most 1e6 mm; they were rounded a few times.
constexpr double kSamePlace = 1e-8;  // mm

bool is_shifted(const Scene& scene, const Loop& a, const Loop& b, const Vec3& offset) {
  if (a.half_edges.count != b.half_edges.count) return false;
  for (std::size_t i = 0; i < a.half_edges.count; ++i) {
    const HalfEdge& use_a = scene.half_edges[HalfEdgeId{a.half_edges.first.value() + i}];
    const HalfEdge& use_b = scene.half_edges[HalfEdgeId{b.half_edges.first.value() + i}];
    const Edge& edge_a = scene.edges[use_a.edge];
    const Edge& edge_b = scene.edges[use_b.edge];
    if (use_a.forward != use_b.forward || edge_a.degenerate != edge_b.degenerate) return false;
    const Vec3 miss = scene.vertices[edge_b.start].point - scene.vertices[edge_a.start].point - offset;
    // Written so that NaN fails.
    if (!(miss.cwiseAbs().maxCoeff() <= kSamePlace)) return false;
  }
  return true;
}

bool is_shifted(const Scene& scene, const Face& a, const Face& b, const Vec3& offset) {
  if (a.step_entity == 0 || a.step_entity != b.step_entity) return false;
  if (a.surface.index() != b.surface.index() || a.same_sense != b.same_sense || a.loops.count != b.loops.count)
    return false;
  for (std::size_t i = 0; i < a.loops.count; ++i) {
    const Loop& loop_a = scene.loops[LoopId{a.loops.first.value() + i}];
    const Loop& loop_b = scene.loops[LoopId{b.loops.first.value() + i}];
    if (!is_shifted(scene, loop_a, loop_b, offset)) return false;
  }
  return true;
}

bool is_shifted(const Scene& scene, const Shell& a, const Shell& b, const Vec3& offset) {
  if (a.faces.count != b.faces.count) return false;
  for (std::size_t i = 0; i < a.faces.count; ++i) {
    const Face& face_a = scene.faces[FaceId{a.faces.first.value() + i}];
    const Face& face_b = scene.faces[FaceId{b.faces.first.value() + i}];
    if (!is_shifted(scene, face_a, face_b, offset)) return false;
  }
  return true;
}

}  // namespace

bool is_shifted(const Scene& scene, SolidId a, SolidId b, const Vec3& offset) {
  const IdRange<ShellId> shells_a = scene.solids[a].shells;
  const IdRange<ShellId> shells_b = scene.solids[b].shells;
  if (shells_a.count != shells_b.count) return false;
  for (std::size_t i = 0; i < shells_a.count; ++i) {
    const Shell& shell_a = scene.shells[ShellId{shells_a.first.value() + i}];
    const Shell& shell_b = scene.shells[ShellId{shells_b.first.value() + i}];
    if (!is_shifted(scene, shell_a, shell_b, offset)) return false;
  }
  return true;
}

bool have_parallel_faces(const Scene& scene, SolidId a, SolidId b) {
  const IdRange<ShellId> shells_a = scene.solids[a].shells;
  const IdRange<ShellId> shells_b = scene.solids[b].shells;
  const auto first_face = [&](const IdRange<ShellId>& shells, std::size_t i) {
    return scene.shells[ShellId{shells.first.value() + i}].faces.first.value();
  };
  for (std::size_t i = 1; i < shells_a.count; ++i) {
    if (first_face(shells_a, i) - first_face(shells_a, 0) != first_face(shells_b, i) - first_face(shells_b, 0))
      return false;
  }
  return true;
}

}  // namespace lamella
