#include "slicing/layer_lengths.h"

#include <gtest/gtest.h>
#include <map>
#include <random>
#include <utility>

namespace lamella {
namespace {

TEST(PairSums, AddsUpByPairAndListsThemInOrder) {
  std::mt19937 random(3);
  std::uniform_int_distribution<std::size_t> id(0, 99);
  PairSums sums;
  std::vector<PairLength> out;
  for (const int count : {5000, 3, 0, 200}) {
    sums.clear();
    std::map<std::pair<SolidId, SolidId>, double> expected;
    for (int i = 0; i < count; ++i) {
      const PairLength length{SolidId{id(random)}, SolidId{id(random)}, 0.25 * i};
      expected[{length.first, length.second}] += length.length;
      sums.add(length);
    }
    sums.write(out);
    ASSERT_EQ(out.size(), expected.size());
    std::size_t i = 0;
    for (const auto& [pair, length] : expected) {
      EXPECT_EQ(out[i], (PairLength{pair.first, pair.second, length}));
      ++i;
    }
  }
}

TEST(LengthSums, AddsUpSpansSegmentsAndPairsOfALayer) {
  MaterialTable table;
  table.materials.push_back({});
  table.materials.push_back({});
  table.assignments.push_back({MaterialId{0}, 0, ""});
  table.assignments.push_back({MaterialId{1}, 1, ""});
  CombineRules rules;
  rules.table = &table;
  rules.rank.push_back(0);
  rules.rank.push_back(1);
  const std::vector<Span> row{{0, 4, SolidId{0}, {}, {}}, {1, 2, SolidId{1}, {}, {}}, {3, 6, SolidId{1}, {}, {}}};
  RowCombiner combiner;
  LengthSums sums;
  LayerLengths lengths;
  for (int layer = 0; layer < 2; ++layer) {
    sums.clear(2, 2);
    for (int r = 0; r < 10; ++r) {
      std::vector<Segment> segments;
      combiner.combine(row, rules, segments);
      sums.add(row, segments, combiner);
    }
    sums.write(lengths);
    EXPECT_EQ(lengths.solids, (std::vector<double>{40, 40}));
    EXPECT_EQ(lengths.materials, (std::vector<double>{20, 40}));
    EXPECT_EQ(lengths.overlaps, (std::vector{PairLength{SolidId{0}, SolidId{1}, 20}}));
    EXPECT_TRUE(lengths.gaps.empty());
  }
}

}  // namespace
}  // namespace lamella
