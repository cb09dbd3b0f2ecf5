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

/// Sorts solids by what they are and what is near them.
class Surroundings {
 public:
  Surroundings(const Scene& scene, std::span<const SolidPair> pairs) : scene_(scene), kinds_(scene, pairs) {
    for (const auto& [first, second] : pairs) {
      near_[first].push_back(second);
      near_[second].push_back(first);
    }
    for (auto& [solid, others] : near_) {
      std::sort(others.begin(), others.end(),
                [&, from = solid](SolidId a, SolidId b) { return sight(from, a) < sight(from, b); });
    }
  }

  [[nodiscard]] Sight sight(SolidId from, SolidId to) const {
    const Vec2 aside = way(from, to);
    return {kinds_.of(to), std::llround(aside.x() * kPerMicrometre), std::llround(aside.y() * kPerMicrometre)};
  }

  /// A number that solids share which are of one kind and have the same kinds in the same places around them.
  std::size_t number_of(SolidId solid) {
    const auto [known, is_new] = numbers_.emplace(solid, count_);
    if (!is_new) return known->second;
    std::vector<SolidId>& others = first_[{kinds_.of(solid), sights_of(solid)}];
    const auto like =
        std::find_if(others.begin(), others.end(), [&](SolidId other) { return lies_alike(other, solid); });
    if (like != others.end()) return known->second = numbers_.at(*like);
    if (others.size() < kMostKinds) others.push_back(solid);
    return count_++;
  }

 private:
  [[nodiscard]] Vec2 way(SolidId from, SolidId to) const { return place_of(scene_, to) - place_of(scene_, from); }

  [[nodiscard]] std::vector<Sight> sights_of(SolidId solid) const {
    std::vector<Sight> sights;
    for (const SolidId other : near_.at(solid)) sights.push_back(sight(solid, other));
    return sights;
  }

  /// Beyond the micrometre.
  [[nodiscard]] bool lies_alike(SolidId a, SolidId b) const {
    const auto agree = [&](SolidId of_a, SolidId of_b) {
      return (way(a, of_a) - way(b, of_b)).cwiseAbs().maxCoeff() <= kSamePlace;
    };
    return std::equal(near_.at(a).begin(), near_.at(a).end(), near_.at(b).begin(), near_.at(b).end(), agree);
  }

  const Scene& scene_;
  Kinds kinds_;
  std::map<SolidId, std::vector<SolidId>> near_;  ///< ascending as they are seen
  std::map<std::pair<SolidId, std::vector<Sight>>, std::vector<SolidId>> first_;
  std::map<SolidId, std::size_t> numbers_;
  std::size_t count_ = 0;
};

}  // namespace

Vec3 shift_between(const Scene& scene, SolidId from, SolidId to) {
  const Vec2 way = place_of(scene, to) - place_of(scene, from);
  return {way.x(), way.y(), 0.0};
}

std::vector<AlikePairs> find_alike_pairs(const Scene& scene, std::span<const SolidPair> pairs) {
  std::vector<std::size_t> order(pairs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto place = [&](std::size_t i) {
    const Vec2 first = place_of(scene, pairs[i].first);
    const Vec2 second = place_of(scene, pairs[i].second);
    return std::tuple(first.y(), first.x(), second.y(), second.x());
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return place(a) < place(b); });
  Surroundings surroundings(scene, pairs);
  std::map<std::pair<std::size_t, Sight>, std::size_t> known;
  std::vector<AlikePairs> alike;
  for (const std::size_t i : order) {
    // The second is among what is near the first, so that it needs no closer look.
    const auto& [first, second] = pairs[i];
    const std::pair key(surroundings.number_of(first), surroundings.sight(first, second));
    const auto [found, is_new] = known.emplace(key, alike.size());
    if (is_new) {
      alike.push_back({i, {}});
    } else {
      alike[found->second].like.push_back(i);
    }
  }
  return alike;
}

}  // namespace lamella
