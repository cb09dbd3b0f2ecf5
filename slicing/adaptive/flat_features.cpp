#include "slicing/adaptive/flat_features.h"

#include <algorithm>
#include <cmath>

#include "model/critical_points.h"
#include "model/curve_extrema.h"
#include "model/evaluate.h"
#include "slicing/adaptive/crease_slants.h"
#include "slicing/adaptive/edge_slants.h"

namespace lamella {

namespace {

/// The slant where a vertical direction lies between normals is 1 up to the rounding of the place, squared.
constexpr double kVertical = 1.0 - 1e-7;

/// Of an edge's range: normals that near to a crease's end are those on its two sides.
constexpr double kBeside = 1e-7;

SolidId solid_of(const Scene& scene, HalfEdgeId id) {
  return scene.solid_of(scene.loops[scene.half_edges[id].loop].face);
}

/// Where creases of the two faces end in the edge, if a vertical lies between the normals around: three patches or more
/// meet there as faces do at a vertex, also where the edge runs on in a slope.
void add_crease_ends(const Scene& scene, HalfEdgeId half_edge, const FaceSlants& face, const FaceSlants& neighbor,
                     std::vector<FlatFeature>& out) {
  const HalfEdge& half = scene.half_edges[half_edge];
  const Edge& edge = scene.edges[half.edge];
  std::vector<double> shares = crease_crossings(face, scene, half_edge);
  for (const double share : crease_crossings(neighbor, scene, half.twin)) shares.push_back(share);
  for (const double share : shares) {
    std::vector<Vec3> normals;
    for (const double beside : {share - kBeside, share + kBeside}) {
      normals.push_back(face.normal_at(parameters_at(scene, half_edge, beside)));
      normals.push_back(neighbor.normal_at(parameters_at(scene, half.twin, beside)));
    }
    if (largest_slant_among(normals) < kVertical) continue;
    const double z = evaluate<3>(edge.curve, edge.range.lo + share * edge.range.length()).point.z();
    out.push_back({z, FlatKind::extremum, solid_of(scene, half_edge)});
  }
}

}  // namespace

std::vector<FlatFeature> flat_features(const Scene& scene, FaceId id, const FaceSlants& face) {
  const SolidId solid = scene.solid_of(id);
  const Interval& z = face.heights();
  if (z.length() <= kSameHeight) return {{z.middle(), FlatKind::face, solid}};
  const Face& shape = scene.faces[id];
  if (std::holds_alternative<Plane>(shape.surface)) return {};
  const TrimRegion region(scene, id);
  const CriticalPoints critical = find_critical_points(shape.surface, shape.uv_bounds);
  std::vector<FlatFeature> out;
  for (const CriticalPoint& point : critical.points) {
    if (point.kind == CriticalKind::saddle || region.classify(point.uv) == TrimRegion::Side::outside) continue;
    out.push_back({point.z, FlatKind::extremum, solid});
  }
  for (const double level : critical.levels) {
    if (level >= z.lo - kSameHeight && level <= z.hi + kSameHeight) out.push_back({level, FlatKind::extremum, solid});
  }
  return out;
}

std::vector<FlatFeature> flat_features(const Scene& scene, HalfEdgeId half_edge, const FaceSlants& face,
                                       const FaceSlants& neighbor) {
  const HalfEdge& half = scene.half_edges[half_edge];
  const Edge& edge = scene.edges[half.edge];
  std::vector<FlatFeature> out;
  if (edge.degenerate) return out;
  std::vector<double> shares;
  const Box3 box = exact_bounds(edge.curve, edge.range);
  if (box.sizes().z() <= kSameHeight) {
    shares.push_back(0.5);
  } else {
    for (const double t : critical_parameters(edge.curve, edge.range, Vec3::UnitZ())) {
      shares.push_back((t - edge.range.lo) / edge.range.length());
    }
  }
  for (const double share : shares) {
    const Vec3 a = face.normal_at(parameters_at(scene, half_edge, share));
    const Vec3 b = neighbor.normal_at(parameters_at(scene, half.twin, share));
    if (largest_slant_between({a, 0.0}, {b, 0.0}) < kVertical) continue;
    const double z = evaluate<3>(edge.curve, edge.range.lo + share * edge.range.length()).point.z();
    out.push_back({z, FlatKind::extremum, solid_of(scene, half_edge)});
  }
  add_crease_ends(scene, half_edge, face, neighbor, out);
  return out;
}

std::vector<FlatFeature> joined(std::vector<FlatFeature> features) {
  const auto order = [](const FlatFeature& a, const FlatFeature& b) {
    if (a.z != b.z) return a.z < b.z;
    return a.kind != b.kind ? a.kind > b.kind : a.solid < b.solid;
  };
  std::sort(features.begin(), features.end(), order);
  std::vector<FlatFeature> out;
  for (const FlatFeature& feature : features) {
    if (out.empty() || feature.z - out.back().z > kSameHeight) {
      out.push_back(feature);
      continue;
    }
    out.back().count += feature.count;
    if (feature.kind <= out.back().kind) continue;
    out.back().kind = feature.kind;
    out.back().solid = feature.solid;
    out.back().z = feature.z;
  }
  return out;
}

}  // namespace lamella
