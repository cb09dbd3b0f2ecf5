#include "slicing/adaptive/edge_slants.h"

#include <algorithm>
#include <cmath>

#include "model/curve_extrema.h"
#include "model/evaluate.h"
#include "model/rational_form.h"

namespace lamella {

namespace {

constexpr int kMaxDepth = 14;
constexpr std::size_t kMaxPieces = 20000;

/// A part of an edge's range, both ends in [0, 1].
struct Piece {
  double from = 0.0;
  double to = 1.0;
  int depth = 0;
};

Interval height_range(const Edge& edge, const Piece& piece) {
  const double length = edge.range.length();
  const Box3 box = exact_bounds(edge.curve, {edge.range.lo + piece.from * length, edge.range.lo + piece.to * length});
  return {box.min().z(), box.max().z()};
}

/// Box of the face's parameters along a part of a half-edge.
Box2 parameter_box(const Scene& scene, HalfEdgeId half_edge, double from, double to) {
  const HalfEdge& half = scene.half_edges[half_edge];
  const double length = half.prange.hi - half.prange.lo;
  Box2 box;
  for (const BezierCurve2& piece :
       rational_pieces(half.pcurve, {half.prange.lo + from * length, half.prange.lo + to * length})) {
    box.extend(control_box(piece));
  }
  return box;
}

/// A bound and how much of it may be due to the length of the piece.
struct Bound {
  double slant = 1.0;
  double doubt = 0.0;
};

Bound slant_of(const NormalCone& a, const NormalCone& b) {
  const double bound = largest_slant_between(a, b);
  return {bound, bound - largest_slant_between({a.axis, 0.0}, {b.axis, 0.0})};
}

}  // namespace

Vec2 parameters_at(const Scene& scene, HalfEdgeId half_edge, double share) {
  const HalfEdge& half = scene.half_edges[half_edge];
  return evaluate<2>(half.pcurve, half.prange.lo + share * (half.prange.hi - half.prange.lo)).point;
}

std::vector<Slant> edge_slants(const Scene& scene, HalfEdgeId half_edge, const FaceSlants& face,
                               const FaceSlants* neighbor, const SlantProfile& known) {
  const HalfEdge& half = scene.half_edges[half_edge];
  const Edge& edge = scene.edges[half.edge];
  std::vector<Slant> out;
  if (edge.degenerate) return out;  // its vertex tells
  if (neighbor == nullptr) return {{height_range(edge, {}), 1.0}};
  std::vector<Piece> open{{}};
  std::size_t pieces = 0;
  while (!open.empty()) {
    const Piece piece = open.back();
    open.pop_back();
    ++pieces;
    const Interval z = height_range(edge, piece);
    const Bound bound = slant_of(face.normals(parameter_box(scene, half_edge, piece.from, piece.to)),
                                 neighbor->normals(parameter_box(scene, half.twin, piece.from, piece.to)));
    const bool tells_nothing = bound.slant <= known.least_slant(z) + kSlantAccuracy;
    // Without doubt the normals are nearly the same all along the piece, and so is the slant.
    const bool is_done = tells_nothing || bound.doubt <= kSlantAccuracy;
    if (is_done || piece.depth >= kMaxDepth || pieces + open.size() > kMaxPieces) {
      out.push_back({z, bound.slant});
      continue;
    }
    const double middle = 0.5 * (piece.from + piece.to);
    open.push_back({piece.from, middle, piece.depth + 1});
    open.push_back({middle, piece.to, piece.depth + 1});
  }
  return out;
}

}  // namespace lamella
