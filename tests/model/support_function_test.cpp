#include "model/support_function.h"

#include <array>
#include <gtest/gtest.h>

#include "model/measure.h"
#include "model/move_scene.h"
#include "tests/support/patch_solids.h"
#include "tests/support/solids.h"
#include "tests/support/swept_solids.h"
#include "tests/support/transform_scene.h"

namespace lamella::test {
namespace {

SupportFunction support_of(const Scene& scene) {
  const std::array<SolidId, 1> solid{SolidId{0}};
  return SupportFunction(scene, solid);
}

/// 60 directions all around, the same ones every time.
std::vector<Vec3> directions() {
  std::vector<Vec3> list;
  for (unsigned seed = 1; seed <= 60; ++seed) list.push_back(random_rotation(seed).linear.col(0));
  return list;
}

TEST(SupportFunction, OfRoundSolidsIsTheirClosedForm) {
  // A support function looks into its scene, which has to stay.
  const Scene scenes[] = {scene_of(add_sphere, 3.0), scene_of(add_torus, 6.0, 1.5),
                          scene_of(add_revolved_ellipsoid, 6.0, 2.5), scene_of(add_cone, 2.0, 7.0),
                          scene_of(add_extruded_ellipse, 4.0, 2.0, 3.0)};
  const SupportFunction ball = support_of(scenes[0]);
  const SupportFunction ring = support_of(scenes[1]);
  const SupportFunction ellipsoid = support_of(scenes[2]);
  const SupportFunction cone = support_of(scenes[3]);
  const SupportFunction ellipse = support_of(scenes[4]);
  for (const Vec3& d : directions()) {
    const double across = std::hypot(d.x(), d.y());
    EXPECT_NEAR(ball(d).value, 3.0, 1e-8);
    EXPECT_NEAR(ring(d).value, 6.0 * across + 1.5, 1e-7);
    EXPECT_NEAR(ellipsoid(d).value, std::hypot(6.0 * across, 2.5 * d.z()), 1e-7);
    EXPECT_NEAR(cone(d).value, std::max(2.0 * across, 7.0 * d.z()), 1e-9);
    EXPECT_NEAR(ellipse(d).value, std::hypot(4.0 * d.x(), 2.0 * d.y()) + std::max(0.0, 3.0 * d.z()), 1e-9);
  }
}

TEST(SupportFunction, GivesAPointThatReachesAsFarAsItSays) {
  const Scene scene = scene_of(add_dome, 3.0, 4.0, 2.0, 1.5);
  const SupportFunction dome = support_of(scene);
  for (const Vec3& d : directions()) {
    const Reach reach = dome(d);
    EXPECT_NEAR(d.dot(reach.point), reach.value, 1e-9);
    EXPECT_TRUE(reach.converged);
  }
}

TEST(SupportFunction, RespectsTrims) {
  // The apex of this dome lies in a square hole: the highest points are the middles of the hole's sides.
  const Scene scene = scene_of(add_pierced_dome, 0.3);
  const SupportFunction pierced = support_of(scene);
  EXPECT_NEAR(pierced(Vec3::UnitZ()).value, 1.0 - 0.3 * 0.3, 1e-9);
  EXPECT_NEAR(pierced(-Vec3::UnitZ()).value, 2.0, 1e-9);
}

TEST(SupportFunction, AgreesWithTheBoundsOfTheTurnedSolid) {
  // The bounds look along the axes only; a scene turned by the test's own code has them along any direction.
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const Placement turn = random_rotation(seed);
    for (const Scene& scene : {scene_of(add_dome, 3.0, 4.0, 2.0, 1.5), scene_of(add_revolved_ring, 5.0, 2.0, 1.0),
                               scene_of(add_pierced_dome, 0.4), scene_of(add_frustum, 2.0, 4.0, 5.0)}) {
      const Box3 box = measure_solid(placed(scene, turn), SolidId{0}).bounds;
      const SupportFunction support = support_of(scene);
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 d = turn.linear.row(axis).transpose();
        EXPECT_NEAR(support(d).value, box.max()[axis], 1e-7);
        EXPECT_NEAR(-support(-d).value, box.min()[axis], 1e-7);
      }
    }
  }
}

TEST(MoveScene, MovesEverySolidAsTheTestsOwnCodeDoes) {
  const Placement by{random_rotation(5).linear, Vec3(3.0, -2.0, 7.0)};
  for (const Scene& scene :
       {scene_of(add_dome, 3.0, 4.0, 2.0, 1.5), scene_of(add_torus, 6.0, 1.5),
        scene_of(add_revolved_ring, 5.0, 2.0, 1.0), scene_of(add_extruded_ellipse, 4.0, 2.0, 3.0)}) {
    const SolidMeasure expected = measure_solid(placed(scene, by), SolidId{0});
    const SolidMeasure found = measure_solid(moved(scene, {by.linear, by.translation}), SolidId{0});
    EXPECT_NEAR(found.volume, expected.volume, 1e-12 * expected.volume);
    EXPECT_NEAR((found.bounds.min() - expected.bounds.min()).norm(), 0.0, 1e-12);
    EXPECT_NEAR((found.bounds.max() - expected.bounds.max()).norm(), 0.0, 1e-12);
  }
}

TEST(MoveScene, PartsKeepTheirFrames) {
  Scene scene = scene_of(add_box, Vec3(0, 0, 0), Vec3(1, 2, 3));
  scene.solids[SolidId{0}].info.instance = Instance{4, random_rotation(1).linear, Vec3(1, 1, 1)};
  const Vec3 in_part(0.3, 0.4, 0.5);
  const Instance before = *scene.solids[SolidId{0}].info.instance;
  const Motion motion{random_rotation(2).linear, Vec3(5, 6, 7)};
  const Instance after = *moved(scene, motion).solids[SolidId{0}].info.instance;
  EXPECT_EQ(after.body, 4U);
  const Vec3 expected = motion.apply(before.turn * in_part + before.shift);
  EXPECT_NEAR((after.turn * in_part + after.shift - expected).norm(), 0.0, 1e-14);
  // One that the reader knew nothing of is where it was in its own frame.
  scene.solids[SolidId{0}].info.instance.reset();
  const Instance made = moved(scene, motion).solids[SolidId{0}].info.instance.value();
  EXPECT_EQ(made.turn, motion.turn);
  EXPECT_EQ(made.shift, motion.shift);
}

}  // namespace
}  // namespace lamella::test
