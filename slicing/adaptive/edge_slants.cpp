#include "slicing/adaptive/edge_slants.h"

#include "model/curve_extrema.h"
#include "model/evaluate.h"
#include "model/rational_form.h"

namespace lamella {

namespace {

Interval height_range(const Edge& edge, const Interval& share) {
  const double length = edge.range.length();
  const Box3 box = exact_bounds(edge.curve, {edge.range.lo + share.lo * length, edge.range.lo + share.hi * length});
  return {box.min().z(), box.max().z()};
}

/// Box of the face's parameters along a part of a half-edge.
Box2 parameter_box(const Scene& scene, HalfEdgeId half_edge, const Interval& share) {
  const HalfEdge& half = scene.half_edges[half_edge];
  const double length = half.prange.hi - half.prange.lo;
  Box2 box;
  for (const BezierCurve2& piece :
       rational_pieces(half.pcurve, {half.prange.lo + share.lo * length, half.prange.lo + share.hi * length})) {
    box.extend(control_box(piece));
  }
  return box;
}

}  // namespace

Vec2 parameters_at(const Scene& scene, HalfEdgeId half_edge, double share) {
  const HalfEdge& half = scene.half_edges[half_edge];
  return evaluate<2>(half.pcurve, half.prange.lo + share * (half.prange.hi - half.prange.lo)).point;
}

EdgeSlants edge_slants(const Scene& scene, HalfEdgeId half_edge, const FaceSlants& face, const FaceSlants* neighbor,
                       const SlantProfile& known, const WedgeRule& wedges) {
  const HalfEdge& half = scene.half_edges[half_edge];
  const Edge& edge = scene.edges[half.edge];
  if (edge.degenerate) return {};  // its vertex tells
  if (neighbor == nullptr) return {{{height_range(edge, {0.0, 1.0}), 1.0}}, false};
  RidgeLine line;
  line.heights = [&](const Interval& share) { return height_range(edge, share); };
  line.first = [&](const Interval& share) { return face.normals(parameter_box(scene, half_edge, share)); };
  line.second = [&](const Interval& share) { return neighbor->normals(parameter_box(scene, half.twin, share)); };
  return ridge_slants(line, known, wedges);
}

}  // namespace lamella
