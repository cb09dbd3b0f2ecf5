#include "slicing/combine.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <random>

#include "tests/slicing/combine_row.h"

namespace lamella {
namespace {

using test::faces_of_tolerance;
using test::Row;
using test::segment;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(CombineRow, LabelsDisjointSpans) {
  Row row;
  const SolidId a = row.add_solid(0, 0, 0);
  const SolidId b = row.add_solid(1, 0, 1);
  row.add_span(b, 5, 6);
  row.add_span(a, 0, 2);
  row.add_span(a, 3, 4);
  const CombinedRow out = row.combine();
  EXPECT_EQ(out.segments, (std::vector{segment(0, 2, 0, a), segment(3, 4, 0, a), segment(5, 6, 1, b)}));
  EXPECT_TRUE(out.overlaps.empty());
  EXPECT_TRUE(out.gaps.empty());
}

TEST(CombineRow, LetsTheHigherRankWinAndMeasuresTheOverlap) {
  Row row;
  const SolidId matrix = row.add_solid(0, 0, 0);
  const SolidId insert = row.add_solid(1, 1, 0);
  row.add_span(matrix, 0, 10);
  row.add_span(insert, 4, 6);
  row.add_span(insert, 9, 12);
  const CombinedRow out = row.combine();
  EXPECT_EQ(out.segments, (std::vector{segment(0, 4, 0, matrix), segment(4, 6, 1, insert), segment(6, 9, 0, matrix),
                                       segment(9, 12, 1, insert)}));
  EXPECT_EQ(out.overlaps, (std::vector{PairLength{matrix, insert, 3.0}}));
}

TEST(CombineRow, MergesNeighboursOfOneSolidAndKeepsSolidsOfOneMaterialApart) {
  Row row;
  const SolidId a = row.add_solid(0, 0, 1);
  const SolidId b = row.add_solid(0, 0, 0);
  row.add_span(a, 0, 2);
  row.add_span(a, 2, 3);
  row.add_span(b, 1, 5);
  const CombinedRow out = row.combine();
  EXPECT_EQ(out.segments, (std::vector{segment(0, 3, 0, a), segment(3, 5, 0, b)}));
  EXPECT_TRUE(out.overlaps.empty()) << "one material unites";
}

TEST(CombineRow, ReportsEveryPairOfThreeSolidsOverOneAnother) {
  Row row;
  const SolidId a = row.add_solid(0, 0, 0);
  const SolidId b = row.add_solid(1, 1, 0);
  const SolidId c = row.add_solid(2, 2, 0);
  row.add_span(a, 0, 10);
  row.add_span(b, 2, 8);
  row.add_span(c, 4, 9);
  const CombinedRow out = row.combine();
  EXPECT_EQ(out.segments,
            (std::vector{segment(0, 2, 0, a), segment(2, 4, 1, b), segment(4, 9, 2, c), segment(9, 10, 0, a)}));
  EXPECT_EQ(out.overlaps, (std::vector{PairLength{a, b, 6.0}, PairLength{a, c, 5.0}, PairLength{b, c, 4.0}}));
}

TEST(CombineRow, IgnoresSpansThatAreEmptyReversedOrNotFinite) {
  Row row;
  const SolidId a = row.add_solid(0, 0, 0);
  const SolidId b = row.add_solid(1, 1, 0);
  row.add_span(a, 0, 10);
  for (const auto& [begin, end] : std::vector<std::pair<double, double>>{
           {5, 5}, {6, 4}, {kNan, 8}, {2, kNan}, {kNan, kNan}, {-kInfinity, 3}, {3, kInfinity}}) {
    row.add_span(b, begin, end);
  }
  EXPECT_EQ(row.combine().segments, (std::vector{segment(0, 10, 0, a)}));
}

TEST(CombineRow, MakesNothingOfNoSpans) {
  Row row;
  EXPECT_TRUE(row.combine().segments.empty());
}

TEST(CombineRow, GivesSmallGapsToTheHigherRankAndMeasuresThem) {
  Row row;
  row.rules.gap_tolerance = 0.01;
  const SolidId a = row.add_solid(0, 0, 0);
  const SolidId b = row.add_solid(1, 1, 0);
  row.add_span(a, 0, 1);
  row.add_span(b, 1.0078125, 2);
  row.add_span(a, 2.5, 3);
  const CombinedRow out = row.combine();
  EXPECT_EQ(out.segments, (std::vector{segment(0, 1, 0, a), segment(1, 2, 1, b), segment(2.5, 3, 0, a)}));
  EXPECT_EQ(out.gaps, (std::vector{PairLength{a, b, 0.0078125}}));
}

TEST(CombineRow, FillsAGapInARowThatHasOverlapsElsewhere) {
  Row row;
  row.rules.gap_tolerance = 0.01;
  const SolidId a = row.add_solid(0, 3, 0);
  const SolidId b = row.add_solid(1, 1, 0);
  const SolidId c = row.add_solid(2, 2, 0);
  row.add_span(a, 0, 1);
  row.add_span(b, 1.0078125, 2);
  row.add_span(c, 1.5, 3);
  const CombinedRow out = row.combine();
  EXPECT_EQ(out.segments,
            (std::vector{segment(0, 1.0078125, 0, a), segment(1.0078125, 1.5, 1, b), segment(1.5, 3, 2, c)}));
  EXPECT_EQ(out.gaps, (std::vector{PairLength{a, b, 0.0078125}}));
}

TEST(CombineRow, KeepsASmallSlotWithinOneSolid) {
  Row row;
  row.rules.gap_tolerance = 0.01;
  const SolidId a = row.add_solid(0, 0, 0);
  row.add_span(a, 0, 1);
  row.add_span(a, 1.005, 2);
  EXPECT_EQ(row.combine().segments.size(), 2u);
}

TEST(CombineRow, WidensTheGapToleranceAtFacesThatStateALargerOne) {
  Row row;
  row.rules.widen_at(faces_of_tolerance(0.5));
  const SolidId a = row.add_solid(0, 1, 0);
  const SolidId b = row.add_solid(1, 0, 0);
  row.spans.push_back({0, 1, a, FaceId{}, FaceId{0}});
  row.spans.push_back({1.25, 2, b, FaceId{}, FaceId{}});
  row.spans.push_back({2.25, 3, a, FaceId{}, FaceId{}});
  EXPECT_EQ(row.combine().segments,
            (std::vector{segment(0, 1.25, 0, a), segment(1.25, 2, 1, b), segment(2.25, 3, 0, a)}));
}

TEST(CombineRow, TakesAnOverlapWithinTheGapToleranceForTouching) {
  Row row;
  const SolidId a = row.add_solid(0, 0, 0);
  const SolidId b = row.add_solid(1, 0, 1);
  row.add_span(a, 0, 1 + 1e-12);
  row.add_span(b, 1, 2);
  const CombinedRow out = row.combine();
  EXPECT_TRUE(out.overlaps.empty());
  EXPECT_EQ(out.segments, (std::vector{segment(0, 1, 0, a), segment(1, 2, 1, b)}));
}

TEST(RowCombiner, AppendsRowAfterRowAndMergesNothingAcrossThem) {
  Row row;
  row.rules.table = &row.table;
  const SolidId a = row.add_solid(0, 0, 0);
  const SolidId b = row.add_solid(1, 1, 0);
  row.add_span(a, 0, 3);
  RowCombiner combiner;
  std::vector<Segment> segments;
  combiner.combine(row.spans, row.rules, segments);
  row.spans = {{3, 9, a, {}, {}}, {4, 5, b, {}, {}}};
  combiner.combine(row.spans, row.rules, segments);
  EXPECT_EQ(combiner.overlaps().size(), 1u);
  combiner.combine({}, row.rules, segments);
  EXPECT_TRUE(combiner.overlaps().empty());
  EXPECT_EQ(segments,
            (std::vector{segment(0, 3, 0, a), segment(3, 4, 0, a), segment(4, 5, 1, b), segment(5, 9, 0, a)}));
}

TEST(RowCombiner, KeepsWhatComesOutBehindManySolidsOfHigherRank) {
  Row row;
  row.rules.table = &row.table;
  std::vector<SolidId> solids;
  for (int s = 0; s < 6; ++s) solids.push_back(row.add_solid(static_cast<std::size_t>(s), s, 0));
  // Begun from the highest to the lowest, each ending behind those before: every one is seen at last.
  for (std::size_t s = 6; s-- > 0;)
    row.add_span(solids[s], 5.0 - static_cast<double>(s), 20.0 - static_cast<double>(s));
  const CombinedRow out = row.combine();
  ASSERT_EQ(out.segments.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    const double begin = i == 0 ? 0.0 : 14.0 + static_cast<double>(i);
    EXPECT_EQ(out.segments[i], segment(begin, 15.0 + static_cast<double>(i), 5 - i, solids[5 - i]));
  }
}

struct PolicyCase {
  OverlapPolicy policy;
  double interface;
};

class InterfacePolicy : public testing::TestWithParam<PolicyCase> {};

TEST_P(InterfacePolicy, SharesAStaggeredOverlapOfEqualPriority) {
  for (const bool first_ranks_higher : {false, true}) {
    Row row;
    row.table.policy = GetParam().policy;
    const SolidId a = row.add_solid(0, 0, first_ranks_higher ? 1 : 0);
    const SolidId b = row.add_solid(1, 0, first_ranks_higher ? 0 : 1);
    row.add_span(a, 0, 6);
    row.add_span(b, 4, 10);
    const CombinedRow out = row.combine();
    const double x = GetParam().interface;
    EXPECT_EQ(out.segments, (std::vector{segment(0, x, 0, a), segment(x, 10, 1, b)}));
    EXPECT_EQ(out.overlaps, (std::vector{PairLength{a, b, 2.0}}));
  }
}

TEST_P(InterfacePolicy, LeavesANestedRunToTheRank) {
  Row row;
  row.table.policy = GetParam().policy;
  const SolidId matrix = row.add_solid(0, 0, 0);
  const SolidId insert = row.add_solid(1, 0, 1);
  row.add_span(matrix, 0, 10);
  row.add_span(insert, 4, 6);
  EXPECT_EQ(row.combine().segments,
            (std::vector{segment(0, 4, 0, matrix), segment(4, 6, 1, insert), segment(6, 10, 0, matrix)}));
}

TEST_P(InterfacePolicy, LetsAHigherPriorityCutThrough) {
  Row row;
  row.table.policy = GetParam().policy;
  const SolidId a = row.add_solid(0, 0, 0);
  const SolidId b = row.add_solid(1, 0, 1);
  const SolidId top = row.add_solid(2, 5, 0);
  row.add_span(a, 0, 6);
  row.add_span(b, 4, 10);
  row.add_span(top, 3, 7);
  EXPECT_EQ(row.combine().segments, (std::vector{segment(0, 3, 0, a), segment(3, 7, 2, top), segment(7, 10, 1, b)}));
}

TEST_P(InterfacePolicy, UnitesSpansOfOneMaterialFirst) {
  Row row;
  row.table.policy = GetParam().policy;
  const SolidId a1 = row.add_solid(0, 0, 0);
  const SolidId a2 = row.add_solid(0, 0, 1);
  const SolidId b = row.add_solid(1, 0, 2);
  row.add_span(a1, 0, 3);
  row.add_span(a2, 2, 6);
  row.add_span(b, 4, 10);
  const double x = GetParam().interface;
  std::vector<Segment> expected{segment(0, 2, 0, a1), segment(2, x, 0, a2), segment(x, 10, 1, b)};
  EXPECT_EQ(row.combine().segments, expected);
}

INSTANTIATE_TEST_SUITE_P(Policies, InterfacePolicy,
                         testing::Values(PolicyCase{OverlapPolicy::entry, 4.0}, PolicyCase{OverlapPolicy::exit, 6.0},
                                         PolicyCase{OverlapPolicy::average, 5.0}));

/// Random rows on a lattice of whole numbers, so that ends coincide often.
Row random_row(std::mt19937& random, OverlapPolicy policy) {
  Row row;
  row.table.policy = policy;
  const auto pick = [&](int lo, int hi) { return std::uniform_int_distribution(lo, hi)(random); };
  const int solids = pick(1, 6);
  for (int s = 0; s < solids; ++s) {
    const SolidId solid = row.add_solid(static_cast<std::size_t>(pick(0, 2)), pick(0, 2), s);
    int x = pick(0, 8);
    for (int n = pick(0, 3); n > 0; --n) {
      const int length = pick(1, 8);
      row.add_span(solid, x, x + length);
      x += length + pick(0, 6);
    }
  }
  std::shuffle(row.spans.begin(), row.spans.end(), random);
  return row;
}

/// The solid of highest rank at `x`, by looking at every span.
SolidId winner_at(const Row& row, double x) {
  SolidId best;
  for (const Span& span : row.spans) {
    if (!(span.begin <= x && x < span.end)) continue;
    if (!best.valid() || row.rules.rank[span.solid] > row.rules.rank[best]) best = span.solid;
  }
  return best;
}

SolidId solid_at(const std::vector<Segment>& segments, double x) {
  SolidId found;
  for (const Segment& segment : segments) {
    if (!(segment.x_begin <= x && x < segment.x_end)) continue;
    EXPECT_FALSE(found.valid()) << "two segments at " << x;
    found = segment.solid;
  }
  return found;
}

void expect_well_formed(const Row& row, const std::vector<Segment>& segments) {
  for (std::size_t i = 0; i < segments.size(); ++i) {
    ASSERT_LT(segments[i].x_begin, segments[i].x_end);
    ASSERT_EQ(segments[i].material, row.table.assignments[segments[i].solid].material);
    if (i == 0) continue;
    ASSERT_LE(segments[i - 1].x_end, segments[i].x_begin);
    ASSERT_FALSE(segments[i - 1].x_end == segments[i].x_begin && segments[i - 1].solid == segments[i].solid);
  }
}

TEST(CombineRowProperty, AgreesWithASamplerAtEveryPointAndEnd) {
  std::mt19937 random(20240211);
  for (int trial = 0; trial < 5000; ++trial) {
    Row row = random_row(random, OverlapPolicy::priority);
    const CombinedRow out = row.combine();
    expect_well_formed(row, out.segments);
    for (double x = -0.5; x < 70.0; x += 0.5) ASSERT_EQ(solid_at(out.segments, x), winner_at(row, x)) << x;
  }
}

TEST(CombineRowProperty, MeasuresOverlapsLikeASampler) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 2000; ++trial) {
    Row row = random_row(random, OverlapPolicy::priority);
    std::map<std::pair<SolidId, SolidId>, double> expected;
    for (double x = 0.5; x < 70.0; x += 1.0) {
      for (const Span& a : row.spans) {
        for (const Span& b : row.spans) {
          const bool both = a.begin <= x && x < a.end && b.begin <= x && x < b.end && a.solid < b.solid;
          const auto& assignments = row.table.assignments;
          if (both && assignments[a.solid].material != assignments[b.solid].material) expected[{a.solid, b.solid}] += 1;
        }
      }
    }
    std::map<std::pair<SolidId, SolidId>, double> measured;
    for (const PairLength& pair : row.combine().overlaps) measured[{pair.first, pair.second}] = pair.length;
    ASSERT_EQ(measured, expected);
  }
}

/// The same row with solids renumbered and spans shuffled.
Row permuted(const Row& row, const std::vector<std::size_t>& new_id, std::mt19937& random) {
  Row out;
  out.table.policy = row.table.policy;
  out.table.materials = row.table.materials;
  out.table.assignments.resize(new_id.size());
  out.rules.rank.resize(new_id.size());
  for (std::size_t s = 0; s < new_id.size(); ++s) {
    out.table.assignments[SolidId{new_id[s]}] = row.table.assignments[SolidId{s}];
    out.rules.rank[SolidId{new_id[s]}] = row.rules.rank[SolidId{s}];
  }
  out.spans = row.spans;
  for (Span& span : out.spans) span.solid = SolidId{new_id[span.solid.value()]};
  std::shuffle(out.spans.begin(), out.spans.end(), random);
  return out;
}

class AnyPolicy : public testing::TestWithParam<OverlapPolicy> {};

TEST_P(AnyPolicy, DoesNotDependOnTheOrderOfSolidsOrSpans) {
  std::mt19937 random(99);
  for (int trial = 0; trial < 2000; ++trial) {
    Row row = random_row(random, GetParam());
    std::vector<std::size_t> new_id(row.table.assignments.size());
    for (std::size_t s = 0; s < new_id.size(); ++s) new_id[s] = s;
    std::shuffle(new_id.begin(), new_id.end(), random);
    Row other = permuted(row, new_id, random);
    std::vector<Segment> expected = row.combine().segments;
    for (Segment& segment : expected) segment.solid = SolidId{new_id[segment.solid.value()]};
    ASSERT_EQ(other.combine().segments, expected);
  }
}

TEST_P(AnyPolicy, CoversExactlyWhatTheSpansCover) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 2000; ++trial) {
    Row row = random_row(random, GetParam());
    const CombinedRow out = row.combine();
    expect_well_formed(row, out.segments);
    for (double x = -0.25; x < 70.0; x += 0.25) {
      ASSERT_EQ(solid_at(out.segments, x).valid(), winner_at(row, x).valid()) << x;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Policies, AnyPolicy,
                         testing::Values(OverlapPolicy::priority, OverlapPolicy::error, OverlapPolicy::entry,
                                         OverlapPolicy::exit, OverlapPolicy::average));

/// Scene, table and measures of solids with nothing but what ranks them.
struct RankCase {
  Scene scene;
  MaterialTable table;
  IdVector<SolidId, SolidMeasure> measures;

  SolidId add(int priority, double volume, const std::string& path, const Vec3& corner = Vec3::Zero()) {
    Solid solid;
    solid.info.path = path;
    table.assignments.push_back({MaterialId{0}, priority, ""});
    SolidMeasure measure;
    measure.volume = volume;
    measure.bounds = Box3(corner, corner + Vec3::Ones());
    measures.push_back(measure);
    return scene.solids.push_back(solid);
  }
  [[nodiscard]] IdVector<SolidId, int> rank() const { return rank_solids(scene, table, measures); }
};

TEST(RankSolids, GoesByPriorityThenVolumeThenPathThenBounds) {
  RankCase c;
  const SolidId large = c.add(0, 10.0, "/a");
  const SolidId small = c.add(0, 1.0, "/z");
  const SolidId twin = c.add(0, 1.0, "/b");
  const SolidId high = c.add(1, 100.0, "/c");
  const SolidId near = c.add(0, 1.0, "/zz", Vec3(1, 0, 0));
  const SolidId far = c.add(0, 1.0, "/zz", Vec3(2, 0, 0));
  const auto rank = c.rank();
  EXPECT_GT(rank[high], rank[twin]);
  EXPECT_GT(rank[twin], rank[small]);
  EXPECT_GT(rank[small], rank[near]);
  EXPECT_GT(rank[near], rank[far]);
  EXPECT_GT(rank[far], rank[large]);
}

TEST(RankSolids, DoesNotLetIntegrationNoiseDecide) {
  RankCase c;
  const SolidId b = c.add(0, 1000.0, "/b");
  const SolidId a = c.add(0, 1000.0 * (1 + 1e-12), "/a");
  EXPECT_GT(c.rank()[a], c.rank()[b]);
}

TEST(RankSolids, PutsAnUnknownVolumeLast) {
  RankCase c;
  const SolidId unknown = c.add(0, kNan, "/a");
  const SolidId huge = c.add(0, 1e300, "/b");
  const SolidId empty = c.add(0, 0.0, "/c");
  EXPECT_GT(c.rank()[huge], c.rank()[unknown]);
  EXPECT_GT(c.rank()[empty], c.rank()[huge]);
}

}  // namespace
}  // namespace lamella
