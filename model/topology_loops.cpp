#include <algorithm>
#include <cmath>

#include "core/tolerances.h"
#include "model/evaluate.h"
#include "model/topology_detail.h"

namespace lamella::topology {

namespace {

struct Ends {
  VertexId from, to;
  Vec2 uv_from, uv_to;
};

Ends ends_of(const Scene& scene, const HalfEdge& use) {
  const Edge& edge = scene.edges[use.edge];
  const Vec2 lo = evaluate<2>(use.pcurve, use.prange.lo).point;
  const Vec2 hi = evaluate<2>(use.pcurve, use.prange.hi).point;
  if (use.forward) return {edge.start, edge.end, lo, hi};
  return {edge.end, edge.start, hi, lo};
}

/// Rounding of coordinates of this size, below which no deviation is reported.
double rounding(const Vec3& point) {
  return 1e3 * tolerance::kSolverRelative * std::max(1.0, point.cwiseAbs().maxCoeff());
}

/// Two neighbours in a loop must share their vertex and meet in (u, v), or be bridged there along a point of the
/// surface (a pole without a degenerate edge).
void check_joint(const Scene& scene, FaceId id, const HalfEdge& before, const HalfEdge& after, FaultLog& log) {
  const Face& face = scene.faces[id];
  const Ends a = ends_of(scene, before);
  const Ends b = ends_of(scene, after);
  const Vertex& end = scene.vertices[a.to];
  const Vertex& start = scene.vertices[b.from];
  const double tolerance = std::max({scene.edges[before.edge].tolerance, scene.edges[after.edge].tolerance,
                                     end.tolerance, start.tolerance, face.tolerance});
  const double gap = (end.point - start.point).norm();
  const int entity = scene.edges[before.edge].step_entity;
  if (a.to != b.from) {
    const bool near = gap <= 2.0 * tolerance + rounding(end.point);
    log.add(Fault::loop_open, near ? SolidStatus::ok : SolidStatus::invalid, id, entity,
            "the loop doesn't close: " + length_text(gap) + " between this edge and the next",
            "give the two edges a common vertex in the CAD system");
    return;
  }
  // A straight bridge in (u, v) is what the trimmed region uses; it must not leave the vertex.
  const Vec3 middle = evaluate_point(face.surface, 0.5 * (a.uv_to + b.uv_from));
  const Vec3 first = evaluate_point(face.surface, a.uv_to);
  const Vec3 second = evaluate_point(face.surface, b.uv_from);
  const double jump = std::max((middle - first).norm(), (second - first).norm());
  if (jump > 2.0 * tolerance + rounding(end.point)) {
    log.add(Fault::loop_jump, SolidStatus::ok, id, entity,
            "the trimming curves are " + length_text(jump) + " apart where this edge meets the next",
            "the face's area near it is uncertain; re-export the face's trimming curves");
  }
}

/// Largest distance between the edge's 3D curve and its image on the face, at a few equal parameters.
double pcurve_deviation(const Scene& scene, const Face& face, const HalfEdge& use) {
  const Edge& edge = scene.edges[use.edge];
  constexpr int kSamples = 8;
  double worst = 0.0;
  for (int i = 0; i <= kSamples; ++i) {
    const double part = static_cast<double>(i) / kSamples;
    const Vec2 uv = evaluate<2>(use.pcurve, use.prange.lo + part * use.prange.length()).point;
    const Vec3 on_face = evaluate_point(face.surface, uv);
    const Vec3 on_edge = edge.degenerate ? scene.vertices[edge.start].point
                                         : evaluate<3>(edge.curve, edge.range.lo + part * edge.range.length()).point;
    const double distance = (on_face - on_edge).norm();
    if (!(distance <= worst)) worst = distance;  // keeps NaN
  }
  return worst;
}

void check_vertex(const Scene& scene, FaceId face, const Edge& edge, VertexId id, double parameter, FaultLog& log) {
  const Vertex& vertex = scene.vertices[id];
  const double distance = (evaluate<3>(edge.curve, parameter).point - vertex.point).norm();
  const double allowed = std::max(edge.tolerance, vertex.tolerance) + rounding(vertex.point);
  if (distance <= allowed) return;
  log.add(Fault::vertex_off, SolidStatus::ok, face, edge.step_entity,
          "a vertex lies " + length_text(distance) + " off the end of this edge's curve, more than its tolerance of " +
              length_text(allowed),
          "the edge's curve or its vertex is wrong in the file");
}

void check_half_edge(const Scene& scene, FaceId id, const HalfEdge& use, FaultLog& log) {
  const Face& face = scene.faces[id];
  const Edge& edge = scene.edges[use.edge];
  const double deviation = pcurve_deviation(scene, face, use);
  if (!std::isfinite(deviation)) {
    log.add(Fault::not_finite, SolidStatus::invalid, id, edge.step_entity,
            "the edge or the face's surface has numbers that are not finite", "repair or delete the face");
    return;
  }
  if (use.forward && !edge.degenerate) {
    check_vertex(scene, id, edge, edge.start, edge.range.lo, log);
    check_vertex(scene, id, edge, edge.end, edge.range.hi, log);
  }
  const double allowed = std::max({edge.tolerance, face.tolerance, scene.vertices[edge.start].tolerance}) +
                         rounding(scene.vertices[edge.start].point);
  if (deviation > allowed) {
    log.add(Fault::pcurve_off, SolidStatus::ok, id, edge.step_entity,
            "the trimming curve lies " + length_text(deviation) + " off this edge, more than its tolerance of " +
                length_text(allowed),
            "the face and its neighbour don't quite meet there; hits near the edge are less certain");
  }
}

}  // namespace

void check_loops(const Scene& scene, FaceId face, FaultLog& log) {
  for (const LoopId loop : scene.faces[face].loops) {
    const IdRange<HalfEdgeId> chain = scene.loops[loop].half_edges;
    for (const HalfEdgeId id : chain) check_half_edge(scene, face, scene.half_edges[id], log);
    for (std::uint32_t i = 0; i < chain.count; ++i) {
      const HalfEdgeId here{chain.first.value() + i};
      const HalfEdgeId next{chain.first.value() + (i + 1) % chain.count};
      check_joint(scene, face, scene.half_edges[here], scene.half_edges[next], log);
    }
  }
}

}  // namespace lamella::topology
