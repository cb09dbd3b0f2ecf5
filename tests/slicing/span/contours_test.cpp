#include "slicing/span/contours.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "slicing/span/span_engine.h"
#include "tests/support/solids.h"

namespace lamella {
namespace {

using test::Placement;
using test::SolidOptions;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr double kTolerance = 1e-7;  // mm, the engine's own

/// The contours of the only solid of a scene.
SectionContours contours_of(const Scene& scene, double z, double chord_error = 1e-3, double tolerance = kTolerance) {
  const std::vector<SolidId> solids{SolidId{0}};
  SpanOptions options;
  options.tolerance = tolerance;
  options.threads = 1;
  const SpanEngine engine(scene, solids, options);
  SectionContours contours = engine.contours(SolidId{0}, z, chord_error);
  EXPECT_THAT(contours.findings, IsEmpty());
  EXPECT_THAT(contours.open, IsEmpty());
  const double areas = engine.section_areas(SolidId{0}, std::span(&z, 1)).front();
  EXPECT_NEAR(areas, contours.area, 1e-12 * (1.0 + contours.area));
  return contours;
}

double length_of(const std::vector<Vec2>& points) {
  double sum = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) sum += (points[(i + 1) % points.size()] - points[i]).norm();
  return sum;
}

double polygon_area(const std::vector<Vec2>& points) {
  double sum = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2& a = points[i];
    const Vec2& b = points[(i + 1) % points.size()];
    sum += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  return sum;
}

/// What an area may be off: the arcs' tolerance along the loop, and rounding.
double area_bound(const SectionContours& contours, double tolerance = kTolerance) {
  double bound = 1e-13 * (1.0 + contours.area);
  for (const SectionLoop& loop : contours.loops) bound += tolerance * length_of(loop.points);
  return bound;
}

/// Distance of the middle of every chord, and of its ends, from a curve given by a signed distance function.
double largest_deviation(const SectionLoop& loop, const std::function<double(const Vec2&)>& distance) {
  double worst = 0.0;
  for (std::size_t i = 0; i < loop.points.size(); ++i) {
    const Vec2& a = loop.points[i];
    const Vec2& b = loop.points[(i + 1) % loop.points.size()];
    for (int k = 0; k < 16; ++k) worst = std::max(worst, std::abs(distance(a + (b - a) * (k / 16.0))));
  }
  return worst;
}

SolidOptions placed(const Placement& placement) {
  SolidOptions options;
  options.placement = placement;
  return options;
}

TEST(Contours, ACylindersSectionIsACircle) {
  const Scene scene = test::scene_of(test::add_cylinder, 10.0, 20.0);
  for (const double chord_error : {1.0, 1e-2, 1e-5}) {
    const SectionContours contours = contours_of(scene, 7.3, chord_error);
    ASSERT_THAT(contours.loops, SizeIs(1));
    const SectionLoop& loop = contours.loops[0];
    EXPECT_NEAR(loop.area, 100.0 * kPi, area_bound(contours));
    EXPECT_EQ(loop.parent, -1);
    EXPECT_GT(polygon_area(loop.points), 0.0);
    EXPECT_LE(largest_deviation(loop, [](const Vec2& p) { return p.norm() - 10.0; }), chord_error + kTolerance);
  }
}

TEST(Contours, AreasAreExactToNineDigitsWhereTheToleranceAllows) {
  const auto relative = [](const Scene& scene, double z, double expected) {
    return std::abs(contours_of(scene, z, 1e-2, 1e-10).area / expected - 1.0);
  };
  EXPECT_LE(relative(test::scene_of(test::add_cylinder, 10.0, 20.0), 7.3, 100.0 * kPi), 1e-10);
  EXPECT_LE(relative(test::scene_of(test::add_sphere, 10.0), 6.0, 64.0 * kPi), 1e-10);
  EXPECT_LE(relative(test::scene_of(test::add_frustum, 6.0, 2.0, 8.0), 4.0, 16.0 * kPi), 1e-10);
  EXPECT_LE(relative(test::scene_of(test::add_box, Vec3(-1, -2, 0), Vec3(3, 4, 5)), 2.0, 24.0), 1e-14);
}

TEST(Contours, ATiltedCylindersSectionIsAnEllipse) {
  Scene scene;
  const double tilt = 0.5;
  test::add_cylinder(scene, 3.0, 40.0, placed(Placement::turned(Vec3::UnitX(), tilt, Vec3(4, 1, 0))));
  const SectionContours contours = contours_of(scene, 17.0, 1e-4);
  ASSERT_THAT(contours.loops, SizeIs(1));
  EXPECT_NEAR(contours.area, 9.0 * kPi / std::cos(tilt), area_bound(contours));
  // The axis meets the plane at y = 1 - z tan(tilt); the distance from the cylinder is at most that in the plane.
  const double y = 1.0 - 17.0 * std::tan(tilt);
  const auto off = [&](const Vec2& p) { return std::hypot(p.x() - 4.0, (p.y() - y) * std::cos(tilt)) - 3.0; };
  EXPECT_LE(largest_deviation(contours.loops[0], off), 1e-4 + kTolerance);
}

TEST(Contours, ATorusLyingDownGivesAnAnnulus) {
  const Scene scene = test::scene_of(test::add_torus, 10.0, 3.0);
  for (const double z : {-2.9, -1.0, 0.0, 0.5, 2.0, 2.999}) {
    const SectionContours contours = contours_of(scene, z);
    ASSERT_THAT(contours.loops, SizeIs(2)) << z;
    const bool outer_first = contours.loops[0].area > 0.0;
    const SectionLoop& outer = contours.loops[outer_first ? 0 : 1];
    const SectionLoop& inner = contours.loops[outer_first ? 1 : 0];
    const double reach = std::sqrt(9.0 - z * z);
    EXPECT_NEAR(outer.area, kPi * (10.0 + reach) * (10.0 + reach), area_bound(contours)) << z;
    EXPECT_NEAR(inner.area, -kPi * (10.0 - reach) * (10.0 - reach), area_bound(contours)) << z;
    EXPECT_EQ(outer.parent, -1);
    EXPECT_EQ(inner.parent, outer_first ? 0 : 1);
    EXPECT_GT(polygon_area(outer.points), 0.0);
    EXPECT_LT(polygon_area(inner.points), 0.0);
  }
}

/// Area of the section at height h of a torus that stands upright, its axis horizontal.
double upright_torus_area(double major, double minor, double h) {
  // Half the width along the axis over x = distance from the middle: sqrt(minor^2 - (hypot(x, h) - major)^2).
  const double inside = (major - minor) * (major - minor) - h * h;
  const double outside = (major + minor) * (major + minor) - h * h;
  const double from = std::sqrt(std::max(0.0, inside));
  const double to = std::sqrt(outside);
  // x = (from + to) / 2 - (to - from) / 2 cos(a) takes the roots out of both ends.
  const int steps = 200000;
  double sum = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double a = kPi * (i + 0.5) / steps;
    const double x = 0.5 * (from + to) - 0.5 * (to - from) * std::cos(a);
    const double off = std::hypot(x, h) - major;
    sum += std::sqrt(std::max(0.0, minor * minor - off * off)) * 0.5 * (to - from) * std::sin(a) * kPi / steps;
  }
  return 4.0 * sum;
}

TEST(Contours, ATorusStandingUprightGoesThroughItsSaddles) {
  Scene scene;
  test::add_torus(scene, 10.0, 3.0, placed(Placement::turned(Vec3::UnitX(), 0.5 * kPi)));
  for (const double z : {-12.9, -7.5, 0.0, 3.0, 6.9, 7.0, 7.1, 12.0, 12.9}) {
    const SectionContours contours = contours_of(scene, z);
    const double allowed = area_bound(contours) + 1e-7;  // and what 1e-8 mm off the saddle's height changes
    EXPECT_NEAR(contours.area, upright_torus_area(10.0, 3.0, z), allowed) << z;
    if (z != 7.0) {
      EXPECT_THAT(contours.loops, SizeIs(std::abs(z) < 7.0 ? 2 : 1)) << z;
    }
    for (const SectionLoop& loop : contours.loops) EXPECT_GT(loop.area, 0.0) << z;
  }
}

TEST(Contours, ABoxWithAHole) {
  const Scene scene = test::scene_of(test::add_box_with_hole, Vec3(0, 0, 0), Vec3(10, 6, 4), 2.0);
  const SectionContours contours = contours_of(scene, 0.0, 1e-3);  // at its very bottom
  ASSERT_THAT(contours.loops, SizeIs(2));
  EXPECT_NEAR(contours.area, 60.0 - 4.0 * kPi, area_bound(contours));
  const std::size_t hole = contours.loops[0].area < 0.0 ? 0 : 1;
  EXPECT_EQ(contours.loops[hole].parent, static_cast<std::int32_t>(1 - hole));
  EXPECT_THAT(contours.loops[1 - hole].points, SizeIs(4));
  EXPECT_THAT(contours_of(scene, 4.0).loops, IsEmpty());  // half-open: its top doesn't belong to it
}

TEST(Contours, ABoxWithASphericalVoid) {
  const Scene scene = test::scene_of(test::add_box_with_void, Vec3(0, 0, 0), Vec3(10, 10, 10), 4.0);
  const SectionContours contours = contours_of(scene, 6.5);
  ASSERT_THAT(contours.loops, SizeIs(2));
  EXPECT_NEAR(contours.area, 100.0 - kPi * (16.0 - 2.25), area_bound(contours));
}

/// Makes one solid of all that a scene holds.
Scene united(Scene scene) {
  Solid& first = scene.solids[SolidId{0}];
  for (const ShellId shell : scene.shells.ids()) scene.shells[shell].solid = SolidId{0};
  first.shells.count = static_cast<std::uint32_t>(scene.shells.size());
  return scene;
}

TEST(Contours, TwoBodiesThatTouchAlongAnEdgeGiveTwoLoops) {
  Scene scene;
  test::add_box(scene, Vec3(0, 0, 0), Vec3(1, 1, 1));
  test::add_box(scene, Vec3(1, 1, 0), Vec3(3, 3, 1));
  const SectionContours contours = contours_of(united(std::move(scene)), 0.5);
  ASSERT_THAT(contours.loops, SizeIs(2));
  EXPECT_DOUBLE_EQ(contours.loops[0].area, 1.0);
  EXPECT_DOUBLE_EQ(contours.loops[1].area, 4.0);
  EXPECT_THAT(contours.loops[0].points, SizeIs(4));
}

TEST(Contours, AnIslandInAHoleBelongsToTheHole) {
  Scene scene;
  test::add_box_with_void(scene, Vec3(-5, -5, -5), Vec3(5, 5, 5), 4.0);
  test::add_sphere(scene, 2.0);
  const SectionContours contours = contours_of(united(std::move(scene)), 0.3);
  ASSERT_THAT(contours.loops, SizeIs(3));
  EXPECT_NEAR(contours.area, 100.0 - kPi * (16.0 - 4.0), area_bound(contours));
  const auto index_of = [&](double area) {
    const auto found = std::find_if(contours.loops.begin(), contours.loops.end(),
                                    [&](const SectionLoop& loop) { return std::abs(loop.area - area) < 1e-3; });
    return static_cast<std::int32_t>(found - contours.loops.begin());
  };
  const std::int32_t box = index_of(100.0);
  const std::int32_t hole = index_of(-kPi * (16.0 - 0.09));
  const std::int32_t island = index_of(kPi * (4.0 - 0.09));
  ASSERT_LT(std::max({box, hole, island}), 3);
  EXPECT_EQ(contours.loops[box].parent, -1);
  EXPECT_EQ(contours.loops[hole].parent, box);
  EXPECT_EQ(contours.loops[island].parent, hole);
}

TEST(Contours, AreasDoNotDependOnATurnAboutTheBuildDirection) {
  const auto area = [](double angle, auto add) {
    Scene scene;
    const Mat3 tilt = Placement::turned(Vec3(1, 2, 0), 0.4).linear;
    Placement placement;
    placement.linear = Placement::turned(Vec3::UnitZ(), angle).linear * tilt;
    add(scene, placed(placement));
    const SectionContours contours = contours_of(scene, 1.1);
    return std::pair(contours.area, area_bound(contours));
  };
  const auto torus = [](Scene& scene, const SolidOptions& at) { test::add_torus(scene, 10.0, 3.0, at); };
  const auto box = [](Scene& scene, const SolidOptions& at) {
    test::add_box_with_hole(scene, Vec3(-5, -5, -5), Vec3(5, 5, 5), 2.0, at);
  };
  const auto dome = [](Scene& scene, const SolidOptions& at) { test::add_dome(scene, 10.0, 8.0, 5.0, 3.0, at); };
  for (const double angle : {0.3, 67.0 * kPi / 180.0, 2.5, 0.5 * kPi}) {
    EXPECT_NEAR(area(0.0, torus).first, area(angle, torus).first, area(angle, torus).second);
    EXPECT_NEAR(area(0.0, box).first, area(angle, box).first, area(angle, box).second);
    EXPECT_NEAR(area(0.0, dome).first, area(angle, dome).first, area(angle, dome).second);
  }
}

TEST(Contours, FineRowsAddUpToTheArea) {
  Scene scene;
  test::add_torus(scene, 10.0, 3.0, placed(Placement::turned(Vec3(1, 0.3, 0), 0.7)));
  const std::vector<SolidId> solids{SolidId{0}};
  const SpanEngine engine(scene, solids, {});
  const double z = 2.0;
  const double area = engine.contours(SolidId{0}, z, 1e-2).area;
  for (const double angle : {0.0, 0.6}) {
    RowLattice lattice;
    lattice.along = Vec2(std::cos(angle), std::sin(angle));
    lattice.across = Vec2(-std::sin(angle), std::cos(angle));
    lattice.spacing = 1e-3;
    lattice.first_row = -16000;
    lattice.last_row = 16000;
    const std::vector<LayerRequest> request{{0, z, {lattice}}};
    std::vector<LayerSpans> out(1);
    engine.cut(request, out);
    double sum = 0.0;
    for (const Span& span : out[0].lattices[0].spans) sum += (span.end - span.begin) * lattice.spacing;
    // Rows near a turn, where widths go like a square root, miss a share of spacing^1.5.
    EXPECT_NEAR(sum, area, 5.0 * std::pow(lattice.spacing, 1.5)) << angle;
  }
}

TEST(Contours, ManyHeightsGiveWhatEachGives) {
  Scene scene;
  test::add_torus(scene, 10.0, 3.0, placed(Placement::turned(Vec3(1, 0.3, 0), 0.7)));
  const std::vector<SolidId> solids{SolidId{0}};
  const SpanEngine engine(scene, solids, {});
  std::vector<double> heights;
  for (int k = 0; k < 60; ++k) heights.push_back(-9.0 + 0.3 * k);
  const std::vector<SectionContours> all = engine.contours(SolidId{0}, heights, 1e-3);
  const std::vector<double> areas = engine.section_areas(SolidId{0}, heights);
  ASSERT_THAT(all, SizeIs(heights.size()));
  for (std::size_t k = 0; k < heights.size(); ++k) {
    const SectionContours one = engine.contours(SolidId{0}, heights[k], 1e-3);
    EXPECT_EQ(all[k].loops.size(), one.loops.size()) << heights[k];
    EXPECT_NEAR(all[k].area, one.area, 3.0 * area_bound(one)) << heights[k];
    EXPECT_NEAR(all[k].area, areas[k], 1e-12 * (1.0 + areas[k])) << heights[k];
  }
}

TEST(Contours, ASolidThatTheEngineWasNotMadeForHasNone) {
  const Scene scene = test::touching_boxes();
  const std::vector<SolidId> solids{SolidId{1}};
  const SpanEngine engine(scene, solids, {});
  EXPECT_THAT(engine.contours(SolidId{0}, 0.5, 1e-3).loops, IsEmpty());
  EXPECT_THAT(engine.contours(SolidId{1}, 0.5, 1e-3).loops, SizeIs(1));
}

}  // namespace
}  // namespace lamella
