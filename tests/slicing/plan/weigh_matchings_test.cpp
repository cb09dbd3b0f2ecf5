#include "slicing/plan/weigh_matchings.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>
#include <random>

namespace lamella {
namespace {

/// A problem and what changing tools costs.
struct Weighable : MatchingProblem {
  std::vector<std::vector<ChangeCost>> change;

  [[nodiscard]] std::optional<WeighedMatching> weighed(std::uint64_t steps = kWeighingSteps) const {
    PathCache paths(change);
    return weigh_matchings(*this, paths, steps);
  }
};

/// Least cost over every matching, and every order of every layer.
class BruteForceMatching {
 public:
  explicit BruteForceMatching(const Weighable& problem) : problem_(problem) {}

  /// Nothing when there is no matching.
  std::optional<ChangeCost> run() {
    std::vector<std::uint32_t> tools(problem_.change.size());
    std::iota(tools.begin(), tools.end(), 0U);
    std::optional<ChangeCost> least;
    // Every injection is the beginning of some permutation of the tools.
    do {
      if (!fits(tools)) continue;
      ChangeCost cost = cheapest_orders(tools, 0, -1);
      for (std::size_t n = 0; n < problem_.holders.size(); ++n) {
        if (is_used(n)) cost.time += problem_.laying_time[n][tools[n]];
      }
      if (!least || cost < *least) least = cost;
    } while (std::next_permutation(tools.begin(), tools.end()));
    return least;
  }

  [[nodiscard]] bool is_used(std::size_t need) const {
    return std::any_of(problem_.layers.begin(), problem_.layers.end(),
                       [&](const auto& layer) { return std::find(layer.begin(), layer.end(), need) != layer.end(); });
  }

  /// Of all orders of the layers from `layer` on, where `last` is the tool in use.
  ChangeCost cheapest_orders(const std::vector<std::uint32_t>& tool_of, std::size_t layer, int last) {
    if (layer == problem_.layers.size()) return {};
    std::vector<std::uint32_t> tools;
    for (const std::uint32_t need : problem_.layers[layer]) tools.push_back(tool_of[need]);
    if (tools.empty()) return cheapest_orders(tool_of, layer + 1, last);
    std::sort(tools.begin(), tools.end());
    std::optional<ChangeCost> least;
    do {
      ChangeCost cost;
      int at = last;
      for (const std::uint32_t tool : tools) {
        if (at >= 0) cost = cost + problem_.change[static_cast<std::size_t>(at)][tool];
        at = static_cast<int>(tool);
      }
      cost = cost + cheapest_orders(tool_of, layer + 1, at);
      if (!least || cost < *least) least = cost;
    } while (std::next_permutation(tools.begin(), tools.end()));
    return *least;
  }

 private:
  [[nodiscard]] bool fits(const std::vector<std::uint32_t>& tools) const {
    for (std::size_t n = 0; n < problem_.holders.size(); ++n) {
      if (is_used(n) && (problem_.holders[n] >> tools[n] & 1U) == 0) return false;
    }
    return true;
  }

  const Weighable& problem_;
};

/// What the tools cost is drawn from few numbers, so that tools are often alike.
Weighable random_matching(std::mt19937& random, std::size_t tools, std::size_t needs, std::size_t layers,
                          std::uint32_t kinds) {
  const auto pick = [&](std::uint32_t below) { return static_cast<std::int64_t>(random() % below); };
  Weighable problem;
  // Tools that are alike in changes may differ in speed, and the other way round.
  std::vector<std::size_t> kind;
  std::vector<std::size_t> speed;
  for (std::size_t t = 0; t < tools; ++t) {
    kind.push_back(static_cast<std::size_t>(pick(kinds)));
    speed.push_back(static_cast<std::size_t>(pick(2)));
  }
  std::vector<std::vector<ChangeCost>> of_kinds(kinds, std::vector<ChangeCost>(kinds));
  for (auto& row : of_kinds) {
    for (ChangeCost& cost : row) cost = {1, pick(4), pick(4)};
  }
  problem.change.assign(tools, std::vector<ChangeCost>(tools));
  for (std::size_t a = 0; a < tools; ++a) {
    for (std::size_t b = 0; b < tools; ++b) {
      if (a != b) problem.change[a][b] = of_kinds[kind[a]][kind[b]];
    }
  }
  for (std::size_t n = 0; n < needs; ++n) {
    const bool is_restricted = pick(3) == 0;
    problem.holders.push_back(
        static_cast<std::uint32_t>(is_restricted ? 1 + pick((1U << tools) - 1U) : (1 << tools) - 1));
    problem.laying_time.emplace_back();
    const std::vector<std::int64_t> times{pick(6), pick(6)};
    for (std::size_t t = 0; t < tools; ++t) problem.laying_time.back().push_back(times[speed[t]]);
  }
  for (std::size_t k = 0; k < layers; ++k) {
    problem.layers.emplace_back();
    // Often the same as below.
    if (k > 0 && pick(2) == 0) {
      problem.layers.back() = problem.layers[k - 1];
      continue;
    }
    for (std::uint32_t n = 0; n < needs; ++n) {
      if (pick(5) < 3) problem.layers.back().push_back(n);
    }
  }
  return problem;
}

/// The cost of the matching that was found, added up anew.
ChangeCost replayed_cost(const Weighable& problem, const WeighedMatching& found) {
  BruteForceMatching brute(problem);
  std::uint32_t taken = 0;
  ChangeCost cost = brute.cheapest_orders(found.tool_of, 0, -1);
  for (std::size_t n = 0; n < problem.holders.size(); ++n) {
    if (!brute.is_used(n)) continue;
    const std::uint32_t bit = 1U << found.tool_of[n];
    EXPECT_EQ(taken & bit, 0U) << "two needs in one tool";
    EXPECT_NE(problem.holders[n] & bit, 0U) << "a tool that can't hold it";
    taken |= bit;
    cost.time += problem.laying_time[n][found.tool_of[n]];
  }
  return cost;
}

TEST(WeighMatchings, FindAsLittleAsBruteForceDoesOnTwoThousandRandomCases) {
  std::mt19937 random(12);
  int solved = 0;
  int many = 0;
  while (solved < 2000) {
    const std::size_t tools = 1 + random() % 4;
    const Weighable problem = random_matching(random, tools, 1 + random() % tools, 1 + random() % 4, 3);
    const auto least = BruteForceMatching(problem).run();
    const auto found = problem.weighed();
    ASSERT_EQ(found.has_value(), least.has_value());
    if (!least) continue;
    ++solved;
    ASSERT_EQ(found->cost, *least) << solved;
    ASSERT_EQ(found->lower_bound, *least) << solved;
    ASSERT_EQ(replayed_cost(problem, *found), *least) << solved;
    many += found->weighed > 2 ? 1 : 0;
  }
  EXPECT_GT(many, 300);
}

TEST(WeighMatchings, WithoutTimeToWeighAllBoundWhatTheyFind) {
  std::mt19937 random(13);
  int unproved = 0;
  int best = 0;
  constexpr int kCases = 1000;
  for (int i = 0; i < kCases; ++i) {
    const Weighable problem = random_matching(random, 5, 3 + random() % 3, 1 + random() % 3, 4);
    // Local improvement may take ever so few steps.
    const auto found = problem.weighed(1 + random() % 2000);
    const auto least = BruteForceMatching(problem).run();
    ASSERT_EQ(found.has_value(), least.has_value());
    if (!least) continue;
    ASSERT_LE(found->lower_bound, *least);
    ASSERT_GE(found->cost, *least);
    ASSERT_EQ(replayed_cost(problem, *found), found->cost);
    unproved += found->is_proved() ? 0 : 1;
    best += found->cost == *least ? 1 : 0;
  }
  EXPECT_GT(unproved, kCases / 10);
  EXPECT_GT(best, kCases / 4);
}

/// Twelve materials in twelve tools, six alike and six alike: 924 ways instead of 479 001 600.
TEST(WeighMatchings, AlikeToolsStandForOneAnother) {
  Weighable problem;
  problem.change.assign(12, std::vector<ChangeCost>(12));
  for (std::size_t a = 0; a < 12; ++a) {
    for (std::size_t b = 0; b < 12; ++b) {
      // Leading to a tool of the second kind purges more.
      if (a != b) problem.change[a][b] = {1, b < 6 ? 1 : 3, 0};
    }
  }
  problem.holders.assign(12, 0xFFFU);
  problem.laying_time.assign(12, std::vector<std::int64_t>(12));
  std::mt19937 random(3);
  for (int k = 0; k < 20; ++k) {
    problem.layers.emplace_back();
    for (std::uint32_t n = 0; n < 12; ++n) {
      if (random() % 12 >= n && problem.layers.back().size() < 6) problem.layers.back().push_back(n);
    }
  }
  const auto found = problem.weighed(UINT64_MAX / 4);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->is_proved());
  EXPECT_LE(found->weighed, 924U + 2U);
  EXPECT_GT(found->weighed, 900U);
}

TEST(WeighMatchings, ALongStayCostsWhatItsLayersCostOneByOne) {
  std::mt19937 random(21);
  for (int i = 0; i < 20; ++i) {
    Weighable problem = random_matching(random, 4, 4, 0, 4);
    problem.holders.assign(4, 0xFU);
    for (int k = 0; k < 3; ++k) {
      std::vector<std::uint32_t> needs;
      for (std::uint32_t n = 0; n < 4; ++n) {
        if (random() % 4 != 0) needs.push_back(n);
      }
      for (std::size_t n = 1 + random() % 100; n > 0; --n) problem.layers.push_back(needs);
    }
    const auto found = problem.weighed();
    ASSERT_TRUE(found);
    OrderProblem order{problem.change, {}};
    ChangeCost laying;
    for (const auto& layer : problem.layers) {
      order.layers.push_back(0);
      for (const std::uint32_t need : layer) order.layers.back() |= 1U << found->tool_of[need];
    }
    for (std::uint32_t n = 0; n < 4; ++n) {
      const bool is_used = BruteForceMatching(problem).is_used(n);
      if (is_used) laying.time += problem.laying_time[n][found->tool_of[n]];
    }
    EXPECT_EQ(order_tools(order).cost + laying, found->cost);
  }
}

/// Where changes are free the time of laying down is all there is, whatever the steps suffice for.
TEST(WeighMatchings, FreeChangesLeaveTheFastestTools) {
  std::mt19937 random(17);
  Weighable problem;
  problem.change.assign(14, std::vector<ChangeCost>(14));
  problem.holders.assign(12, (1U << 14) - 1);
  for (std::size_t n = 0; n < 12; ++n) {
    problem.laying_time.emplace_back();
    for (std::size_t t = 0; t < 14; ++t) problem.laying_time.back().push_back(t == n + 1 ? 1 : 100 + random() % 9);
  }
  for (int k = 0; k < 30; ++k) {
    problem.layers.emplace_back();
    for (std::uint32_t n = 0; n < 12; ++n) {
      if (k == 0 || n != static_cast<std::uint32_t>(k) % 12) problem.layers.back().push_back(n);
    }
  }
  for (const std::uint64_t steps : {std::uint64_t{1}, kWeighingSteps}) {
    const auto found = problem.weighed(steps);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->lower_bound, (ChangeCost{0, 0, 12}));
    EXPECT_GE(found->cost, found->lower_bound);
    EXPECT_EQ(found->is_proved(), steps == kWeighingSteps);
  }
}

TEST(WeighMatchings, OfNothingIsNothing) {
  Weighable problem;
  problem.change = {{ChangeCost{}}};
  problem.holders = {1U};
  problem.layers = {{}, {}};
  problem.laying_time = {{5}};
  const auto found = problem.weighed();
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->is_proved());
  EXPECT_EQ(found->cost, ChangeCost{});
  problem.holders = {1U, 1U};
  problem.layers = {{0}, {1}};
  problem.laying_time = {{5}, {5}};
  EXPECT_FALSE(problem.weighed());
}

}  // namespace
}  // namespace lamella
