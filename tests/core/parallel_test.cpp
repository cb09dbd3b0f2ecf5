#include "core/parallel.h"

#include <atomic>
#include <gtest/gtest.h>
#include <mutex>
#include <numeric>
#include <set>
#include <stdexcept>
#include <vector>

#include "core/ordered_pipeline.h"

namespace lamella {
namespace {

TEST(CountThreads, TakesNoMoreThanThereAreCores) {
  EXPECT_EQ(count_threads(1), 1);
  EXPECT_GE(count_threads(0), 1);
  EXPECT_EQ(count_threads(1'000'000), count_threads(0));
}

TEST(ParallelForWithin, SharesTheThreadsOfTheLoopAroundIt) {
  std::vector<std::vector<int>> out(20, std::vector<int>(50));
  parallel_for(out.size(), [&](std::size_t i) {
    parallel_for_within(out[i].size(), [&](std::size_t k) { out[i][k] = static_cast<int>(i + k); });
    EXPECT_EQ(std::accumulate(out[i].begin(), out[i].end(), 0), static_cast<int>(50 * i + 49 * 25));
  });
}

TEST(OrderedPipeline, FinishesEveryItemOnceInOrder) {
  for (const int threads : {1, 2, 0}) {
    std::vector<std::size_t> slots(5);
    std::vector<std::size_t> finished;
    ordered_pipeline(
        1000, slots.size(), [&](std::size_t item, std::size_t slot) { slots[slot] = item; },
        [&](std::size_t item, std::size_t slot) {
          EXPECT_EQ(slots[slot], item) << "nobody else may write into the slot";
          finished.push_back(item);
        },
        threads);
    std::vector<std::size_t> expected(1000);
    std::iota(expected.begin(), expected.end(), std::size_t{0});
    EXPECT_EQ(finished, expected);
  }
}

TEST(OrderedPipeline, KeepsNoMoreItemsInFlightThanAsked) {
  std::atomic<int> in_flight{0};
  std::atomic<int> most{0};
  ordered_pipeline(
      500, 3,
      [&](std::size_t, std::size_t) {
        const int now = ++in_flight;
        int before = most;
        while (before < now && !most.compare_exchange_weak(before, now)) {
        }
      },
      [&](std::size_t, std::size_t) { --in_flight; });
  EXPECT_EQ(in_flight, 0);
  EXPECT_LE(most, 3);
}

TEST(OrderedPipeline, DoesNothingForNoItems) {
  const PipelineStage never = [](std::size_t, std::size_t) { FAIL(); };
  ordered_pipeline(0, 4, never, never);
}

TEST(OrderedPipeline, RethrowsWhatAStageThrowsAndFinishesNoneBehindIt) {
  std::vector<std::size_t> finished;
  const auto finish = [&](std::size_t item, std::size_t) { finished.push_back(item); };
  const auto fail_at_7 = [](std::size_t item, std::size_t) {
    if (item == 7) throw std::runtime_error("seven");
  };
  EXPECT_THROW(ordered_pipeline(1000, 4, fail_at_7, finish), std::runtime_error);
  EXPECT_LE(finished.size(), 7u);
  const auto nothing = [](std::size_t, std::size_t) {};
  EXPECT_THROW(ordered_pipeline(1000, 4, nothing, fail_at_7), std::runtime_error);
}

}  // namespace
}  // namespace lamella
