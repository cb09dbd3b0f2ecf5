#include "slicing/reference/edge_zones.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "model/evaluate.h"

namespace lamella::reference {

namespace {

constexpr int kGapSamples = 24;
constexpr int kMinSamples = 32;
constexpr int kMaxSamples = 600;
/// The gap is measured at samples, on each side of the edge; the two sides add up, and between the samples it may be
/// larger: a factor of two for each.
constexpr double kGapFactor = 4.0;

int sample_count(const Edge& edge) {
  if (std::holds_alternative<Line<3>>(edge.curve)) return 1;
  if (const auto* spline = std::get_if<BSplineCurve<3>>(&edge.curve)) {
    return std::clamp(8 * static_cast<int>(spline->poles.size()), kMinSamples, kMaxSamples);
  }
  return kMinSamples;
}

void sample(const Scene& scene, const Edge& edge, EdgeZone& zone) {
  if (edge.degenerate) {
    zone.params = {0.0};
    zone.points = {scene.vertices[edge.start].point};
    return;
  }
  const int count = sample_count(edge);
  for (int k = 0; k <= count; ++k) {
    const double t = edge.range.lo + edge.range.length() * k / count;
    zone.params.push_back(t);
    zone.points.push_back(evaluate<3>(edge.curve, t).point);
  }
}

/// Largest distance found between the edge and its image on one face.
double measured_gap(const Scene& scene, const HalfEdge& half_edge) {
  const Edge& edge = scene.edges[half_edge.edge];
  const Face& face = scene.faces[scene.loops[half_edge.loop].face];
  const Vec3 start = scene.vertices[edge.start].point;
  const Vec3 end = scene.vertices[edge.end].point;
  double gap = 0.0;
  // Written so that NaN, from a curve that can't be evaluated, makes the gap infinite.
  const auto widen = [&gap](double distance) {
    gap = distance <= gap ? gap : distance >= 0.0 ? distance : std::numeric_limits<double>::infinity();
  };
  for (int k = 0; k <= kGapSamples; ++k) {
    const double share = static_cast<double>(k) / kGapSamples;
    const double s = half_edge.prange.lo + half_edge.prange.length() * share;
    const Vec3 image = evaluate_point(face.surface, evaluate<2>(half_edge.pcurve, s).point);
    if (k == 0 || edge.degenerate) widen((image - start).norm());
    if (k == kGapSamples) widen((image - end).norm());
    if (edge.degenerate) continue;
    const Vec3 point = evaluate<3>(edge.curve, edge.range.lo + edge.range.length() * share).point;
    widen((image - point).norm());
  }
  return gap;
}

double distance_to_segment(const Vec3& point, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double square = along.squaredNorm();
  const double s = square > 0.0 ? std::clamp(along.dot(point - a) / square, 0.0, 1.0) : 0.0;
  return (point - (a + s * along)).norm();
}

/// Least distance to the curve over [lo, hi] by golden-section search, for a bracket with one minimum.
double nearest_in(const Curve3& curve, const Vec3& point, double lo, double hi) {
  constexpr double kGolden = 0.6180339887498949;
  const auto distance = [&](double t) { return (evaluate<3>(curve, t).point - point).norm(); };
  double a = hi - kGolden * (hi - lo);
  double b = lo + kGolden * (hi - lo);
  double at_a = distance(a);
  double at_b = distance(b);
  for (int step = 0; step < 48; ++step) {
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
  return std::min(at_a, at_b);
}

}  // namespace

double distance_to_edge(const Edge& edge, const EdgeZone& zone, const Vec3& point, double enough, double limit) {
  const std::size_t count = zone.points.size();
  if (count == 1) return (point - zone.points.front()).norm();
  if (count == 2) return distance_to_segment(point, zone.points[0], zone.points[1]);
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k + 1 < count; ++k) {
    // Between two samples the curve stays within about half their distance of the chord (a half circle would just do).
    const double reach = 0.5 * (zone.points[k + 1] - zone.points[k]).norm();
    if (distance_to_segment(point, zone.points[k], zone.points[k + 1]) > limit + reach) continue;
    best = std::min(best, nearest_in(edge.curve, point, zone.params[k], zone.params[k + 1]));
    if (best <= enough) return best;
  }
  return best;
}

EdgeZones::EdgeZones(const Scene& scene, SolidId solid, double floor) {
  std::map<EdgeId, std::uint32_t> index;
  first_of_face_.push_back(0);
  for (const ShellId shell : scene.solids[solid].shells) {
    for (const FaceId face : scene.shells[shell].faces) {
      for (const LoopId loop : scene.faces[face].loops) {
        for (const HalfEdgeId half_edge : scene.loops[loop].half_edges) {
          const EdgeId edge = scene.half_edges[half_edge].edge;
          const auto [entry, is_new] = index.try_emplace(edge, static_cast<std::uint32_t>(zones_.size()));
          if (is_new) {
            edges_.push_back(edge);
            zones_.emplace_back();
          }
          EdgeZone& zone = zones_[entry->second];
          zone.radius = std::max(zone.radius, measured_gap(scene, scene.half_edges[half_edge]));
          of_face_.push_back(entry->second);
        }
      }
      std::sort(of_face_.begin() + first_of_face_.back(), of_face_.end());
      of_face_.erase(std::unique(of_face_.begin() + first_of_face_.back(), of_face_.end()), of_face_.end());
      first_of_face_.push_back(static_cast<std::uint32_t>(of_face_.size()));
    }
  }
  for (std::size_t k = 0; k < zones_.size(); ++k) {
    const Edge& edge = scene.edges[edges_[k]];
    EdgeZone& zone = zones_[k];
    zone.stated = std::max({edge.tolerance, scene.vertices[edge.start].tolerance, scene.vertices[edge.end].tolerance});
    zone.radius = std::max(floor, kGapFactor * std::min(zone.radius, zone.stated));
    sample(scene, edge, zone);
    for (const Vec3& point : zone.points) zone.box.extend(point);
    double longest = 0.0;
    for (std::size_t i = 0; i + 1 < zone.points.size(); ++i) {
      longest = std::max(longest, (zone.points[i + 1] - zone.points[i]).norm());
    }
    const double bulge = zone.points.size() > 2 ? 0.5 * longest : 0.0;
    const Vec3 margin = Vec3::Constant(std::max(zone.radius, zone.stated) + bulge);
    zone.box = Box3(zone.box.min() - margin, zone.box.max() + margin);
  }
  for (std::size_t f = 0; f + 1 < first_of_face_.size(); ++f) {
    double radius = floor;
    for (std::uint32_t k = first_of_face_[f]; k < first_of_face_[f + 1]; ++k) {
      radius = std::max(radius, zones_[of_face_[k]].radius);
    }
    face_radius_.push_back(radius);
  }
}

EdgeNearness EdgeZones::test(const Scene& scene, std::uint32_t face, const Vec3& point) const {
  EdgeNearness result;
  for (std::uint32_t k = first_of_face_[face]; k < first_of_face_[face + 1]; ++k) {
    const EdgeZone& zone = zones_[of_face_[k]];
    if (!zone.box.contains(point)) continue;
    const Edge& edge = scene.edges[edges_[of_face_[k]]];
    const double limit = std::max(zone.radius, zone.stated);
    const double distance = distance_to_edge(edge, zone, point, std::min(zone.radius, zone.stated), limit);
    if (distance > limit) continue;
    result.within_stated |= distance <= zone.stated;
    if (distance <= zone.radius) {
      result.doubtful = true;
      result.radius = std::max(result.radius, zone.radius);
    }
  }
  return result;
}

}  // namespace lamella::reference
