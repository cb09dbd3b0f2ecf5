#include "slicing/reference/edge_zones.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "model/evaluate.h"

namespace lamella::reference {

namespace {

constexpr int kGapSamples = 24;
/// Pieces of a straight edge only keep its boxes slim.
constexpr int kLinePieces = 4;
constexpr int kLeastPieces = 32;
constexpr int kMostPieces = 600;
/// Each face's border stays within the gap of the edge, so that no ray outside of a tube of that radius passes between
/// two of them; half as much again, because the gap is measured at samples.
constexpr double kGapFactor = 1.5;
/// A curve's deviation from a chord of 1/32 of it is about that in the middle; this much more to be safe.
constexpr double kBulgeFactor = 4.0;
constexpr double kLeastBulge = 1e-2;

int piece_count(const Edge& edge) {
  if (edge.degenerate) return 0;
  if (std::holds_alternative<Line<3>>(edge.curve)) return kLinePieces;
  if (const auto* spline = std::get_if<BSplineCurve<3>>(&edge.curve)) {
    return std::clamp(8 * static_cast<int>(spline->poles.size()), kLeastPieces, kMostPieces);
  }
  return kLeastPieces;
}

/// Parameter of the least `distance(t)` over [lo, hi] by golden-section search, for a bracket with one minimum.
template <class Distance>
double least_over(double lo, double hi, const Distance& distance) {
  constexpr double kGolden = 0.6180339887498949;
  double a = hi - kGolden * (hi - lo);
  double b = lo + kGolden * (hi - lo);
  double at_a = distance(a);
  double at_b = distance(b);
  for (int step = 0; step < 40; ++step) {
    if (at_a < at_b) {
      hi = b;
      b = a;
      at_b = at_a;
      a = hi - kGolden * (hi - lo);
      at_a = distance(a);
    } else {
      lo = a;
      a = b;
      at_a = at_b;
      b = lo + kGolden * (hi - lo);
      at_b = distance(b);
    }
  }
  return at_a < at_b ? a : b;
}

/// Distance of `image`, on a face, from the edge near the parameter `t` it should have.
double gap_at(const Edge& edge, double t, const Vec3& image) {
  const auto distance = [&](double s) { return (evaluate<3>(edge.curve, s).point - image).norm(); };
  const double direct = distance(t);
  if (direct <= edge.tolerance) return direct;
  // Curve and pcurve may run at different speeds: what counts is the distance between their points, not their
  // parameters.
  const double reach = edge.range.length() / kGapSamples;
  const double lo = std::max(edge.range.lo, t - reach);
  const double hi = std::min(edge.range.hi, t + reach);
  return std::min(direct, distance(least_over(lo, hi, distance)));
}

/// Largest distance found between the edge and its image on one face; infinite where that can't be evaluated.
double measured_gap(const Scene& scene, const HalfEdge& half_edge) {
  const Edge& edge = scene.edges[half_edge.edge];
  const Face& face = scene.faces[scene.loops[half_edge.loop].face];
  double gap = 0.0;
  // Written so that NaN makes the gap infinite.
  const auto widen = [&gap](double distance) {
    gap = distance <= gap ? gap : distance >= 0.0 ? distance : std::numeric_limits<double>::infinity();
  };
  for (int k = 0; k <= kGapSamples; ++k) {
    const double share = static_cast<double>(k) / kGapSamples;
    const double s = half_edge.prange.lo + half_edge.prange.length() * share;
    const Vec3 image = evaluate_point(face.surface, evaluate<2>(half_edge.pcurve, s).point);
    if (k == 0 || edge.degenerate) widen((image - scene.vertices[edge.start].point).norm());
    if (k == kGapSamples) widen((image - scene.vertices[edge.end].point).norm());
    if (!edge.degenerate) widen(gap_at(edge, edge.range.lo + edge.range.length() * share, image));
  }
  return gap;
}

/// Distance between a line and a segment.
double line_to_segment(const Ray& line, const Vec3& from, const Vec3& to) {
  const auto across = [&](const Vec3& p) {
    const Vec3 relative = p - line.origin;
    return Vec3(relative - line.direction.dot(relative) * line.direction);
  };
  const Vec3 a = across(from);
  const Vec3 along = across(to) - a;
  const double square = along.squaredNorm();
  const double s = square > 0.0 ? std::clamp(-along.dot(a) / square, 0.0, 1.0) : 0.0;
  return (a + s * along).norm();
}

double distance_to_line(const Ray& line, const Vec3& point) {
  const Vec3 relative = point - line.origin;
  return (relative - line.direction.dot(relative) * line.direction).norm();
}

}  // namespace

EdgeZones::EdgeZones(const Scene& scene, SolidId solid, double floor) : scene_(&scene) {
  std::map<EdgeId, std::uint32_t> index;
  for (const ShellId shell : scene.solids[solid].shells) {
    for (const FaceId face : scene.shells[shell].faces) {
      for (const LoopId loop : scene.faces[face].loops) {
        for (const HalfEdgeId half_edge : scene.loops[loop].half_edges) {
          const EdgeId edge = scene.half_edges[half_edge].edge;
          const auto [entry, is_new] = index.try_emplace(edge, static_cast<std::uint32_t>(zones_.size()));
          if (is_new) zones_.push_back({edge, 0.0, 0.0});
          EdgeZone& zone = zones_[entry->second];
          zone.radius = std::max(zone.radius, measured_gap(scene, scene.half_edges[half_edge]));
        }
      }
    }
  }
  for (std::uint32_t k = 0; k < zones_.size(); ++k) {
    EdgeZone& zone = zones_[k];
    const Edge& edge = scene.edges[zone.edge];
    zone.stated = std::max({edge.tolerance, scene.vertices[edge.start].tolerance, scene.vertices[edge.end].tolerance});
    const double gap = std::isfinite(zone.radius) ? zone.radius : zone.stated;
    zone.radius = std::max(floor, kGapFactor * gap);
    add_pieces(k);
  }
  std::vector<Box3> boxes;
  for (const Piece& piece : pieces_) {
    const EdgeZone& zone = zones_[piece.zone];
    const Vec3 margin = Vec3::Constant(std::max(zone.radius, zone.stated) + piece.bulge);
    boxes.emplace_back(piece.from.cwiseMin(piece.to) - margin, piece.from.cwiseMax(piece.to) + margin);
  }
  tree_ = PatchTree(boxes, 0.0);
}

void EdgeZones::add_pieces(std::uint32_t zone) {
  const Edge& edge = scene_->edges[zones_[zone].edge];
  const int count = piece_count(edge);
  if (count == 0) {
    const Vec3& point = scene_->vertices[edge.start].point;
    pieces_.push_back({zone, 0.0, 0.0, point, point, 0.0});
    return;
  }
  const auto parameter = [&](double k) { return edge.range.lo + edge.range.length() * k / count; };
  const auto point = [&](double k) { return evaluate<3>(edge.curve, parameter(k)).point; };
  const bool straight = std::holds_alternative<Line<3>>(edge.curve);
  Vec3 from = point(0);
  for (int k = 0; k < count; ++k) {
    const Vec3 to = point(k + 1);
    double bulge = 0.0;
    if (!straight) {
      const double chord = (to - from).norm();
      double middle = 0.0;
      for (const double share : {0.25, 0.5, 0.75}) {
        middle = std::max(middle, (point(k + share) - (from + share * (to - from))).norm());
      }
      bulge = kBulgeFactor * middle + kLeastBulge * chord;
    }
    pieces_.push_back({zone, parameter(k), parameter(k + 1), from, to, bulge});
    from = to;
  }
}

void EdgeZones::find(const Ray& line, std::vector<std::uint32_t>& items, std::vector<EdgePass>& passes) const {
  items.clear();
  tree_.find(line, items);
  for (const std::uint32_t item : items) {
    const Piece& piece = pieces_[item];
    const EdgeZone& zone = zones_[piece.zone];
    const double limit = std::max(zone.radius, zone.stated);
    if (line_to_segment(line, piece.from, piece.to) > limit + piece.bulge) continue;
    Vec3 point = piece.from;
    if (piece.lo < piece.hi) {
      const Curve3& curve = scene_->edges[zone.edge].curve;
      const auto distance = [&](double t) { return distance_to_line(line, evaluate<3>(curve, t).point); };
      point = evaluate<3>(curve, least_over(piece.lo, piece.hi, distance)).point;
    }
    const double distance = distance_to_line(line, point);
    if (distance <= limit) passes.push_back({zone, distance, point});
  }
}

}  // namespace lamella::reference
