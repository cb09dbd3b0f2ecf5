#include "slicing/adaptive/edge_slants.h"

#include "model/curve_extrema.h"
#include "model/evaluate.h"
#include "model/rational_form.h"

namespace lamella {

namespace {

Box3 box_of(const Edge& edge, const Interval& share) {
  const double length = edge.range.length();
  return exact_bounds(edge.curve, {edge.range.lo + share.lo * length, edge.range.lo + share.hi * length});
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

RidgeLine edge_line(const Scene& scene, HalfEdgeId half_edge, const FaceSlants& face, const FaceSlants& neighbor) {
  const HalfEdgeId twin = scene.half_edges[half_edge].twin;
  RidgeLine line;
  line.box = [&scene, half_edge](const Interval& share) {
    return box_of(scene.edges[scene.half_edges[half_edge].edge], share);
  };
  line.first = [&scene, &face, half_edge](const Interval& share) {
    return face.normals(parameter_box(scene, half_edge, share));
  };
  line.second = [&scene, &neighbor, twin](const Interval& share) {
    return neighbor.normals(parameter_box(scene, twin, share));
  };
  return line;
}

EdgeSlants edge_slants(const Scene& scene, HalfEdgeId half_edge, const FaceSlants& face, const FaceSlants* neighbor,
                       const SlantProfile& known, const WedgeRule& wedges) {
  const HalfEdge& half = scene.half_edges[half_edge];
  const Edge& edge = scene.edges[half.edge];
  if (edge.degenerate) return {};  // its vertex tells
  if (neighbor == nullptr) return {{{heights_of(box_of(edge, {0.0, 1.0})), 1.0}}, false};
  return ridge_slants(edge_line(scene, half_edge, face, *neighbor), known, wedges);
}

}  // namespace lamella
