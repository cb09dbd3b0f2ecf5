#include "slicing/contact/alike_pairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>

#include "model/instances.h"

namespace lamella {

namespace {

/// Placements of what is alike agree but for rounding, which is below 1e-12 of the place.
constexpr double kSamePlace = 1e-8;  // mm
constexpr double kPerMicrometre = 1e3;

/// So many solids that are said to be instances of one body and aren't shifted copies of one another are kept in mind.
constexpr std::size_t kMostKinds = 4;

/// What shifted instances of a body have in common.
using Trait = std::tuple<std::size_t, std::size_t, std::array<double, 9>, double>;

std::optional<Trait> trait_of(const Scene& scene, SolidId solid) {
  const SolidInfo& info = scene.solids[solid].info;
  if (!info.instance || !info.closed || info.status != SolidStatus::ok) return std::nullopt;
  std::array<double, 9> turn{};
  std::copy_n(info.instance->turn.data(), turn.size(), turn.begin());
  return Trait{info.file, info.instance->body, turn, info.instance->shift.z()};
}

Vec2 place_of(const Scene& scene, SolidId solid) {
  const auto& instance = scene.solids[solid].info.instance;
  return instance ? Vec2(instance->shift.head<2>()) : Vec2(0.0, 0.0);
}

/// Of every solid of the pairs one that it is a shifted copy of, itself where there is none.
class Kinds {
 public:
  Kinds(const Scene& scene, std::span<const SolidPair> pairs) : scene_(scene) {
    for (const auto& [first, second] : pairs) {
      add(first);
      add(second);
    }
  }
  [[nodiscard]] SolidId of(SolidId solid) const { return kinds_.at(solid); }

 private:
  void add(SolidId solid) {
    if (!kinds_.emplace(solid, solid).second) return;
    const auto trait = trait_of(scene_, solid);
    if (!trait) return;
    std::vector<SolidId>& known = first_[*trait];
    const auto like = std::find_if(known.begin(), known.end(), [&](SolidId other) {
      return is_shifted(scene_, other, solid, shift_between(scene_, other, solid)) &&
             have_parallel_faces(scene_, other, solid);
    });
    if (like != known.end()) {
      kinds_[solid] = *like;
    } else if (known.size() < kMostKinds) {
      known.push_back(solid);
    }
  }

  const Scene& scene_;
  std::map<SolidId, SolidId> kinds_;
  std::map<Trait, std::vector<SolidId>> first_;
};

/// A solid as one near it sees it: what it is, and where from there, to a micrometre.
struct Sight {
  SolidId kind;
  std::int64_t x = 0;
  std::int64_t y = 0;

  auto operator<=>(const Sight&) const = default;
};

/// All that decides about a pair's contact: the first solid, the second, and all near the first.
struct Surroundings {
  SolidId kind;
  Sight second;
  std::vector<Sight> near;  ///< ascending

  auto operator<=>(const Surroundings&) const = default;
};

class Sorter {
 public:
  Sorter(const Scene& scene, std::span<const SolidPair> pairs) : scene_(scene), pairs_(pairs), kinds_(scene, pairs) {
    for (const auto& [first, second] : pairs) {
      near_[first].push_back(second);
      near_[second].push_back(first);
    }
    for (auto& [solid, others] : near_) sort_near(solid, others);
  }

  [[nodiscard]] std::vector<AlikePairs> run() {
    std::vector<std::size_t> order(pairs_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto place = [&](std::size_t i) {
      const Vec2 first = place_of(scene_, pairs_[i].first);
      const Vec2 second = place_of(scene_, pairs_[i].second);
      return std::tuple(first.y(), first.x(), second.y(), second.x());
    };
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return place(a) < place(b); });
    for (const std::size_t i : order) add(i);
    return std::move(alike_);
  }

 private:
  [[nodiscard]] Vec2 way(SolidId from, SolidId to) const { return place_of(scene_, to) - place_of(scene_, from); }

  [[nodiscard]] Sight sight(SolidId from, SolidId to) const {
    const Vec2 aside = way(from, to);
    return {kinds_.of(to), std::llround(aside.x() * kPerMicrometre), std::llround(aside.y() * kPerMicrometre)};
  }

  void sort_near(SolidId solid, std::vector<SolidId>& others) const {
    std::sort(others.begin(), others.end(), [&](SolidId a, SolidId b) { return sight(solid, a) < sight(solid, b); });
  }

  [[nodiscard]] Surroundings surroundings_of(const SolidPair& pair) const {
    Surroundings out{kinds_.of(pair.first), sight(pair.first, pair.second), {}};
    for (const SolidId other : near_.at(pair.first)) out.near.push_back(sight(pair.first, other));
    return out;
  }

  void add(std::size_t i) {
    std::vector<std::size_t>& known = of_surroundings_[surroundings_of(pairs_[i])];
    const auto found = std::find_if(known.begin(), known.end(),
                                    [&](std::size_t place) { return is_like(pairs_[alike_[place].first], pairs_[i]); });
    if (found != known.end()) {
      alike_[*found].like.push_back(i);
      return;
    }
    known.push_back(alike_.size());
    alike_.push_back({i, {}});
  }

  /// Beyond the micrometre.
  [[nodiscard]] bool is_like(const SolidPair& a, const SolidPair& b) const {
    const auto agree = [&](SolidId of_a, SolidId of_b) {
      return (way(a.first, of_a) - way(b.first, of_b)).cwiseAbs().maxCoeff() <= kSamePlace;
    };
    const auto& near_a = near_.at(a.first);
    const auto& near_b = near_.at(b.first);
    return agree(a.second, b.second) && std::equal(near_a.begin(), near_a.end(), near_b.begin(), near_b.end(), agree);
  }

  const Scene& scene_;
  std::span<const SolidPair> pairs_;
  Kinds kinds_;
  std::map<SolidId, std::vector<SolidId>> near_;
  std::map<Surroundings, std::vector<std::size_t>> of_surroundings_;
  std::vector<AlikePairs> alike_;
};

}  // namespace

Vec3 shift_between(const Scene& scene, SolidId from, SolidId to) {
  const Vec2 way = place_of(scene, to) - place_of(scene, from);
  return {way.x(), way.y(), 0.0};
}

std::vector<AlikePairs> find_alike_pairs(const Scene& scene, std::span<const SolidPair> pairs) {
  return Sorter(scene, pairs).run();
}

}  // namespace lamella
