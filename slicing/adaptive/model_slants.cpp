#include "slicing/adaptive/model_slants.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <map>
#include <memory>
#include <set>
#include <tuple>

#include "core/parallel.h"
#include "model/normal_cone.h"
#include "slicing/adaptive/crease_slants.h"
#include "slicing/adaptive/edge_slants.h"
#include "slicing/adaptive/face_slants.h"
#include "slicing/adaptive/flat_features.h"

namespace lamella {

namespace {

/// More faces than this meet at no vertex that is worth the third power of work.
constexpr std::size_t kMaxNormals = 32;
/// Of the normals around a pole or an apex so many are looked at.
constexpr std::size_t kAroundApex = 8;
constexpr double kHorizontal = 1.0 - 1e-9;
/// Radians, about: normals that differ by less are one.
constexpr double kSame = 1e-9;
/// Of an edge's range, and the least jump of normals, about in radians, that counts that near to a vertex.
constexpr double kBeside = 1e-7;
constexpr double kJump = 1e-5;

/// Finds the slants of the chosen solids, in passes that are parallel over faces.
class SlantFinder {
 public:
  SlantFinder(const Scene& scene, const MaterialTable& table, std::span<const SolidId> solids, const SlantGrid& grid,
              const IdVector<MaterialId, WedgeRule>& wedges, const Progress& progress, int threads)
      : scene_(scene), table_(table), grid_(grid), wedges_(wedges), progress_(progress), threads_(threads) {
    for (const SolidId solid : solids) {
      for (const ShellId shell : scene.solids[solid].shells) {
        for (const FaceId face : scene.shells[shell].faces) faces_.push_back(face);
      }
    }
    for (std::size_t i = 0; i < faces_.size(); ++i) place_of_.emplace(faces_[i], i);
  }

  void run(ModelSlants& out) {
    out.profiles.resize(table_.materials.size());
    for (const FaceId face : faces_) {
      auto& profile = out.profiles[material_of(face)];
      if (!profile) profile.emplace(grid_.bottom, grid_.width, grid_.count);
    }
    slants_.resize(faces_.size());
    parts_.resize(faces_.size());
    features_.resize(faces_.size());
    each_face("bounding normals of faces", [&](std::size_t i) {
      slants_[i] = std::make_unique<FaceSlants>(scene_, faces_[i]);
      parts_[i] = slants_[i]->parts(grid_.width);
      features_[i] = flat_features(scene_, faces_[i], *slants_[i]);
    });
    collect(out);
    each_face("bounding normals of edges", [&](std::size_t i) { look_at_edges(i, out); });
    collect(out);
    out.sharp_edges = sharp_edges_;
    look_at_vertices(out);
    finish(out);
    look_for_thin_places(out);
  }

 private:
  static void finish(ModelSlants& out) {
    for (auto& profile : out.profiles) {
      if (profile) profile->finish();
    }
  }

  [[nodiscard]] MaterialId material_of(FaceId face) const { return table_.assignments[scene_.solid_of(face)].material; }

  template <class Body>
  void each_face(const char* stage, const Body& body) {
    std::atomic<std::size_t> done{0};
    parallel_for(
        faces_.size(),
        [&](std::size_t i) {
          progress_.throw_if_cancelled();
          body(i);
          progress_.report(stage, static_cast<double>(++done) / static_cast<double>(faces_.size()));
        },
        threads_);
  }

  /// Takes what the faces have found, in their order.
  void collect(ModelSlants& out) {
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      for (const Slant& part : parts_[i]) out.profiles[material_of(faces_[i])]->add(part);
      out.features.insert(out.features.end(), features_[i].begin(), features_[i].end());
      parts_[i].clear();
      features_[i].clear();
    }
  }

  void look_at_edges(std::size_t i, const ModelSlants& found) {
    look_at_creases(i, found);
    for (const LoopId loop : scene_.faces[faces_[i]].loops) {
      for (const HalfEdgeId id : scene_.loops[loop].half_edges) {
        const HalfEdge& half = scene_.half_edges[id];
        if (half.twin.valid() && half.twin < id) continue;
        const FaceSlants* neighbor = half.twin.valid() ? slants_of(half.twin) : nullptr;
        const MaterialId material = material_of(faces_[i]);
        const EdgeSlants edge =
            edge_slants(scene_, id, *slants_[i], neighbor, *found.profiles[material], wedges_[material]);
        parts_[i].insert(parts_[i].end(), edge.parts.begin(), edge.parts.end());
        if (edge.is_too_sharp) ++sharp_edges_;
        if (neighbor == nullptr) continue;
        const auto flat = flat_features(scene_, id, *slants_[i], *neighbor);
        features_[i].insert(features_[i].end(), flat.begin(), flat.end());
      }
    }
  }

  void look_at_creases(std::size_t i, const ModelSlants& found) {
    const MaterialId material = material_of(faces_[i]);
    const CreaseSlants creases = crease_slants(*slants_[i], *found.profiles[material], wedges_[material]);
    parts_[i].insert(parts_[i].end(), creases.parts.begin(), creases.parts.end());
    sharp_edges_ += creases.sharp;
    for (const double z : creases.extrema) {
      features_[i].push_back({z, FlatKind::extremum, scene_.solid_of(faces_[i])});
    }
  }

  /// Thin places are those of one solid, within reach of the layers that the slants found so far let through.
  void look_for_thin_places(ModelSlants& out) {
    IdVector<MaterialId, std::optional<LayerReach>> reaches(out.profiles.size());
    for (const MaterialId id : out.profiles.ids()) {
      if (!out.profiles[id]) continue;
      reaches[id].emplace(*out.profiles[id], wedges_[id].deviation, wedges_[id].thickest);
    }
    std::map<SolidId, std::vector<const FaceSlants*>> faces;
    std::vector<std::size_t> place_in_solid;
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      std::vector<const FaceSlants*>& of_solid = faces[scene_.solid_of(faces_[i])];
      place_in_solid.push_back(of_solid.size());
      of_solid.push_back(slants_[i].get());
    }
    std::map<SolidId, ThinSearch> searches;
    for (auto& [solid, of_solid] : faces) searches.try_emplace(solid, std::move(of_solid));
    std::vector<std::vector<ThinParts>> thin(faces_.size());
    each_face("looking for thin places", [&](std::size_t i) {
      const MaterialId material = material_of(faces_[i]);
      const ThinSearch& search = searches.at(scene_.solid_of(faces_[i]));
      const auto take = [&](const ThinParts& found) {
        thin[i].push_back(found);
        for (ThinPlace& place : thin[i].back().beyond) place.face = faces_[i];
      };
      take(search.of_face(place_in_solid[i], *out.profiles[material], *reaches[material], wedges_[material]));
      for (const RidgeLine& line : lines_of(i)) {
        take(search.of_line(line, *out.profiles[material], *reaches[material], wedges_[material]));
      }
    });
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      SlantProfile& profile = *out.profiles[material_of(faces_[i])];
      for (const ThinParts& parts : thin[i]) {
        for (const Slant& part : parts.upper) profile.add_thin(part, LayerHalf::upper);
        for (const Slant& part : parts.lower) profile.add_thin(part, LayerHalf::lower);
        out.thin.insert(out.thin.end(), parts.beyond.begin(), parts.beyond.end());
      }
    }
  }

  /// The face's creases, and its edges, each with one of its faces.
  [[nodiscard]] std::vector<RidgeLine> lines_of(std::size_t i) const {
    std::vector<RidgeLine> out = crease_lines(*slants_[i]);
    for (const LoopId loop : scene_.faces[faces_[i]].loops) {
      for (const HalfEdgeId id : scene_.loops[loop].half_edges) {
        const HalfEdge& half = scene_.half_edges[id];
        if (!half.twin.valid() || half.twin < id || scene_.edges[half.edge].degenerate) continue;
        out.push_back(edge_line(scene_, id, *slants_[i], *slants_of(half.twin)));
      }
    }
    return out;
  }

  [[nodiscard]] const FaceSlants* slants_of(HalfEdgeId id) const {
    return slants_[place_of_.at(scene_.loops[scene_.half_edges[id].loop].face)].get();
  }

  /// What meets at a vertex: the normals of its faces, some of them at a pole or an apex.
  struct Around {
    FaceId face;
    std::vector<Vec3> normals;
    bool is_singular = false;
  };

  void look_at_vertices(ModelSlants& out) const {
    std::map<VertexId, Around> around;
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      for (const LoopId loop : scene_.faces[faces_[i]].loops) {
        for (const HalfEdgeId id : scene_.loops[loop].half_edges) {
          const Edge& edge = scene_.edges[scene_.half_edges[id].edge];
          for (const bool at_end : {false, true}) {
            Around& place = around[at_end ? edge.end : edge.start];
            place.face = faces_[i];
            if (!edge.degenerate) {
              add_normal(place.normals, slants_[i]->normal_at(parameters_at(scene_, id, at_end ? 1.0 : 0.0)), kSame);
              // A crease may end here: then the half-edges' normals beside the vertex are those on its two sides.
              const double beside = at_end ? 1.0 - kBeside : kBeside;
              add_normal(place.normals, slants_[i]->normal_at(parameters_at(scene_, id, beside)), kJump);
              continue;
            }
            place.is_singular = true;
            for (std::size_t k = 0; k < kAroundApex; ++k) {
              const double share = static_cast<double>(k) / kAroundApex;
              add_normal(place.normals, slants_[i]->normal_beside(parameters_at(scene_, id, share)), kSame);
            }
          }
        }
      }
    }
    for (const auto& [vertex, place] : around) add_vertex(vertex, place, out);
  }

  static void add_normal(std::vector<Vec3>& normals, const Vec3& normal, double difference) {
    const auto same = [&](const Vec3& other) { return (other - normal).norm() < difference; };
    if (std::none_of(normals.begin(), normals.end(), same)) normals.push_back(normal);
  }

  void add_vertex(VertexId vertex, const Around& place, ModelSlants& out) const {
    const double z = scene_.vertices[vertex].point.z();
    const auto unknown = [](const Vec3& normal) { return normal.isZero(); };
    const bool is_known =
        place.normals.size() <= kMaxNormals && std::none_of(place.normals.begin(), place.normals.end(), unknown);
    const double slant = is_known ? largest_slant_among(place.normals) : 1.0;
    out.profiles[material_of(place.face)]->add({{z, z}, place.is_singular ? 1.0 : slant});
    if (is_known && slant >= kHorizontal) out.features.push_back({z, FlatKind::extremum, scene_.solid_of(place.face)});
  }

  const Scene& scene_;
  const MaterialTable& table_;
  const SlantGrid grid_;
  const IdVector<MaterialId, WedgeRule>& wedges_;
  const Progress& progress_;
  int threads_;
  std::atomic<std::size_t> sharp_edges_{0};
  std::vector<FaceId> faces_;
  std::map<FaceId, std::size_t> place_of_;
  std::vector<std::unique_ptr<FaceSlants>> slants_;
  std::vector<std::vector<Slant>> parts_;
  std::vector<std::vector<FlatFeature>> features_;
};

/// Of solids that differ by a shift along x and y only, and have one material, the first.
std::vector<SolidId> without_copies(const Scene& scene, const MaterialTable& table, std::span<const SolidId> solids) {
  using Key = std::tuple<std::size_t, std::size_t, MaterialId, std::array<double, 10>>;
  std::set<Key> seen;
  std::vector<SolidId> out;
  for (const SolidId id : solids) {
    const SolidInfo& info = scene.solids[id].info;
    if (info.instance) {
      std::array<double, 10> placement{};
      std::copy(info.instance->turn.data(), info.instance->turn.data() + 9, placement.begin());
      placement[9] = info.instance->shift.z();
      if (!seen.insert({info.file, info.instance->body, table.assignments[id].material, placement}).second) continue;
    }
    out.push_back(id);
  }
  return out;
}

/// Heights of each material's solids, and where solids begin and end.
void add_solids(const MaterialTable& table, const IdVector<SolidId, SolidMeasure>& measures,
                std::span<const SolidId> solids, ModelSlants& out) {
  out.heights.resize(table.materials.size());
  Interval all{measures[solids.front()].bounds.min().z(), measures[solids.front()].bounds.max().z()};
  std::set<MaterialId> used;
  for (const SolidId id : solids) {
    const Interval z{measures[id].bounds.min().z(), measures[id].bounds.max().z()};
    out.heights[table.assignments[id].material].push_back(z);
    all = {std::min(all.lo, z.lo), std::max(all.hi, z.hi)};
    used.insert(table.assignments[id].material);
  }
  for (const SolidId id : solids) {
    for (const double z : {measures[id].bounds.min().z(), measures[id].bounds.max().z()}) {
      const bool is_inside = z > all.lo + kSameHeight && z < all.hi - kSameHeight;
      const auto kind = is_inside && used.size() > 1 ? FlatKind::material_change : FlatKind::extremum;
      out.features.push_back({z, kind, id});
    }
  }
  for (std::vector<Interval>& heights : out.heights) {
    std::sort(heights.begin(), heights.end(), [](const Interval& a, const Interval& b) { return a.lo < b.lo; });
    std::vector<Interval> apart;
    for (const Interval& z : heights) {
      if (apart.empty() || z.lo > apart.back().hi) {
        apart.push_back(z);
      } else {
        apart.back().hi = std::max(apart.back().hi, z.hi);
      }
    }
    heights = std::move(apart);
  }
}

}  // namespace

ModelSlants find_slants(const Scene& scene, const MaterialTable& table, const IdVector<SolidId, SolidMeasure>& measures,
                        std::span<const SolidId> solids, const SlantGrid& grid,
                        const IdVector<MaterialId, WedgeRule>& wedges, const Progress& progress, int threads) {
  ModelSlants out;
  const std::vector<SolidId> chosen = without_copies(scene, table, solids);
  SlantFinder(scene, table, chosen, grid, wedges, progress, threads).run(out);
  add_solids(table, measures, solids, out);
  out.features = joined(std::move(out.features));
  return out;
}

}  // namespace lamella
