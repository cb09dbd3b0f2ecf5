#include "slicing/plan/order_tools.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>

namespace lamella {
namespace {

std::vector<std::uint8_t> tools_in(std::uint32_t set) {
  std::vector<std::uint8_t> tools;
  for (std::uint8_t t = 0; t < 32; ++t) {
    if ((set >> t & 1U) != 0) tools.push_back(t);
  }
  return tools;
}

/// Least cost over every order of every layer.
ChangeCost brute_force(const OrderProblem& problem, std::size_t layer = 0, int last = -1) {
  if (layer == problem.layers.size()) return {};
  std::vector<std::uint8_t> order = tools_in(problem.layers[layer]);
  if (order.empty()) return brute_force(problem, layer + 1, last);
  ChangeCost least{INT64_MAX, 0, 0};
  do {
    ChangeCost cost;
    int at = last;
    for (const std::uint8_t tool : order) {
      if (at >= 0) cost = cost + problem.cost[static_cast<std::size_t>(at)][tool];
      at = tool;
    }
    least = std::min(least, cost + brute_force(problem, layer + 1, at));
  } while (std::next_permutation(order.begin(), order.end()));
  return least;
}

ChangeCost replay(const OrderProblem& problem, const ToolOrder& order) {
  ChangeCost cost;
  int at = -1;
  for (std::size_t k = 0; k < problem.layers.size(); ++k) {
    std::vector<std::uint8_t> sorted = order.tools[k];
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(sorted, tools_in(problem.layers[k]));
    for (const std::uint8_t tool : order.tools[k]) {
      if (at >= 0) cost = cost + problem.cost[static_cast<std::size_t>(at)][tool];
      at = tool;
    }
  }
  return cost;
}

OrderProblem random_problem(std::mt19937& random, std::size_t tools, std::size_t layers, bool uniform) {
  OrderProblem problem;
  problem.cost.assign(tools, std::vector<ChangeCost>(tools));
  for (std::size_t a = 0; a < tools; ++a) {
    for (std::size_t b = 0; b < tools; ++b) {
      if (a == b) continue;
      problem.cost[a][b] =
          uniform ? ChangeCost{1, 5, 7}
                  : ChangeCost{1, static_cast<std::int64_t>(random() % 9), static_cast<std::int64_t>(random() % 9)};
    }
  }
  for (std::size_t k = 0; k < layers; ++k)
    problem.layers.push_back(static_cast<std::uint32_t>(random() % (1U << tools)));
  return problem;
}

TEST(OrderTools, CostsAsLittleAsBruteForceFindsOnAThousandRandomCases) {
  std::mt19937 random(9);
  for (int i = 0; i < 1000; ++i) {
    const OrderProblem problem = random_problem(random, 1 + random() % 4, 1 + random() % 3, i % 3 == 0);
    const ToolOrder order = order_tools(problem);
    ASSERT_EQ(order.cost, brute_force(problem)) << i;
    ASSERT_EQ(order.lower_bound, order.cost) << i;
    ASSERT_EQ(replay(problem, order), order.cost) << i;
  }
}

TEST(OrderTools, ALayerEndsWithTheToolThatTheNextOneBeginsWith) {
  OrderProblem problem;
  problem.cost.assign(3, std::vector<ChangeCost>(3, ChangeCost{1, 0, 0}));
  for (std::size_t t = 0; t < 3; ++t) problem.cost[t][t] = {};
  problem.layers = {0b011, 0b110, 0b101, 0b111};
  const ToolOrder order = order_tools(problem);
  EXPECT_EQ(order.cost.changes, 1 + 1 + 1 + 2);
  for (std::size_t k = 1; k < 4; ++k) EXPECT_EQ(order.tools[k - 1].back(), order.tools[k].front());
}

TEST(OrderTools, OfManyAlikeAreStillProvedToBeBest) {
  std::mt19937 random(2);
  const OrderProblem problem = random_problem(random, 20, 50, true);
  const ToolOrder order = order_tools(problem);
  EXPECT_EQ(order.lower_bound, order.cost);
  EXPECT_EQ(replay(problem, order), order.cost);
}

TEST(OrderTools, OfManyUnlikeComeWithALowerBound) {
  std::mt19937 random(2);
  const OrderProblem problem = random_problem(random, 16, 30, false);
  const ToolOrder order = order_tools(problem);
  EXPECT_EQ(replay(problem, order), order.cost);
  EXPECT_LE(order.lower_bound, order.cost);
  EXPECT_GT(order.lower_bound.changes, 0);
}

TEST(OrderTools, TenUnlikeToolsInALayerAreExact) {
  std::mt19937 random(4);
  OrderProblem problem = random_problem(random, 10, 0, false);
  problem.layers = {0x3FF};
  const ToolOrder order = order_tools(problem);
  std::vector<std::uint8_t> all = tools_in(0x3FF);
  std::int64_t least = INT64_MAX;
  do {
    std::int64_t purge = 0;
    for (std::size_t i = 1; i < all.size() && purge < least; ++i) purge += problem.cost[all[i - 1]][all[i]].purge;
    least = std::min(least, purge);
  } while (std::next_permutation(all.begin(), all.end()));
  EXPECT_EQ(order.cost.purge, least);
}

TEST(OrderTools, OfNoLayerOrEmptyLayersCostNothing) {
  EXPECT_EQ(order_tools({{{ChangeCost{}}}, {}}).cost, ChangeCost{});
  const ToolOrder order = order_tools({{{ChangeCost{}}}, {0, 1, 0, 1}});
  EXPECT_EQ(order.cost, ChangeCost{});
  EXPECT_TRUE(order.tools[2].empty());
}

}  // namespace
}  // namespace lamella
