#include "slicing/adaptive/choose_layers.h"

#include <functional>
#include <gtest/gtest.h>
#include <random>
#include <tuple>

namespace lamella::test {
namespace {

LayerProblem problem_of(std::size_t height, std::vector<std::size_t> thicknesses,
                        const std::function<double(std::size_t, std::size_t)>& deviation) {
  LayerProblem problem;
  problem.height = height;
  problem.thicknesses = std::move(thicknesses);
  problem.missing.assign(height + 1, 0);
  for (std::size_t i = 0; i < height; ++i) {
    for (const std::size_t t : problem.thicknesses) problem.deviations.push_back(deviation(i, t));
  }
  return problem;
}

using Cost = std::tuple<std::uint64_t, std::size_t, double>;

/// Tries every stack of layers there is.
void try_all(const LayerProblem& problem, std::size_t border, Cost cost, std::optional<Cost>& best) {
  if (border >= problem.height) {
    if (!best || cost < *best) best = cost;
    return;
  }
  for (std::size_t t = 0; t < problem.thicknesses.size(); ++t) {
    const double deviation = problem.deviations[border * problem.thicknesses.size() + t];
    if (deviation == LayerProblem::kRefused) continue;
    Cost next = cost;
    for (std::size_t i = border + 1; i < border + problem.thicknesses[t]; ++i) {
      if (i > problem.height) continue;
      std::get<0>(next) += problem.missing[i];
      const bool both = i + 1 < border + problem.thicknesses[t];
      if (both && !problem.missing_both.empty()) std::get<0>(next) += problem.missing_both[i];
    }
    ++std::get<1>(next);
    std::get<2>(next) += deviation * static_cast<double>(problem.thicknesses[t]);
    try_all(problem, border + problem.thicknesses[t], next, best);
  }
}

LayerProblem random_problem(std::mt19937& random) {
  const auto whole = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); };
  std::vector<std::size_t> thicknesses;
  for (std::size_t t = 1; t <= 5; ++t) {
    if (whole(0, 2) > 0) thicknesses.push_back(t);
  }
  if (thicknesses.empty()) thicknesses.push_back(2);
  LayerProblem problem = problem_of(static_cast<std::size_t>(whole(1, 14)), thicknesses, [&](std::size_t, std::size_t) {
    return whole(0, 3) == 0 ? LayerProblem::kRefused : 0.125 * whole(0, 8);
  });
  for (std::uint64_t& cost : problem.missing) cost = static_cast<std::uint64_t>(whole(0, 3) == 0 ? whole(1, 3) : 0);
  if (whole(0, 1) == 0) return problem;
  for (std::size_t i = 0; i <= problem.height; ++i) {
    problem.missing_both.push_back(static_cast<std::uint64_t>(whole(0, 2) == 0 ? whole(1, 3) : 0));
  }
  return problem;
}

TEST(ChooseLayers, FindsWhatTryingEverythingFinds) {
  std::mt19937 random(7);
  int solved = 0;
  for (int round = 0; round < 400; ++round) {
    const LayerProblem problem = random_problem(random);
    std::optional<Cost> expected;
    try_all(problem, 0, {0, 0, 0.0}, expected);
    const LayerSearch search = choose_best(problem);
    ASSERT_EQ(search.choice.has_value(), expected.has_value()) << "round " << round;
    if (!expected) continue;
    ++solved;
    EXPECT_EQ(search.choice->missed, std::get<0>(*expected)) << "round " << round;
    EXPECT_EQ(search.choice->layers(), std::get<1>(*expected)) << "round " << round;
    EXPECT_DOUBLE_EQ(search.choice->deviation_sum, std::get<2>(*expected)) << "round " << round;
  }
  EXPECT_GT(solved, 100);
}

TEST(ChooseLayers, NeverNeedsMoreLayersThanTheGreedySchemeAndSometimesFewer) {
  std::mt19937 random(8);
  int fewer = 0;
  int stuck = 0;
  for (int round = 0; round < 400; ++round) {
    const LayerProblem problem = random_problem(random);
    const auto best = choose_best(problem).choice;
    const auto greedy = choose_greedily(problem).choice;
    if (!best) {
      EXPECT_FALSE(greedy.has_value());
      continue;
    }
    if (!greedy) {
      ++stuck;
      continue;
    }
    EXPECT_LE(best->missed, greedy->missed);
    if (best->missed == greedy->missed) {
      EXPECT_LE(best->layers(), greedy->layers());
    }
    if (best->missed < greedy->missed || best->layers() < greedy->layers()) ++fewer;
  }
  EXPECT_GT(fewer, 0);
  EXPECT_GT(stuck, 0);
}

// Nine quanta by layers of 3 or 5: who begins with 5 reaches 8 or 10, never the top.
TEST(ChooseLayers, LooksAheadToMeetTheTop) {
  LayerProblem problem = problem_of(9, {3, 5}, [](std::size_t, std::size_t) { return 0.1; });
  problem.missing[9] = 1;
  const LayerChoice best = *choose_best(problem).choice;
  EXPECT_EQ(best.borders, (std::vector<std::size_t>{0, 3, 6, 9}));
  EXPECT_EQ(best.missed, 0U);
  EXPECT_EQ(choose_greedily(problem).choice->missed, 1U);
}

TEST(ChooseLayers, MeetsABorderThatCostsRatherThanSavingALayer) {
  LayerProblem problem = problem_of(8, {2, 3, 4}, [](std::size_t, std::size_t) { return 0.0; });
  problem.missing[3] = 5;
  const LayerChoice best = *choose_best(problem).choice;
  EXPECT_EQ(best.missed, 0U);
  EXPECT_EQ(best.layers(), 3U);
  EXPECT_EQ(best.borders[1], 3U);
}

TEST(ChooseLayers, MeetsEitherOfTwoBordersThatCostTogether) {
  LayerProblem problem = problem_of(8, {3, 4, 5}, [](std::size_t, std::size_t) { return 0.0; });
  problem.missing_both.assign(9, 0);
  problem.missing_both[3] = 5;
  const LayerChoice two = *choose_best(problem).choice;
  EXPECT_EQ(two.layers(), 2U);
  EXPECT_EQ(two.missed, 0U);
  problem.missing_both[3] = 0;
  problem.missing_both[1] = 5;  // neither 1 nor 2 can be reached
  EXPECT_EQ(choose_best(problem).choice->missed, 5U);
  problem.missing_both[1] = 0;
  problem.missing_both[8] = 5;  // the top: 8 or 9
  EXPECT_EQ(choose_best(problem).choice->missed, 0U);
}

TEST(ChooseLayers, TakesTheLeastDeviationOfTheFewestLayers) {
  // Two layers of 3 and 2 quanta in either order; the lower one deviates more the thicker it is.
  const LayerProblem problem =
      problem_of(5, {2, 3}, [](std::size_t i, std::size_t t) { return i == 0 ? 0.1 * t : 0.1; });
  const LayerChoice best = *choose_best(problem).choice;
  EXPECT_EQ(best.borders, (std::vector<std::size_t>{0, 2, 5}));
  EXPECT_DOUBLE_EQ(best.largest, 0.2);
}

TEST(ChooseLayers, SaysHowFarLayersGetWhereThereAreNone) {
  const LayerProblem problem =
      problem_of(10, {1, 2}, [](std::size_t i, std::size_t t) { return i + t > 6 ? LayerProblem::kRefused : 0.0; });
  const LayerSearch search = choose_best(problem);
  EXPECT_FALSE(search.choice.has_value());
  EXPECT_EQ(search.reached.back(), 6U);
}

}  // namespace
}  // namespace lamella::test
