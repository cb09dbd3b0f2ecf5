#include "slicing/span/arc_chain.h"

#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "slicing/span/contours.h"
#include "tests/slicing/span/hand_made_section.h"

namespace lamella::span {
namespace {

using test::add_arc_of_circle;
using test::add_polygon;
using test::one_solid;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

SectionContours assemble(const Section& section) {
  return assemble_contours(one_solid(), section, {SolidId{0}, 1.0, 1e-3});
}

std::vector<double> sorted_areas(const SectionContours& contours) {
  std::vector<double> areas;
  for (const SectionLoop& loop : contours.loops) areas.push_back(loop.area);
  std::sort(areas.begin(), areas.end());
  return areas;
}

TEST(ArcChain, FollowsNodesInAnyOrderOfTheArcs) {
  Section section;
  add_polygon(section, {{0, 0}, {3, 0}, {3, 2}, {0, 2}});
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    std::shuffle(section.arcs.begin(), section.arcs.end(), random);
    const ArcChains chains = chain_arcs(section);
    ASSERT_THAT(chains.loops, SizeIs(1));
    EXPECT_THAT(chains.loops[0], SizeIs(4));
    EXPECT_THAT(chains.open, IsEmpty());
  }
}

TEST(ArcChain, BodiesThatTouchInANodeStayTwoLoops) {
  Section section;
  add_polygon(section, {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  add_polygon(section, {{1, 1}, {2, 1}, {2, 2}, {1, 2}});
  const SectionContours contours = assemble(section);
  EXPECT_THAT(sorted_areas(contours), ElementsAre(1.0, 1.0));
}

TEST(ArcChain, AHoleThatTouchesTheBorderStaysAHole) {
  Section section;
  add_polygon(section, {{0, 0}, {2, 0}, {4, 0}, {4, 4}, {0, 4}});
  add_polygon(section, {{2, 0}, {1, 1}, {2, 2}, {3, 1}});  // clockwise
  const SectionContours contours = assemble(section);
  ASSERT_THAT(sorted_areas(contours), ElementsAre(-2.0, 16.0));
  EXPECT_EQ(contours.loops[0].parent, -1);
  EXPECT_EQ(contours.loops[1].parent, 0);
}

TEST(ArcChain, HolesThatTouchOneAnotherStayApart) {
  Section section;
  add_polygon(section, {{-5, -5}, {5, -5}, {5, 5}, {-5, 5}});
  for (const double side : {-1.0, 1.0}) {
    add_polygon(section, {{0, 0}, {side, side}, {side, 0}});  // clockwise
  }
  EXPECT_THAT(sorted_areas(assemble(section)), ElementsAre(-0.5, -0.5, 100.0));
}

TEST(ArcChain, BodiesSideBySideAlongAWallStayTwoLoops) {
  Section section;
  add_polygon(section, {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  add_polygon(section, {{1, 0}, {2, 0}, {2, 1}, {1, 1}});
  EXPECT_THAT(sorted_areas(assemble(section)), ElementsAre(1.0, 1.0));
}

TEST(ArcChain, FansOfSectorsComeApartAtTheirCommonNode) {
  for (const int count : {2, 3, 7, 12}) {
    Section section;
    for (int i = 0; i < count; ++i) {
      const double a = kTwoPi * i / count + 0.1;
      const double b = a + 0.5 * kTwoPi / count;
      add_polygon(section, {{5, 7}, {5 + std::cos(a), 7 + std::sin(a)}, {5 + std::cos(b), 7 + std::sin(b)}});
    }
    const SectionContours contours = assemble(section);
    ASSERT_THAT(contours.loops, SizeIs(count));
    for (const SectionLoop& loop : contours.loops) EXPECT_NEAR(loop.area, 0.5 * std::sin(kPi / count), 1e-15);
  }
}

TEST(ArcChain, CurvatureDecidesWhereArcsAreTangentInANode) {
  // Two circles that touch from outside, and two of which one lies in the other, both with a node where they touch.
  Section outside;
  add_arc_of_circle(outside, {0, 1}, 1.0, -kPi / 2, kTwoPi);
  add_arc_of_circle(outside, {0, -1}, 1.0, kPi / 2, kTwoPi);
  outside.arcs[1].begin = outside.arcs[1].end = outside.arcs[0].begin;
  const SectionContours apart = assemble(outside);
  ASSERT_THAT(apart.loops, SizeIs(2));
  for (const SectionLoop& loop : apart.loops) EXPECT_NEAR(loop.area, kPi, 1e-6);

  Section inside;
  add_arc_of_circle(inside, {0, 2}, 2.0, -kPi / 2, kTwoPi);
  add_arc_of_circle(inside, {0, 1}, 1.0, -kPi / 2, -kTwoPi);
  inside.arcs[1].begin = inside.arcs[1].end = inside.arcs[0].begin;
  // Halves, so that each node has two ways in and two ways out.
  const SectionContours crescent = assemble(test::halved(inside));
  EXPECT_NEAR(crescent.area, 3.0 * kPi, 1e-6);
  EXPECT_THAT(crescent.loops, SizeIs(2));
  EXPECT_THAT(crescent.open, IsEmpty());
}

TEST(ArcChain, DropsDoubledArcsAndArcsWithoutExtent) {
  Section section;
  add_polygon(section, {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  section.arcs.push_back(section.arcs[2]);
  section.arcs.push_back({FaceId{0}, {1, 0}, {1, 0}, 0, 0, true});
  const ArcChains chains = chain_arcs(section);
  EXPECT_THAT(chains.loops, SizeIs(1));
  EXPECT_THAT(chains.open, IsEmpty());
  EXPECT_EQ(chains.doubled, 1u);
  EXPECT_THAT(assemble(section).findings, SizeIs(1));
}

TEST(ArcChain, ReportsWhatDoesNotClose) {
  Section section;
  add_polygon(section, {{0, 0}, {3, 0}, {3, 2}, {0, 2}});
  add_polygon(section, {{5, 0}, {6, 0}, {6, 1}});
  section.arcs.erase(section.arcs.begin() + 1);
  const SectionContours contours = assemble(section);
  EXPECT_THAT(sorted_areas(contours), ElementsAre(0.5));
  ASSERT_THAT(contours.open, SizeIs(1));
  EXPECT_THAT(contours.open[0], ElementsAre(Vec2(3, 2), Vec2(0, 2), Vec2(0, 0), Vec2(3, 0)));
  ASSERT_THAT(contours.findings, SizeIs(1));
  EXPECT_EQ(contours.findings[0].severity, Severity::error);
  EXPECT_EQ(contours.findings[0].what, "at z = 1 mm a contour does not close: it leads from (3, 2) to (3, 0)");
}

TEST(ArcChain, ReportsArcsThatAreNotFinite) {
  Section section;
  add_polygon(section, {{0, 0}, {1, 0}, {1, 1}});
  add_polygon(section, {{5, 0}, {6, 0}, {6, 1}});
  section.pieces[0].x[1] = std::numeric_limits<double>::quiet_NaN();
  const SectionContours contours = assemble(section);
  EXPECT_THAT(contours.loops, SizeIs(1));
  EXPECT_THAT(contours.open, SizeIs(1));
  EXPECT_THAT(contours.findings, SizeIs(2));
}

TEST(Nesting, AlternatesFromOuterLoopsToHolesToIslands) {
  Section section;
  for (int depth = 0; depth < 5; ++depth) {
    const double lo = depth;
    const double hi = 20 - depth;
    std::vector<Vec2> square{{lo, lo}, {hi, lo}, {hi, hi}, {lo, hi}};
    if (depth % 2 == 1) std::reverse(square.begin(), square.end());
    add_polygon(section, square);
  }
  add_polygon(section, {{30, 0}, {31, 0}, {31, 1}});
  const SectionContours contours = assemble(section);
  std::vector<std::int32_t> parents;
  for (const SectionLoop& loop : contours.loops) parents.push_back(loop.parent);
  EXPECT_THAT(parents, ElementsAre(-1, 0, 1, 2, 3, -1));
}

TEST(Nesting, HoldsWhereAWallIsThinnerThanTheChordError) {
  Section section;
  add_arc_of_circle(section, {0, 0}, 10.0, 0.3, kTwoPi);
  add_arc_of_circle(section, {0, 0}, 9.999, 1.0, -kTwoPi);
  const SectionContours contours = assemble_contours(one_solid(), section, {SolidId{0}, 1.0, 1.0});
  ASSERT_THAT(contours.loops, SizeIs(2));
  EXPECT_EQ(contours.loops[0].parent, -1);
  EXPECT_EQ(contours.loops[1].parent, 0);
}

TEST(Contours, PolygonsPassThroughNodesThatTheArcsMissWithinTheTolerance) {
  Section section;
  add_polygon(section, {{0, 0}, {3, 0}, {3, 2}, {0, 2}});
  section.pieces[0].y[0] = 0.05;   // this face lies 0.05 off its nodes
  section.pieces[1].x[0] += 1e-5;  // this one less than matters
  const SectionContours contours = assemble(section);
  ASSERT_THAT(contours.loops, SizeIs(1));
  EXPECT_THAT(contours.loops[0].points,
              ElementsAre(Vec2(0, 0), Vec2(0, 0.05), Vec2(3, 0.05), Vec2(3, 0), Vec2(3, 2), Vec2(0, 2)));
  EXPECT_NEAR(contours.area, 6.0 - 0.15 + 2e-5, 1e-14);
}

TEST(Contours, AreasFarFromTheOriginKeepTheirDigits) {
  Section section;
  add_polygon(section, {{1e6, 1e6}, {1e6 + 1, 1e6}, {1e6 + 1, 1e6 + 1}, {1e6, 1e6 + 1}});
  EXPECT_EQ(assemble(section).area, 1.0);
  EXPECT_EQ(section_area(section), 1.0);
}

}  // namespace
}  // namespace lamella::span
