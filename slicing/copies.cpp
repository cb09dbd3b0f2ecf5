#include "slicing/copies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <tuple>

#include "model/instances.h"

namespace lamella {

namespace {

/// Solids further apart than this and their tolerances can't touch: it is far above rounding.
constexpr double kApart = 1e-3;  // mm

/// Placements of copies agree but for rounding, which is below 1e-12 of the place.
constexpr double kSamePlace = 1e-8;  // mm

/// Bounds of copies agree to what the search for the extrema of faces leaves open.
constexpr double kSameBounds = 1e-6;  // mm

bool is_apart(const Box3& a, const Box3& b, double distance) {
  return ((a.min() - b.max()).array() > distance).any() || ((b.min() - a.max()).array() > distance).any();
}

/// Disjoint sets.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
  std::size_t root(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) { parent_[root(a)] = root(b); }

 private:
  std::vector<std::size_t> parent_;
};

double widest_tolerance(const Scene& scene) {
  double widest = 0.0;
  for (const Face& face : scene.faces) widest = std::max(widest, face.tolerance);
  for (const Solid& solid : scene.solids) widest = std::max(widest, solid.info.max_tolerance);
  return widest;
}

/// Sweeps along y.
std::vector<Cluster> find_clusters(const Scene& scene, const IdVector<SolidId, SolidMeasure>& measures,
                                   std::span<const SolidId> solids) {
  const double distance = kApart + widest_tolerance(scene);
  std::vector<std::size_t> order(solids.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto box = [&](std::size_t i) -> const Box3& { return measures[solids[i]].bounds; };
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return box(a).min().y() < box(b).min().y(); });
  Sets sets(solids.size());
  std::vector<std::size_t> open;
  for (const std::size_t i : order) {
    std::erase_if(open, [&](std::size_t j) { return box(i).min().y() - box(j).max().y() > distance; });
    for (const std::size_t j : open) {
      if (!is_apart(box(i), box(j), distance)) sets.join(i, j);
    }
    open.push_back(i);
  }
  std::map<std::size_t, Cluster> clusters;
  for (std::size_t i = 0; i < solids.size(); ++i) {
    Cluster& cluster = clusters[sets.root(i)];
    cluster.solids.push_back(solids[i]);
    cluster.bounds.extend(box(i));
  }
  std::vector<Cluster> result;
  for (auto& [root, cluster] : clusters) result.push_back(std::move(cluster));
  return result;
}

/// What copies of a solid have in common, and where it lies in its cluster to a micrometre.
using Trait = std::tuple<std::size_t, std::size_t, std::array<double, 9>, double, std::int64_t, std::int64_t>;

Trait trait_of(const Scene& scene, SolidId solid, const Vec3& corner) {
  const SolidInfo& info = scene.solids[solid].info;
  const Instance& instance = *info.instance;
  std::array<double, 9> turn;
  std::copy_n(instance.turn.data(), turn.size(), turn.begin());
  constexpr double kPerMicrometre = 1e3;
  const auto rounded = [&](int axis) { return std::llround((instance.shift[axis] - corner[axis]) * kPerMicrometre); };
  return {info.file, instance.body, turn, instance.shift.z(), rounded(0), rounded(1)};
}

/// The sorted traits of a cluster; empty if one of its solids isn't known as an instance of a sound body. Its solids
/// are brought into the same order.
std::vector<Trait> traits_of(const Scene& scene, Cluster& cluster) {
  std::vector<std::pair<Trait, SolidId>> all;
  for (const SolidId solid : cluster.solids) {
    const SolidInfo& info = scene.solids[solid].info;
    if (!info.instance || !info.closed || info.status != SolidStatus::ok) return {};
    all.emplace_back(trait_of(scene, solid, cluster.bounds.min()), solid);
  }
  std::sort(all.begin(), all.end());
  std::vector<Trait> traits;
  for (std::size_t i = 0; i < all.size(); ++i) {
    traits.push_back(all[i].first);
    cluster.solids[i] = all[i].second;
  }
  return traits;
}

/// Whether `other` is `first` but for a shift in the plane.
bool is_copy(const Scene& scene, const Cluster& first, const Cluster& other) {
  const auto shift = [&](SolidId solid) { return scene.solids[solid].info.instance->shift; };
  const Vec3 offset = shift(other.solids.front()) - shift(first.solids.front());
  const auto is_moved = [&](const Vec3& from, const Vec3& to) {
    return (from + offset - to).cwiseAbs().maxCoeff() <= kSameBounds;
  };
  if (!is_moved(first.bounds.min(), other.bounds.min()) || !is_moved(first.bounds.max(), other.bounds.max()))
    return false;
  for (std::size_t i = 0; i < first.solids.size(); ++i) {
    const Vec3 miss = shift(other.solids[i]) - shift(first.solids[i]) - offset;
    if (!(miss.cwiseAbs().maxCoeff() <= kSamePlace)) return false;
    if (!is_shifted(scene, first.solids[i], other.solids[i], offset)) return false;
    if (!have_parallel_faces(scene, first.solids[i], other.solids[i])) return false;
  }
  return true;
}

}  // namespace

std::vector<CopiedCluster> find_copies(const Scene& scene, const IdVector<SolidId, SolidMeasure>& measures,
                                       std::span<const SolidId> solids) {
  std::map<std::vector<Trait>, std::vector<Cluster>> alike;
  for (Cluster& cluster : find_clusters(scene, measures, solids)) {
    std::vector<Trait> traits = traits_of(scene, cluster);
    if (!traits.empty()) alike[std::move(traits)].push_back(std::move(cluster));
  }
  std::vector<CopiedCluster> result;
  for (auto& [traits, clusters] : alike) {
    std::sort(clusters.begin(), clusters.end(), [](const Cluster& a, const Cluster& b) {
      return std::tuple(a.bounds.min().y(), a.bounds.min().x()) < std::tuple(b.bounds.min().y(), b.bounds.min().x());
    });
    CopiedCluster copied;
    const auto shift = [&](const Cluster& cluster) -> Vec2 {
      return scene.solids[cluster.solids.front()].info.instance->shift.head<2>();
    };
    for (Cluster& cluster : clusters) {
      if (!copied.copies.empty() && !is_copy(scene, copied.copies.front(), cluster)) continue;
      copied.offsets.push_back(copied.copies.empty() ? Vec2(0, 0) : shift(cluster) - shift(copied.copies.front()));
      copied.copies.push_back(std::move(cluster));
    }
    if (copied.copies.size() > 1) result.push_back(std::move(copied));
  }
  return result;
}

}  // namespace lamella
