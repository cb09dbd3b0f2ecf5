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
/// Radians. Wider cones, of normals that turn about an edge's axis say, don't tell by their axes how the edge is.
constexpr double kNarrow = 0.05;

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

/// Faces less slanted than that, about a degree, look neither up nor down.
constexpr double kUpright = 0.02;
/// Faces more slanted than that are level: a tip beside one recedes along the other.
constexpr double kLevel = 0.9999;

/// Whether one face looks up and the other down.
bool is_wedge(const NormalCone& a, const NormalCone& b) {
  return a.axis.z() * b.axis.z() < 0.0 && std::min(std::abs(a.axis.z()), std::abs(b.axis.z())) > kUpright;
}

/// The same for cones of any width: false is certain.
bool may_be_wedge(const NormalCone& a, const NormalCone& b) {
  if (std::min(largest_slant(a), largest_slant(b)) <= kUpright) return false;
  const auto looks_one_way = [](const NormalCone& cone) {
    return cone.half_angle < 0.5 * kPi && std::abs(cone.axis.z()) > std::sin(cone.half_angle);
  };
  return !(looks_one_way(a) && looks_one_way(b) && a.axis.z() * b.axis.z() > 0.0);
}

/// The tip of a wedge recedes along its faces to the section in the middle of the layer: by the tangent of the angle
/// between face and vertical, where the distance to the surface grows by the sine only.
void add_wedge(const Interval& z, const NormalCone& a, const NormalCone& b, const WedgeRule& rule, EdgeSlants& out) {
  double rate = 0.0;
  for (const NormalCone* cone : {&a, &b}) {
    if (std::abs(cone->axis.z()) >= kLevel) continue;
    const double slant = largest_slant(*cone);
    rate = std::max(rate, slant < 1.0 ? slant / std::sqrt(1.0 - slant * slant) : rule.steepest + 1.0);
  }
  if (rate > rule.steepest) {
    out.is_too_sharp = true;
    rate = rule.steepest;
  }
  if (!(rate > 0.0)) return;
  // Half a layer that is higher than that recedes by more than is allowed.
  const double reach = rule.deviation / rate;
  out.parts.push_back({{z.lo - reach, z.hi + reach}, rate});
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
  EdgeSlants out;
  if (edge.degenerate) return out;  // its vertex tells
  if (neighbor == nullptr) {
    out.parts.push_back({height_range(edge, {}), 1.0});
    return out;
  }
  std::vector<Piece> open{{}};
  std::size_t pieces = 0;
  while (!open.empty()) {
    const Piece piece = open.back();
    open.pop_back();
    ++pieces;
    const Interval z = height_range(edge, piece);
    const NormalCone a = face.normals(parameter_box(scene, half_edge, piece.from, piece.to));
    const NormalCone b = neighbor->normals(parameter_box(scene, half.twin, piece.from, piece.to));
    const Bound bound = slant_of(a, b);
    const bool is_narrow = std::max(a.half_angle, b.half_angle) <= kNarrow;
    const bool is_blunt = is_narrow ? !is_wedge(a, b) : !may_be_wedge(a, b);
    const bool tells_nothing = bound.slant <= known.least_slant(z) + kSlantAccuracy && is_blunt;
    // Without doubt the normals are nearly the same all along the piece, and so is the slant.
    const bool is_done = tells_nothing || (is_narrow && bound.doubt <= kSlantAccuracy);
    if (is_done || piece.depth >= kMaxDepth || pieces + open.size() > kMaxPieces) {
      out.parts.push_back({z, bound.slant});
      if (is_wedge(a, b)) add_wedge(z, a, b, wedges, out);
      continue;
    }
    const double middle = 0.5 * (piece.from + piece.to);
    open.push_back({piece.from, middle, piece.depth + 1});
    open.push_back({middle, piece.to, piece.depth + 1});
  }
  return out;
}

}  // namespace lamella
