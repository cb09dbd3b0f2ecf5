#include "slicing/plan/load_tools.h"

#include <algorithm>
#include <bit>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <set>

#include "slicing/plan/load_search.h"
#include "slicing/plan/matching.h"

namespace lamella {
namespace {

/// Fewest reloads by trying every load of every tool at every layer; a tool that is empty costs nothing to load.
class BruteForce {
 public:
  explicit BruteForce(const LoadProblem& problem) : problem_(problem) {}

  /// UINT64_MAX when there is none.
  std::uint64_t run() {
    std::map<std::vector<int>, std::uint64_t> reached{{std::vector<int>(problem_.tools, -1), 0}};
    for (const auto& layer : problem_.layers) {
      std::map<std::vector<int>, std::uint64_t> next;
      for (const auto& [loads, cost] : reached) assign(layer, 0, loads, 0, cost, next);
      reached = std::move(next);
    }
    std::uint64_t least = UINT64_MAX;
    for (const auto& [loads, cost] : reached) least = std::min(least, cost);
    return least;
  }

 private:
  /// Gives material i of the layer any tool that isn't taken, and goes on with the next one.
  void assign(const std::vector<std::uint32_t>& layer, std::size_t i, const std::vector<int>& loads,
              std::uint32_t taken, std::uint64_t cost, std::map<std::vector<int>, std::uint64_t>& next) {
    if (i == layer.size()) {
      const auto [found, is_new] = next.emplace(loads, cost);
      found->second = std::min(found->second, cost);
      return;
    }
    for (std::uint32_t tool = 0; tool < problem_.tools; ++tool) {
      if ((taken >> tool & 1U) != 0 || (problem_.holders[layer[i]] >> tool & 1U) == 0) continue;
      std::vector<int> after = loads;
      const bool is_reload = loads[tool] >= 0 && loads[tool] != static_cast<int>(layer[i]);
      after[tool] = static_cast<int>(layer[i]);
      assign(layer, i + 1, after, taken | 1U << tool, cost + (is_reload ? 1 : 0), next);
    }
  }

  const LoadProblem& problem_;
};

/// How many reloads the schedule needs by its own account; fails the test when it breaks a rule.
std::uint64_t replay(const LoadProblem& problem, const LoadSchedule& schedule) {
  std::vector<int> loads(problem.tools, -1);
  std::uint64_t reloads = 0;
  EXPECT_EQ(schedule.tool_of.size(), problem.layers.size());
  for (std::size_t k = 0; k < problem.layers.size(); ++k) {
    std::set<std::uint32_t> taken;
    EXPECT_EQ(schedule.tool_of[k].size(), problem.layers[k].size());
    for (std::size_t i = 0; i < problem.layers[k].size(); ++i) {
      const std::uint32_t tool = schedule.tool_of[k][i];
      const std::uint32_t material = problem.layers[k][i];
      EXPECT_TRUE(taken.insert(tool).second) << "two materials in one tool";
      EXPECT_TRUE((problem.holders[material] >> tool & 1U) != 0) << "a tool that can't hold it";
      if (loads[tool] >= 0 && loads[tool] != static_cast<int>(material)) ++reloads;
      loads[tool] = static_cast<int>(material);
    }
  }
  return reloads;
}

enum class Kind { universal, classes, restricted };

LoadProblem random_problem(std::mt19937& random, Kind kind) {
  const auto pick = [&](std::uint32_t low, std::uint32_t high) {
    return std::uniform_int_distribution<std::uint32_t>(low, high)(random);
  };
  LoadProblem problem;
  problem.tools = pick(1, 3);
  const std::uint32_t all = (1U << problem.tools) - 1U;
  const std::uint32_t materials = pick(1, 5);
  for (std::uint32_t m = 0; m < materials; ++m) {
    std::uint32_t holders = all;
    if (kind == Kind::restricted) holders = pick(1, all);
    if (kind == Kind::classes && problem.tools > 1) holders = m % 2 == 0 ? 1U : all & ~1U;
    problem.holders.push_back(holders);
  }
  const std::uint32_t layers = pick(1, 7);
  for (std::uint32_t k = 0; k < layers; ++k) {
    problem.layers.emplace_back();
    for (std::uint32_t m = 0; m < materials; ++m) {
      if (pick(0, 9) < 4) problem.layers.back().push_back(m);
    }
  }
  return problem;
}

class LoadTools : public ::testing::TestWithParam<Kind> {};

TEST_P(LoadTools, NeedAsFewReloadsAsBruteForceFindsOnAThousandRandomCases) {
  std::mt19937 random(7);
  int solved = 0;
  int reloading = 0;
  while (solved < 1000) {
    const LoadProblem problem = random_problem(random, GetParam());
    const std::uint64_t least = BruteForce(problem).run();
    const LoadVerdict verdict = judge_loads(problem);
    ASSERT_EQ(verdict.fault == LoadFault::none, least != UINT64_MAX);
    if (verdict.fault != LoadFault::none) continue;
    const LoadSchedule schedule = schedule_loads(problem);
    ASSERT_EQ(schedule.reloads, least);
    ASSERT_EQ(schedule.lower_bound, least);
    ASSERT_EQ(replay(problem, schedule), least);
    ++solved;
    reloading += least > 0 ? 1 : 0;
  }
  EXPECT_GT(reloading, 100);
}

INSTANTIATE_TEST_SUITE_P(Kinds, LoadTools, ::testing::Values(Kind::universal, Kind::classes, Kind::restricted));

TEST(LoadTools, AreRefusedWithTheMaterialOrTheLayerThatIsToBlame) {
  LoadProblem problem{2, {3, 3, 3, 0}, {{0, 1}, {1, 2}}, false};
  EXPECT_EQ(judge_loads(problem).fault, LoadFault::needs_reloading);
  problem.may_reload = true;
  EXPECT_EQ(judge_loads(problem).fault, LoadFault::none);
  problem.layers.push_back({0, 1, 2});
  EXPECT_EQ(judge_loads(problem).fault, LoadFault::layer_needs_too_much);
  EXPECT_EQ(judge_loads(problem).which, 2U);
  problem.layers.push_back({3});
  EXPECT_EQ(judge_loads(problem).fault, LoadFault::material_fits_no_tool);
  EXPECT_EQ(judge_loads(problem).which, 3U);
}

TEST(LoadTools, StateALowerBoundWhereTheSearchIsTooLarge) {
  // 8 tools, 12 materials, each tool closed to one of them: too many loads to search through.
  LoadProblem problem;
  problem.tools = 8;
  for (std::uint32_t m = 0; m < 12; ++m) problem.holders.push_back(0xFFU & ~(1U << m % 8));
  std::mt19937 random(3);
  for (int k = 0; k < 400; ++k) {
    problem.layers.emplace_back();
    for (std::uint32_t m = 0; m < 12 && problem.layers.back().size() < 6; ++m) {
      if (random() % 2 == 0) problem.layers.back().push_back(m);
    }
  }
  ASSERT_EQ(judge_loads(problem).fault, LoadFault::none);
  const LoadSchedule schedule = schedule_loads(problem);
  EXPECT_EQ(replay(problem, schedule), schedule.reloads);
  EXPECT_LE(schedule.lower_bound, schedule.reloads);
  EXPECT_GT(schedule.lower_bound, 0U);
}

TEST(LoadTools, ByMatchingNeverBeatTheLeast) {
  std::mt19937 random(11);
  double excess = 0.0;
  double least_sum = 0.0;
  for (int i = 0; i < 300; ++i) {
    const LoadProblem problem = random_problem(random, Kind::restricted);
    if (judge_loads(problem).fault != LoadFault::none) continue;
    LoadSchedule schedule{load_by_matching(problem.layers, problem.holders, problem.tools), 0, 0};
    const std::uint64_t least = BruteForce(problem).run();
    const std::uint64_t found = replay(problem, schedule);
    ASSERT_GE(found, least);
    excess += static_cast<double>(found - least);
    least_sum += static_cast<double>(least);
  }
  EXPECT_LT(excess, 0.5 * least_sum);
}

TEST(Matching, ACrowdIsNamedWhereThereIsNoMatching) {
  std::mt19937 random(8);
  int crowds = 0;
  for (int i = 0; i < 2000; ++i) {
    const std::size_t tools = 1 + random() % 6;
    std::vector<std::uint32_t> materials;
    std::vector<std::uint32_t> holders;
    for (std::uint32_t m = 0; m < 1 + random() % 7; ++m) {
      materials.push_back(m);
      holders.push_back(static_cast<std::uint32_t>(random() & random() & ((1U << tools) - 1U)));
    }
    const auto crowd = find_crowd(materials, holders);
    ASSERT_EQ(crowd.has_value(), !match_tools(materials, holders).has_value());
    if (!crowd) continue;
    ++crowds;
    std::uint32_t all = 0;
    for (const std::uint32_t material : crowd->materials) all |= holders[material];
    EXPECT_EQ(all, crowd->tools);
    const std::set<std::uint32_t> named(crowd->materials.begin(), crowd->materials.end());
    EXPECT_EQ(named.size(), crowd->materials.size());
    EXPECT_EQ(static_cast<std::size_t>(std::popcount(all)) + 1, named.size());
  }
  EXPECT_GT(crowds, 200);
}

TEST(Matching, CheapestIsThatOfAllPermutations) {
  std::mt19937 random(5);
  for (int i = 0; i < 200; ++i) {
    const std::size_t rows = 1 + random() % 4;
    const std::size_t columns = rows + random() % 3;
    std::vector<std::vector<double>> cost(rows, std::vector<double>(columns));
    for (auto& row : cost) {
      for (double& c : row) c = static_cast<double>(random() % 20);
    }
    std::vector<std::size_t> order(columns);
    for (std::size_t c = 0; c < columns; ++c) order[c] = c;
    double least = 1e300;
    do {
      double sum = 0.0;
      for (std::size_t r = 0; r < rows; ++r) sum += cost[r][order[r]];
      least = std::min(least, sum);
    } while (std::next_permutation(order.begin(), order.end()));
    const auto found = match_cheapest(cost);
    double sum = 0.0;
    std::set<std::uint32_t> taken;
    for (std::size_t r = 0; r < rows; ++r) {
      sum += cost[r][found[r]];
      EXPECT_TRUE(taken.insert(found[r]).second);
    }
    ASSERT_DOUBLE_EQ(sum, least);
  }
}

}  // namespace
}  // namespace lamella
