#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <vector>

#include "model/evaluate.h"
#include "model/topology_detail.h"

namespace lamella::topology {

namespace {

using Uses = std::span<const HalfEdgeId>;

FaceId face_of(const Scene& scene, HalfEdgeId half_edge) { return scene.loops[scene.half_edges[half_edge].loop].face; }

/// The shell's half-edges, degenerate edges left out, those of one edge side by side.
std::vector<HalfEdgeId> half_edges_by_edge(const Scene& scene, ShellId shell) {
  std::vector<HalfEdgeId> uses;
  for (const FaceId face : scene.shells[shell].faces) {
    for (const LoopId loop : scene.faces[face].loops) {
      for (const HalfEdgeId half_edge : scene.loops[loop].half_edges) {
        if (!scene.edges[scene.half_edges[half_edge].edge].degenerate) uses.push_back(half_edge);
      }
    }
  }
  std::stable_sort(uses.begin(), uses.end(),
                   [&](HalfEdgeId a, HalfEdgeId b) { return scene.half_edges[a].edge < scene.half_edges[b].edge; });
  return uses;
}

void join(Scene& scene, HalfEdgeId a, HalfEdgeId b) {
  scene.half_edges[a].twin = b;
  scene.half_edges[b].twin = a;
}

/// Direction from the middle of the edge into the face of one of its uses, as an angle about the edge's direction.
/// NaN when the face has no normal there.
double angle_about_edge(const Scene& scene, HalfEdgeId id) {
  const HalfEdge& use = scene.half_edges[id];
  const Edge& edge = scene.edges[use.edge];
  const Face& face = scene.faces[face_of(scene, id)];
  const Vec3 along = evaluate<3>(edge.curve, edge.range.middle()).dt.normalized();
  const Vec2 uv = evaluate<2>(use.pcurve, use.prange.middle()).point;
  const Vec3 normal = evaluate(face.surface, uv).normal() * (face.same_sense ? 1.0 : -1.0);
  const Vec3 inward = normal.cross(use.forward ? along : Vec3(-along));
  const Vec3 x = along.unitOrthogonal();
  return std::atan2(along.cross(x).dot(inward), x.dot(inward));
}

/// Pairs the uses of an edge where bodies touch: going round the edge counterclockwise, material lies between a
/// backward use and the forward use that follows it (the outward normal of a forward use points away from the material
/// counterclockwise). True if the senses alternate, which they must around disjoint wedges of material.
bool pair_around_edge(Scene& scene, Uses uses) {
  struct Spoke {
    double angle;
    HalfEdgeId id;
  };
  std::vector<Spoke> spokes;
  for (const HalfEdgeId id : uses) spokes.push_back({angle_about_edge(scene, id), id});
  if (std::any_of(spokes.begin(), spokes.end(), [](const Spoke& s) { return !std::isfinite(s.angle); })) return false;
  std::stable_sort(spokes.begin(), spokes.end(), [](const Spoke& a, const Spoke& b) { return a.angle < b.angle; });
  const auto forward = [&](std::size_t i) { return scene.half_edges[spokes[i % spokes.size()].id].forward; };
  for (std::size_t i = 0; i < spokes.size(); ++i) {
    if (forward(i) == forward(i + 1)) return false;
  }
  for (std::size_t i = forward(0) ? 1 : 0; i < spokes.size(); i += 2) {
    join(scene, spokes[i].id, spokes[(i + 1) % spokes.size()].id);
  }
  return true;
}

/// Uses in opposite senses paired in the order of the file.
void pair_in_order(Scene& scene, Uses uses) {
  std::vector<HalfEdgeId> forward, backward;
  for (const HalfEdgeId id : uses) (scene.half_edges[id].forward ? forward : backward).push_back(id);
  for (std::size_t i = 0; i < forward.size(); ++i) join(scene, forward[i], backward[i]);
}

void report_free(const Scene& scene, HalfEdgeId use, FaultLog& log) {
  const Edge& edge = scene.edges[scene.half_edges[use].edge];
  const double length = (scene.vertices[edge.start].point - scene.vertices[edge.end].point).norm();
  log.add(Fault::free_edge, SolidStatus::open, face_of(scene, use), edge.step_entity,
          "only one face uses this edge (" + length_text(length) + " between its ends), so the shell is open",
          "close the gap in the CAD system, or slice with --allow-open");
}

void report_contradiction(const Scene& scene, Uses uses, FaultLog& log) {
  const FaceId a = face_of(scene, uses.front());
  const FaceId b = face_of(scene, uses.back());
  const std::string other = entity_text(scene.faces[b].step_entity);
  log.add(uses.size() == 2 ? Fault::same_sense_edge : Fault::crowded_edge, SolidStatus::invalid, a,
          scene.edges[scene.half_edges[uses.front()].edge].step_entity,
          uses.size() == 2
              ? "two faces run through this edge in the same sense (the other face: " + other + ")"
              : std::to_string(uses.size()) + " uses of this edge in one shell, not in pairs of opposite sense",
          "one of the faces is turned inside out or doubled; repair the orientation in the CAD system");
}

bool senses_balance(const Scene& scene, Uses uses) {
  const auto forward =
      std::count_if(uses.begin(), uses.end(), [&](HalfEdgeId id) { return scene.half_edges[id].forward; });
  return 2 * static_cast<std::size_t>(forward) == uses.size();
}

/// True if every use of the edge got a twin.
bool pair_uses(Scene& scene, Uses uses, FaultLog* log) {
  if (uses.size() == 1) {
    if (log != nullptr) report_free(scene, uses.front(), *log);
    return false;
  }
  if (!senses_balance(scene, uses)) {
    if (log != nullptr) report_contradiction(scene, uses, *log);
    return false;
  }
  if (uses.size() == 2) {
    join(scene, uses[0], uses[1]);
  } else if (!pair_around_edge(scene, uses)) {
    // Tangent or coinciding faces have no certain order about the edge; any pairing keeps the shell closed.
    pair_in_order(scene, uses);
  }
  return true;
}

}  // namespace

void pair_half_edges(Scene& scene, ShellId shell, FaultLog* log) {
  const std::vector<HalfEdgeId> all = half_edges_by_edge(scene, shell);
  for (const HalfEdgeId id : all) scene.half_edges[id].twin = HalfEdgeId{};
  bool closed = !scene.shells[shell].faces.empty();
  for (std::size_t first = 0; first < all.size();) {
    std::size_t last = first + 1;
    while (last < all.size() && scene.half_edges[all[last]].edge == scene.half_edges[all[first]].edge) ++last;
    closed = pair_uses(scene, Uses(all).subspan(first, last - first), log) && closed;
    first = last;
  }
  scene.shells[shell].closed = closed;
}

}  // namespace lamella::topology
