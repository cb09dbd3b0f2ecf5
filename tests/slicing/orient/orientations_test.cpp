#include "slicing/orient/orientations.h"

#include <gtest/gtest.h>

#include "model/move_scene.h"
#include "slicing/orient/face_choice.h"
#include "slicing/orient/sphere.h"
#include "tests/support/solids.h"
#include "tests/support/transform_scene.h"

namespace lamella::test {
namespace {

struct Found {
  Scene scene;
  std::vector<SolidId> solids;
  Orientations result;

  Found(Scene made, const OrientationWishes& wishes, const JudgeOptions& options = {}) : scene(std::move(made)) {
    MaterialTable table;
    table.materials.push_back({"one", {}, {}});
    for (const SolidId id : scene.solids.ids()) {
      table.assignments.push_back({MaterialId{0}, 0, ""});
      solids.push_back(id);
    }
    const SupportFunction support(scene, solids);
    const OrientationJudge judge(scene, solids, table, measure_solids(scene), support,
                                 sample_surfaces(scene, solids, 5000), options);
    result = find_orientations(judge, support, find_least_width(support), std::nullopt, wishes);
  }
  [[nodiscard]] const OrientationCandidate& best() const { return result.candidates.front(); }
};

OrientationWishes wishes_of(OrientationWeights weights) {
  OrientationWishes wishes;
  wishes.weights = weights;
  return wishes;
}

TEST(Orientations, HeightAloneGivesTheProvedLeast) {
  const Found found(placed(scene_of(add_box, Vec3(0, 0, 0), Vec3(7, 5, 11)), random_rotation(3)),
                    wishes_of({.height = 1}));
  EXPECT_NEAR(found.best().figures.height, 5.0, 1e-9);
  EXPECT_NEAR(found.best().lying.size.z(), 5.0, 1e-9);
  // Its sides lie along the machine's axes, so that it takes the least room.
  EXPECT_NEAR(found.best().lying.size.head<2>().prod(), 77.0, 1e-6);
  EXPECT_GE(found.result.candidates.size(), 3U);
}

TEST(Orientations, ACandidatesTurnLaysTheSceneAsItSays) {
  const Found found(placed(scene_of(add_dome, 3.0, 4.0, 2.0, 1.0), random_rotation(5)), wishes_of({.height = 1}));
  for (const OrientationCandidate& one : found.result.candidates) {
    EXPECT_TRUE(is_rotation(one.lying.turn));
    EXPECT_NEAR((one.lying.turn * one.up - Vec3::UnitZ()).norm(), 0.0, 1e-12);
    const Scene turned = moved(found.scene, {one.lying.turn, Vec3::Zero()});
    EXPECT_NEAR((measure_solid(turned, SolidId{0}).bounds.sizes() - one.lying.size).norm(), 0.0, 1e-7);
  }
}

TEST(Orientations, SupportOutweighsHeightWhenItsWeightSaysSo) {
  // A frustum on its small end needs support; lying on its large end it needs none.
  const Found found(scene_of(add_frustum, 2.0, 8.0, 5.0), wishes_of({.support_volume = 1}));
  EXPECT_NEAR(found.best().figures.support_volume, 0.0, 1e-9);
  const Found low(scene_of(add_frustum, 2.0, 8.0, 5.0), wishes_of({.height = 1, .support_volume = 10}));
  EXPECT_NEAR((low.best().up + Vec3::UnitZ()).norm(), 0.0, 1e-9);
}

TEST(Orientations, ContactBringsTheLargestFaceDown) {
  const Found found(placed(scene_of(add_box, Vec3(0, 0, 0), Vec3(4, 6, 10)), random_rotation(8)),
                    wishes_of({.contact = 1}));
  EXPECT_NEAR(found.best().figures.contact_area, 60.0, 1e-6);
}

TEST(Orientations, ANamedFaceLiesDown) {
  Scene scene = placed(scene_of(add_box, Vec3(0, 0, 0), Vec3(4, 6, 10)), random_rotation(2));
  scene.faces[FaceId{0}].name = "bottom";
  scene.faces[FaceId{0}].step_entity = 77;
  OrientationWishes wishes = wishes_of({.height = 1});
  const std::vector<FaceId> named = find_named_faces(scene, "bott*", "--down");
  EXPECT_EQ(named, find_named_faces(scene, "#77", "--down"));
  ASSERT_EQ(named.size(), 1U);
  wishes.down = plane_normals(scene, named, "bott*", "--down");
  const Vec3 normal = wishes.down.front();
  const Found found(std::move(scene), wishes);
  ASSERT_EQ(found.result.candidates.size(), 1U);
  EXPECT_NEAR((found.best().up + normal).norm(), 0.0, 1e-12);
  EXPECT_GT(found.best().figures.contact_area, 0.0);
}

TEST(Orientations, AFlatBSplineFaceLiesOnThePlateAsAPlaneDoes) {
  Scene scene = scene_of(add_dome, 3.0, 4.0, 2.0, 0.0);  // no bump: its spline top is flat
  FaceId top;
  for (const FaceId id : scene.faces.ids()) {
    if (std::holds_alternative<BSplineSurface>(scene.faces[id].surface)) top = id;
  }
  ASSERT_TRUE(top.valid());
  OrientationWishes wishes = wishes_of({.height = 1});
  wishes.down = plane_normals(scene, {top}, "top", "--down");
  ASSERT_EQ(wishes.down.size(), 1U);
  EXPECT_NEAR((wishes.down.front() - Vec3::UnitZ()).norm(), 0.0, 1e-12);
  EXPECT_NEAR(Found(std::move(scene), wishes).best().figures.contact_area, 12.0, 1e-6);
}

TEST(Orientations, NamesThatAreNotThereAreRefused) {
  const Scene ball = scene_of(add_sphere, 2.0);
  EXPECT_THROW((void)find_named_faces(ball, "#4711", "--down"), InputError);
  EXPECT_THROW((void)find_named_faces(ball, "#", "--down"), InputError);
  EXPECT_THROW((void)find_named_faces(ball, "nobody", "--down"), InputError);
  EXPECT_THROW((void)find_named_faces(ball, "[", "--down"), InputError);
  EXPECT_THROW((void)plane_normals(ball, find_named_faces(ball, "solid", "--down"), "solid", "--down"), InputError);
}

TEST(Orientations, WhatFitsTheMachineGoesFirst) {
  // Least high is lying, but the room is a tall shaft.
  OrientationWishes wishes = wishes_of({.height = 1});
  wishes.room = Vec3(5.5, 4.5, 30.0);
  const Found found(scene_of(add_box, Vec3(0, 0, 0), Vec3(20, 5, 4)), wishes);
  EXPECT_TRUE(found.best().fits);
  EXPECT_NEAR(found.best().figures.height, 20.0, 1e-9);
  wishes.room = Vec3(3.0, 3.0, 3.0);
  const Found none(scene_of(add_box, Vec3(0, 0, 0), Vec3(20, 5, 4)), wishes);
  EXPECT_FALSE(none.best().fits);
}

TEST(HalfSphere, HasOneOfEveryPairAndLeavesNoGap) {
  for (const int level : {0, 1, 2, 3}) {
    const std::vector<Vec3> directions = half_sphere(level);
    EXPECT_EQ(directions.size(), 2U * (1U << (2 * level)) + 1U);
    for (std::size_t i = 0; i < directions.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) EXPECT_LT(std::abs(directions[i].dot(directions[j])), 1.0 - 1e-6);
    }
  }
}

TEST(TurnUpright, QuarterTurnsAreExact) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      const Mat3 turn = turn_upright(sign * Vec3::Unit(axis) + Vec3(1e-15, -1e-15, 1e-16));
      EXPECT_TRUE(is_rotation(turn));
      for (int i = 0; i < 9; ++i) EXPECT_TRUE(turn(i) == 0.0 || std::abs(turn(i)) == 1.0);
    }
  }
  EXPECT_EQ(turn_upright(Vec3::UnitZ()), Mat3::Identity());
}

}  // namespace
}  // namespace lamella::test
