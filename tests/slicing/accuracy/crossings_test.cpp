#include "slicing/accuracy/crossings.h"

#include <gtest/gtest.h>
#include <random>

namespace lamella::accuracy {
namespace {

/// Crossings of one ray.
Crossings on_ray(std::uint32_t ray, const std::vector<double>& xs) {
  Crossings crossings;
  for (const double x : xs) crossings.push_back({ray, x});
  return crossings;
}

CrossingErrors compare(const std::vector<double>& exact, const std::vector<double>& found) {
  return compare_crossings(on_ray(0, exact), on_ray(0, found));
}

TEST(CompareCrossings, EqualListsHaveNoError) {
  const CrossingErrors errors = compare({1, 2, 3, 4}, {1, 2, 3, 4});
  EXPECT_EQ(errors.matched, 4U);
  EXPECT_EQ(errors.missed + errors.false_, 0U);
  EXPECT_EQ(errors.largest, 0.0);
  EXPECT_EQ(errors.differing, 0.0);
}

TEST(CompareCrossings, MaxRmsAndMeanAreThoseOfThePairs) {
  const CrossingErrors errors = compare({0, 10}, {3, 14});
  EXPECT_EQ(errors.matched, 2U);
  EXPECT_DOUBLE_EQ(errors.largest, 4.0);
  EXPECT_DOUBLE_EQ(errors.mean(), 3.5);
  EXPECT_DOUBLE_EQ(errors.rms(), std::sqrt(12.5));
}

TEST(CompareCrossings, ALostSpanIsMissedAndAnInventedOneIsFalse) {
  CrossingErrors errors = compare({0, 10, 12, 12.5, 20, 30}, {0, 10, 20, 30});
  EXPECT_EQ(errors.matched, 4U);
  EXPECT_EQ(errors.missed, 2U);
  EXPECT_DOUBLE_EQ(errors.longest_missed, 0.5);
  errors = compare({0, 10}, {0, 10, 12, 12.5});
  EXPECT_EQ(errors.false_, 2U);
  EXPECT_DOUBLE_EQ(errors.longest_false, 0.5);
}

TEST(CompareCrossings, ALostGapIsMissedToo) {
  const CrossingErrors errors = compare({0, 5, 6, 10}, {0, 10});
  EXPECT_EQ(errors.matched, 2U);
  EXPECT_EQ(errors.missed, 2U);
  EXPECT_DOUBLE_EQ(errors.longest_missed, 1.0);
}

TEST(CompareCrossings, SpansBesideOneAnotherAreNotMatched) {
  const CrossingErrors errors = compare({0, 1}, {5, 6});
  EXPECT_EQ(errors.matched, 0U);
  EXPECT_EQ(errors.missed, 2U);
  EXPECT_EQ(errors.false_, 2U);
}

TEST(CompareCrossings, RaysDontMix) {
  Crossings exact = on_ray(3, {0, 1});
  Crossings found = on_ray(4, {0, 1});
  const CrossingErrors errors = compare_crossings(exact, found);
  EXPECT_EQ(errors.matched, 0U);
  EXPECT_EQ(errors.missed, 2U);
  EXPECT_EQ(errors.false_, 2U);
}

/// All ways to pair equal senses in order, leaving neighbours out by twos: the least total length.
double least_length(std::span<const double> exact, std::span<const double> found) {
  double least = 1e300;
  if (exact.empty() && found.empty()) return 0.0;
  if (!exact.empty() && !found.empty()) {
    least = std::abs(exact[0] - found[0]) + least_length(exact.subspan(1), found.subspan(1));
  }
  if (exact.size() > 1) least = std::min(least, exact[1] - exact[0] + least_length(exact.subspan(2), found));
  if (found.size() > 1) least = std::min(least, found[1] - found[0] + least_length(exact, found.subspan(2)));
  return least;
}

TEST(CompareCrossings, NoOtherWayIsShorter) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0.0, 10.0);
  std::uniform_int_distribution<int> spans(0, 3);
  for (int trial = 0; trial < 500; ++trial) {
    std::vector<double> lists[2];
    for (auto& list : lists) {
      list.resize(2 * static_cast<std::size_t>(spans(random)));
      for (double& x : list) x = place(random);
      std::sort(list.begin(), list.end());
    }
    const CrossingErrors errors = compare(lists[0], lists[1]);
    EXPECT_NEAR(errors.differing, least_length(lists[0], lists[1]), 1e-12);
    EXPECT_EQ(errors.matched + errors.missed, lists[0].size());
    EXPECT_EQ(errors.matched + errors.false_, lists[1].size());
  }
}

}  // namespace
}  // namespace lamella::accuracy
