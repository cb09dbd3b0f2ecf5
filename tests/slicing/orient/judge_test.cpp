#include "slicing/orient/judge.h"

#include <array>
#include <gtest/gtest.h>

#include "tests/support/solids.h"
#include "tests/support/transform_scene.h"

namespace lamella::test {
namespace {

/// A scene with all that a judge needs, each solid of a material of its own.
struct Judged {
  Scene scene;
  MaterialTable table;
  IdVector<SolidId, SolidMeasure> measures;
  std::vector<SolidId> solids;
  std::unique_ptr<SupportFunction> support;
  std::unique_ptr<OrientationJudge> judge;

  explicit Judged(Scene made, JudgeOptions options = {}, std::size_t samples = 20000) : scene(std::move(made)) {
    for (const SolidId id : scene.solids.ids()) {
      table.materials.push_back({"material " + std::to_string(id.value()), {}, {}});
      table.assignments.push_back({MaterialId{id.value()}, 0, ""});
      solids.push_back(id);
    }
    measures = measure_solids(scene);
    support = std::make_unique<SupportFunction>(scene, solids);
    judge = std::make_unique<OrientationJudge>(scene, solids, table, measures, *support,
                                               sample_surfaces(scene, solids, samples), options);
  }
};

TEST(OrientationJudge, ABoxStandsOnItsSideWithoutSupport) {
  const Judged box(scene_of(add_box, Vec3(0, 0, 0), Vec3(4, 6, 10)), {.layer_height = 0.3});
  const OrientationFigures figures = box.judge->judge(Vec3::UnitX());
  EXPECT_NEAR(figures.height, 4.0, 1e-12);
  EXPECT_EQ(figures.layers, 14);
  EXPECT_NEAR(figures.contact_area, 60.0, 1e-6);
  EXPECT_EQ(figures.support_area, 0.0);
  EXPECT_EQ(figures.support_volume, 0.0);
  EXPECT_NEAR(figures.cusp_error, 0.0, 1e-12);
}

TEST(OrientationJudge, ATiltedBoxHasCuspsOfItsSlopesAndTouchesThePlateNowhere) {
  const double angle = 30.0 / 180.0 * kPi;
  const Judged box(scene_of(add_box, Vec3(0, 0, 0), Vec3(4, 6, 10)), {.layer_height = 0.3});
  const OrientationFigures figures = box.judge->judge(Vec3(std::sin(angle), 0.0, std::cos(angle)));
  EXPECT_EQ(figures.contact_area, 0.0);
  // 2 x 24 mm^2 of |n.up| = cos, 2 x 60 of sin, 2 x 40 upright.
  const double mean = (48.0 * std::cos(angle) + 120.0 * std::sin(angle)) / 248.0;
  EXPECT_NEAR(figures.cusp_error, 0.3 * mean, 1e-6);
  EXPECT_NEAR(figures.largest_cusp, 0.3 * std::cos(angle), 1e-12);
  // The lower 4 x 6 is flatter than 45 degrees; its middle is 2 sin 30 degrees above the plate.
  EXPECT_NEAR(figures.support_area, 24.0, 1e-6);
  EXPECT_NEAR(figures.support_volume, 24.0 * std::cos(angle) * 2.0 * std::sin(angle), 0.5);
}

TEST(OrientationJudge, TheCriticalAngleDecidesWhatNeedsSupport) {
  const double angle = 30.0 / 180.0 * kPi;
  const Vec3 up(std::sin(angle), 0.0, std::cos(angle));
  for (const auto& [critical, area] : {std::pair{25.0, 0.0}, {35.0, 24.0}, {65.0, 84.0}}) {
    const Judged box(scene_of(add_box, Vec3(0, 0, 0), Vec3(4, 6, 10)), {.critical_angle = critical / 180.0 * kPi});
    EXPECT_NEAR(box.judge->judge(up).support_area, area, 1e-6) << critical;
  }
}

TEST(OrientationJudge, SupportUnderASphereIsTheKnownVolume) {
  const double r = 5.0;
  const Judged ball(scene_of(add_sphere, r), {}, 100'000);
  const OrientationFigures figures = ball.judge->judge(Vec3(0.6, 0.0, 0.8));
  // Undersides within 45 degrees of straight down: a cap of height r (1 - cos 45); below it, down to the plate, a
  // cylinder of radius r sin 45 less what of the ball is in it.
  const double s = r * std::sin(kPi / 4);
  const double h = r * (1.0 - std::cos(kPi / 4));
  const double cap = kPi * h * h * (3.0 * r - h) / 3.0;
  EXPECT_NEAR(figures.support_area, kTwoPi * r * h, 0.01 * kTwoPi * r * h);
  EXPECT_NEAR(figures.support_volume, kPi * s * s * h - cap, 0.02 * (kPi * s * s * h - cap));
  EXPECT_LT(ball.judge->support_error(Vec3(0.6, 0.0, 0.8)), 0.05 * figures.support_volume);
}

TEST(OrientationJudge, SupportUnderABridgeStandsOnWhatIsBelow) {
  // A table: a plate of 20 x 20 x 2 at z = 10 on a foot of 20 x 4 x 10; another box 3 high under one wing.
  Scene scene;
  add_box(scene, Vec3(0, 0, 10), Vec3(20, 20, 12), {{}, "top", {}, {}});
  add_box(scene, Vec3(0, 8, 0), Vec3(20, 12, 10), {{}, "foot", {}, {}});
  add_box(scene, Vec3(0, 0, 0), Vec3(20, 8, 3), {{}, "step", {}, {}});
  const Judged table(std::move(scene), {}, 60'000);
  const OrientationFigures figures = table.judge->judge(Vec3::UnitZ());
  // Where the foot touches there is neither an underside nor a top.
  EXPECT_NEAR(figures.support_area, 2 * 160.0, 3.0);
  EXPECT_NEAR(figures.support_volume, 160.0 * 7.0 + 160.0 * 10.0, 0.02 * 2720.0);
  EXPECT_NEAR(table.judge->samples().buried_area, 2 * 80.0 + 2 * 60.0, 3.0);
}

TEST(OrientationJudge, FacesThatAreToStayFreeAreFoundOnAndBelowSupport) {
  Scene scene;
  add_box(scene, Vec3(0, 0, 10), Vec3(20, 20, 12), {{}, "top", {}, {}});
  add_box(scene, Vec3(0, 8, 0), Vec3(20, 12, 10), {{}, "foot", {}, {}});
  std::vector<FaceId> all;
  for (const FaceId face : scene.faces.ids()) all.push_back(face);
  const Judged table(std::move(scene), {.free_faces = all});
  EXPECT_GT(table.judge->judge(Vec3::UnitZ()).touched_area, 300.0);
  EXPECT_EQ(table.judge->judge(-Vec3::UnitZ()).touched_area, 0.0);
}

TEST(OrientationJudge, ToolChangesFollowTheHeightsOfTheMaterials) {
  // Side by side both materials are in every layer; one upon the other there is one change.
  const Judged pair(touching_boxes(), {.layer_height = 0.1, .counts_tools = true});
  EXPECT_EQ(pair.judge->judge(Vec3::UnitZ()).tool_changes, 10);
  EXPECT_EQ(pair.judge->judge(Vec3::UnitX()).tool_changes, 1);
}

TEST(SurfaceSamples, AddUpToTheSurfaceAndLookOutwards) {
  const Scene torus = scene_of(add_torus, 6.0, 1.5);
  const std::array<SolidId, 1> solids{SolidId{0}};
  const SurfaceSamples samples = sample_surfaces(torus, solids, 5000);
  EXPECT_NEAR(samples.area, 4.0 * kPi * kPi * 6.0 * 1.5, 1e-3);
  double flux = 0.0;
  for (const SurfaceSample& sample : samples.samples) flux += sample.point.dot(sample.normal) * sample.area / 3.0;
  EXPECT_NEAR(flux, 2.0 * kPi * kPi * 6.0 * 1.5 * 1.5, 0.01 * flux);
  EXPECT_TRUE(samples.unsampled.empty());
}

}  // namespace
}  // namespace lamella::test
