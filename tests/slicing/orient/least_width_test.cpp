#include "slicing/orient/least_width.h"

#include <array>
#include <atomic>
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/support/solid_builder.h"
#include "tests/support/solids.h"
#include "tests/support/swept_solids.h"
#include "tests/support/transform_scene.h"

namespace lamella::test {
namespace {

SupportFunction support_of(const Scene& scene) {
  std::vector<SolidId> solids;
  for (const SolidId id : scene.solids.ids()) solids.push_back(id);
  return SupportFunction(scene, solids);
}

LeastWidth least_of(const Scene& scene, const LeastWidthLimits& limits = {}) {
  return find_least_width(support_of(scene), limits);
}

/// The height is `least`, and proved.
void expect_least(const LeastWidth& found, double least, double relative = 1e-7) {
  EXPECT_GE(found.height, least * (1.0 - 1e-9));
  EXPECT_LE(found.height, least * (1.0 + relative));
  EXPECT_LE(found.proved, least * (1.0 + 1e-12));
  EXPECT_GE(found.proved, least * (1.0 - relative));
  EXPECT_LE(found.gap(), relative);
}

TEST(LeastWidth, OfABoxIsItsShortestSideHoweverItIsTurned) {
  const Scene box = scene_of(add_box, Vec3(0, 0, 0), Vec3(7, 5, 11));
  expect_least(least_of(box), 5.0);
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Placement turn = random_rotation(seed);
    const LeastWidth found = least_of(placed(box, turn));
    expect_least(found, 5.0);
    EXPECT_NEAR(std::abs(found.direction.dot(turn.linear * Vec3::UnitY())), 1.0, 1e-9);
  }
}

TEST(LeastWidth, OfAConeStandsOnNoSide) {
  // A slender cone is least high between a line of its side and the far end of its base: 2 r cos(half angle).
  const double radius = 3.0;
  const double height = 10.0;
  const double half_angle = std::atan(radius / height);
  for (unsigned seed = 1; seed <= 5; ++seed)
    expect_least(least_of(placed(scene_of(add_cone, radius, height), random_rotation(seed))),
                 2.0 * radius * std::cos(half_angle));
}

TEST(LeastWidth, OfAFlatEllipsoidIsItsAxisAndOfATorusItsTube) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    expect_least(least_of(placed(scene_of(add_revolved_ellipsoid, 6.0, 2.5), random_rotation(seed))), 5.0);
    expect_least(least_of(placed(scene_of(add_torus, 6.0, 1.5), random_rotation(seed))), 3.0);
  }
}

TEST(LeastWidth, ALongCylindersWholeRingOfOptimaIsProved) {
  expect_least(least_of(placed(scene_of(add_cylinder, 2.0, 30.0), random_rotation(4))), 4.0);
}

TEST(LeastWidth, OfTwoSolidsTogetherIsThatOfTheirHull) {
  // Two unit cubes at opposite corners of a cube of 3: the hull's faces are the cubes' and oblique ones.
  Scene scene;
  add_box(scene, Vec3(0, 0, 0), Vec3(1, 1, 1));
  add_box(scene, Vec3(2, 2, 2), Vec3(3, 3, 3));
  // Across the diagonal the hull is a hexagonal bar: between two of its long edges' planes, the diagonal of the unit
  // square across (1,-1,0).
  expect_least(least_of(scene), std::sqrt(2.0));
}

TEST(LeastWidth, AtItsLimitItStillStatesATrueBound) {
  LeastWidthLimits limits;
  limits.max_cells = 200;
  const LeastWidth found = least_of(scene_of(add_sphere, 5.0), limits);
  EXPECT_NEAR(found.height, 10.0, 1e-9);
  EXPECT_LE(found.proved, 10.0);
  EXPECT_GT(found.proved, 9.0);
  EXPECT_GT(found.gap(), 1e-4);
  EXPECT_LE(found.cells, 200U);
}

TEST(LeastWidth, ATighterGapIsReached) {
  LeastWidthLimits limits;
  limits.gap = 1e-10;
  const LeastWidth found = least_of(placed(scene_of(add_frustum, 4.0, 1.0, 3.0), random_rotation(9)), limits);
  EXPECT_LE(found.gap(), 1e-10);
}

TEST(LeastWidth, StopsWhenCancelled) {
  std::atomic<bool> cancel{true};
  const Scene sphere = scene_of(add_sphere, 5.0);
  EXPECT_THROW((void)find_least_width(support_of(sphere), {}, {}, Progress({}, &cancel)), Cancelled);
}

}  // namespace
}  // namespace lamella::test
