#include "slicing/layer_plan.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "core/error.h"

namespace lamella {
namespace {

constexpr double kDegree = kPi / 180.0;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Box3 box(const Vec3& lo, const Vec3& hi) { return {lo, hi}; }
Box3 cube(double size) { return box(Vec3::Zero(), Vec3::Constant(size)); }

PlanOptions pitches(double px, double py, double pz) {
  PlanOptions options;
  options.pitch = Vec2(px, py);
  options.layer_height = pz;
  return options;
}

TEST(LayerPlan, CountsVoxelsByTheCeilingRule) {
  const LayerPlan plan = plan_layers(box(Vec3(-1, 2, 3), Vec3(9, 4.01, 3.5)), pitches(0.5, 1.0, 0.25));
  EXPECT_EQ(plan.grid.origin, Vec3(-1, 2, 3));
  EXPECT_EQ(plan.grid.size, (std::array<std::int64_t, 3>{20, 3, 2}));
  EXPECT_EQ(plan.layers.size(), 2u);
}

TEST(LayerPlan, ForgivesAMillionthOfAVoxelAndNoMore) {
  EXPECT_EQ(plan_layers(cube(10.0 + 0.9e-6), pitches(1, 1, 1)).grid.size[0], 10);
  EXPECT_EQ(plan_layers(cube(10.0 + 1.1e-6), pitches(1, 1, 1)).grid.size[0], 11);
}

TEST(LayerPlan, GivesAFlatBoxOneVoxel) {
  EXPECT_EQ(plan_layers(box(Vec3::Zero(), Vec3(10, 0, 10)), pitches(1, 1, 1)).grid.size[1], 1);
}

TEST(LayerPlan, SamplesRowsAndLayersAtVoxelCentres) {
  PlanOptions options = pitches(0.5, 0.25, 0.1);
  options.origin = Vec3(-1, -1, -1);
  const LayerPlan plan = plan_layers(cube(2), options);
  EXPECT_DOUBLE_EQ(plan.row_y(3), -1 + 3.5 * 0.25);
  EXPECT_DOUBLE_EQ(plan.layers[7].z_sample, -1 + 7.5 * 0.1);
}

TEST(LayerPlan, MakesLayersThatMeetBitForBit) {
  const LayerPlan plan = plan_layers(box(Vec3::Constant(-0.3), Vec3::Constant(17.1)), pitches(1, 1, 0.1));
  for (std::size_t k = 0; k + 1 < plan.layers.size(); ++k) {
    ASSERT_EQ(plan.layers[k].z_top, plan.layers[k + 1].z_bottom) << "layer " << k;
    ASSERT_LT(plan.layers[k].z_bottom, plan.layers[k].z_sample);
    ASSERT_LT(plan.layers[k].z_sample, plan.layers[k].z_top);
  }
}

TEST(LayerPlan, RoundsDefaultsToOneTwoFive) {
  const LayerPlan plan = plan_layers(box(Vec3::Zero(), Vec3(190, 80, 150)));
  EXPECT_DOUBLE_EQ(plan.grid.pitch.x(), 0.2);
  EXPECT_DOUBLE_EQ(plan.grid.pitch.y(), 0.2);
  EXPECT_DOUBLE_EQ(plan.grid.pitch.z(), 0.5);
  EXPECT_DOUBLE_EQ(plan_layers(cube(10)).grid.pitch.x(), 0.01);
  EXPECT_DOUBLE_EQ(plan_layers(cube(10)).grid.pitch.z(), 0.02);
}

class DefaultPitch : public testing::TestWithParam<double> {};

TEST_P(DefaultPitch, GivesAboutAThousandRowsAndFiveHundredLayers) {
  const LayerPlan plan = plan_layers(cube(GetParam()));
  // 1-2-5 rounding moves a pitch by at most the square root of 2.5.
  EXPECT_NEAR(std::log(static_cast<double>(plan.grid.size[1]) / 1000.0), 0.0, std::log(1.6));
  EXPECT_NEAR(std::log(static_cast<double>(plan.grid.size[2]) / 500.0), 0.0, std::log(1.6));
}

INSTANTIATE_TEST_SUITE_P(Sizes, DefaultPitch, testing::Values(1e-3, 0.7, 1.0, 1.5, 3.3, 8.0, 9.99, 1e4));

TEST(LayerPlan, RefusesPitchesThatAreNotPositiveAndFinite) {
  for (const double bad : {0.0, -1.0, kNan, kInfinity, -kInfinity}) {
    EXPECT_THROW((void)plan_layers(cube(1), pitches(bad, 1, 1)), UsageError) << bad;
    EXPECT_THROW((void)plan_layers(cube(1), pitches(1, bad, 1)), UsageError) << bad;
    EXPECT_THROW((void)plan_layers(cube(1), pitches(1, 1, bad)), UsageError) << bad;
  }
}

TEST(LayerPlan, RefusesMoreVoxelsThanItCanNumber) {
  for (const double tiny : {1e-12, 1e-300, std::numeric_limits<double>::denorm_min()}) {
    EXPECT_THROW((void)plan_layers(cube(1), pitches(tiny, 1, 1)), UsageError) << tiny;
    EXPECT_THROW((void)plan_layers(cube(1), pitches(1, tiny, 1)), UsageError) << tiny;
    EXPECT_THROW((void)plan_layers(cube(1), pitches(1, 1, tiny)), UsageError) << tiny;
  }
}

TEST(LayerPlan, RefusesAPitchThatIsLostInRounding) {
  const Box3 far = box(Vec3::Constant(1e12), Vec3::Constant(1e12 + 1e-2));
  EXPECT_THROW((void)plan_layers(far, pitches(1e-3, 1e-3, 1e-3)), UsageError);
  EXPECT_THROW((void)plan_layers(cube(1), pitches(1, 1, 1.7e308)), UsageError);
}

TEST(LayerPlan, RefusesAnOriginAboveALowerBound) {
  PlanOptions options = pitches(1, 1, 1);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double bad : {1e-12, kNan, -kInfinity}) {
      Vec3 origin = Vec3::Zero();
      origin[axis] = bad;
      options.origin = origin;
      EXPECT_THROW((void)plan_layers(cube(1), options), UsageError) << axis << " " << bad;
    }
  }
}

TEST(LayerPlan, RefusesBoundsThatAreEmptyOrNotFinite) {
  EXPECT_THROW((void)plan_layers(Box3(), pitches(1, 1, 1)), InputError);
  EXPECT_THROW((void)plan_layers(box(Vec3::Zero(), Vec3(1, kNan, 1)), pitches(1, 1, 1)), InputError);
  EXPECT_THROW((void)plan_layers(box(Vec3::Constant(-1e308), Vec3::Constant(1e308)), pitches(1, 1, 1)), UsageError);
  EXPECT_THROW((void)plan_layers(box(Vec3::Ones(), Vec3::Ones())), UsageError) << "a point has no default pitch";
}

TEST(LayerPlan, RefusesAHatchThatIsNotFinite) {
  PlanOptions options = pitches(1, 1, 1);
  for (const HatchLattice& bad : {HatchLattice{0, 0, 0}, HatchLattice{kNan, 0, 0}, HatchLattice{1, kInfinity, 0},
                                  HatchLattice{1, 0, kNan}, HatchLattice{1e-12, 0, 0}, HatchLattice{-1, 0, 0}}) {
    options.hatch = bad;
    EXPECT_THROW((void)plan_layers(cube(1), options), UsageError);
  }
}

TEST(HatchAxes, AreExactAtQuarterTurnsOfEveryLayer) {
  const Vec2 expected[] = {Vec2(1, 0), Vec2(0, 1), Vec2(-1, 0), Vec2(0, -1)};
  for (const double step : {90.0, 45.0, 30.0, 67.0, -90.0, 1.0}) {
    for (std::size_t k = 0; k < 4000; ++k) {
      const double degrees = step * static_cast<double>(k) - 180.0;
      if (std::fmod(degrees, 90.0) != 0.0) continue;
      const HatchAxes axes = hatch_axes({1.0, -180.0 * kDegree, step * kDegree}, k);
      const long quadrant = ((std::lround(degrees / 90.0) % 4) + 4) % 4;
      ASSERT_EQ(axes.along, expected[quadrant]) << degrees;
      ASSERT_EQ(axes.across, expected[(quadrant + 1) % 4]) << degrees;
    }
  }
}

TEST(HatchAxes, AreOrthonormalAndFollowTheAngleElsewhere) {
  for (std::size_t k = 0; k < 100; ++k) {
    const HatchAxes axes = hatch_axes({0.4, 10 * kDegree, 67 * kDegree}, k);
    const double angle = (10.0 + 67.0 * static_cast<double>(k)) * kDegree;
    EXPECT_NEAR(axes.along.x(), std::cos(angle), 1e-12);
    EXPECT_NEAR(axes.along.y(), std::sin(angle), 1e-12);
    EXPECT_EQ(axes.across, Vec2(-axes.along.y(), axes.along.x()));
  }
}

TEST(HatchAxes, DoNotSnapAnAngleThatIsOnlyNearAQuarterTurn) {
  EXPECT_NE(hatch_axes({1.0, (90 + 1e-10) * kDegree, 0}, 0).along.x(), 0.0);
}

}  // namespace
}  // namespace lamella
