#include "slicing/orient/axis_scan.h"

#include <array>
#include <gtest/gtest.h>
#include <limits>

#include "core/error.h"
#include "tests/support/solids.h"
#include "tests/support/transform_scene.h"

namespace lamella::test {
namespace {

SupportFunction support_of(const Scene& scene) {
  const std::array<SolidId, 1> solid{SolidId{0}};
  return SupportFunction(scene, solid);
}

TEST(AxisScan, TurnsABoxBackByTheAngleThatItWasTurnedBy) {
  const Scene box = placed(scene_of(add_box, Vec3(0, 0, 0), Vec3(7, 20, 5)), Placement::turned(Vec3::UnitY(), kPi / 6));
  const SupportFunction support = support_of(box);
  const AxisScanResult found = scan_axes(support, {{Vec3(0, 3, 0)}, 1.0});
  EXPECT_NEAR(found.height, 5.0, 1e-12);
  ASSERT_EQ(found.turns.size(), 1U);
  EXPECT_DOUBLE_EQ(found.turns[0].angle, 150.0);
  EXPECT_EQ(found.heights, 360U);
  EXPECT_NEAR(support.width(found.turn.row(2).transpose()), found.height, 1e-12);
}

TEST(AxisScan, IsNoBetterThanItsSteps) {
  const Scene box =
      placed(scene_of(add_box, Vec3(0, 0, 0), Vec3(7, 20, 5)), Placement::turned(Vec3::UnitY(), 10.5 / 180.0 * kPi));
  const AxisScanResult found = scan_axes(support_of(box), {{Vec3::UnitY()}, 1.0});
  const double half = 0.5 / 180.0 * kPi;
  EXPECT_NEAR(found.height, 5.0 * std::cos(half) + 7.0 * std::sin(half), 1e-12);
}

TEST(AxisScan, GoesOnWithTheNextAxisUntilNoneHelps) {
  const Placement tilt{Placement::turned(Vec3::UnitX(), 40.0 / 180.0 * kPi).linear *
                           Placement::turned(Vec3::UnitY(), 25.0 / 180.0 * kPi).linear,
                       Vec3::Zero()};
  const Scene box = placed(scene_of(add_box, Vec3(0, 0, 0), Vec3(30, 20, 5)), tilt);
  const AxisScanResult found = scan_axes(support_of(box), {{Vec3::UnitX(), Vec3::UnitY()}, 1.0});
  EXPECT_GE(found.turns.size(), 2U);
  EXPECT_LT(found.height, 6.0);
}

TEST(AxisScan, RefusesWhatIsNoAxisAndNoStep) {
  const Scene box = scene_of(add_box, Vec3(0, 0, 0), Vec3(1, 2, 3));
  const SupportFunction support = support_of(box);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)scan_axes(support, {{}, 1.0}), UsageError);
  EXPECT_THROW((void)scan_axes(support, {{Vec3::Zero()}, 1.0}), UsageError);
  EXPECT_THROW((void)scan_axes(support, {{Vec3(nan, 0, 1)}, 1.0}), UsageError);
  for (const double step : {0.0, -1.0, 1e-9, 181.0, nan})
    EXPECT_THROW((void)scan_axes(support, {{Vec3::UnitX()}, step}), UsageError) << step;
}

}  // namespace
}  // namespace lamella::test
