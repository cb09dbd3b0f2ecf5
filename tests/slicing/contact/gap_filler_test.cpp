#include "slicing/contact/gap_filler.h"

#include <cmath>
#include <gtest/gtest.h>

#include "tests/slicing/contact/touching_solids.h"
#include "tests/support/closed_forms.h"

namespace lamella {
namespace {

using test::Placement;

constexpr double kTolerance = 1e-3;
constexpr double kPitch = 0.05;

/// Two blocks [0,2] x [0,1] x [0,1] and [0,2] x [1 + gap, 2] x [0,1], placed.
Scene blocks(double gap, const Placement& placement) {
  Scene scene;
  test::SolidOptions options;
  options.placement = placement;
  options.name = "low";
  test::add_box(scene, {0, 0, 0}, {2, 1, 1}, options);
  options.name = "high";
  test::add_box(scene, {0, 1 + gap, 0}, {2, 2, 1}, options);
  return scene;
}

PlanOptions lattice(const Vec3& origin) {
  PlanOptions plan;
  plan.layer_height = kPitch;
  plan.pitch = Vec2(kPitch, kPitch);
  plan.origin = origin;
  return plan;
}

SliceOptions touching_within(double tolerance) {
  SliceOptions options;
  options.gap_tolerance = tolerance;
  return options;
}

double covered(std::span<const Segment> row) {
  double length = 0.0;
  for (const Segment& segment : row) length += segment.x_end - segment.x_begin;
  return length;
}

/// Of one row of a layer: the line in the frame of the unplaced solids.
Ray local_ray(const Placement& placement, double y, double z) {
  const Mat3 back = placement.linear.transpose();
  return {back * (Vec3(0, y, z) - placement.translation), back * Vec3::UnitX()};
}

double length_of(const std::vector<Interval>& spans) {
  double length = 0.0;
  for (const Interval& span : spans) length += span.length();
  return length;
}

struct Pose {
  const char* name;
  Placement placement;
  double mouth;  ///< tolerances: how long a row may run into the gap's mouth and find it open
};

class AnyPose : public ::testing::TestWithParam<Pose> {};

/// With their gap filled the two are one block: each row has the length that the block's equations give, in one piece.
TEST_P(AnyPose, TwoBlocksWithANarrowGapAreOne) {
  const Placement& placement = GetParam().placement;
  const double gap = 0.6 * kTolerance;
  const Scene scene = blocks(gap, placement);
  // The lattice runs through the middle of the gap where the gap lies along it: y and z = 1 + gap / 2.
  const Vec3 origin = Vec3::Constant(1.0 + 0.5 * gap - 0.5 * kPitch - 100 * kPitch);
  const auto sliced =
      test::slice_scene(scene, test::one_material_each(scene), lattice(origin), touching_within(kTolerance));
  std::size_t rows_met = 0;
  std::size_t rows_with_both = 0;
  for (const Layer& layer : sliced.layers) {
    for (std::size_t r = 0; r < layer.raster.rows(); ++r) {
      const auto row = layer.raster.row(r);
      const double y = origin.y() + (static_cast<double>(r) + 0.5) * kPitch;
      const Ray ray = local_ray(placement, y, layer.z_sample);
      const double expected = length_of(test::box_spans(ray, {0, 0, 0}, {2, 2, 1}));
      EXPECT_NEAR(covered(row), expected, GetParam().mouth * kTolerance) << "row " << r << " of " << layer.index;
      for (std::size_t i = 1; i < row.size(); ++i) EXPECT_EQ(row[i].x_begin, row[i - 1].x_end);
      EXPECT_LE(row.size(), 2U) << "row " << r << " of " << layer.index;
      rows_met += row.empty() ? 0 : 1;
      rows_with_both += row.size() == 2 ? 1 : 0;
    }
  }
  EXPECT_GT(rows_met, 300U);
  EXPECT_EQ(sliced.report.interfaces.size(), 1U);
  EXPECT_NEAR(sliced.report.interfaces[0].area, 2.0, 1e-9);
  EXPECT_NEAR(sliced.report.interfaces[0].largest_gap, gap, 1e-12);
  EXPECT_TRUE(sliced.report.open_gaps.empty());
  EXPECT_TRUE(sliced.report.within_budget());
}

INSTANTIATE_TEST_SUITE_P(
    Poses, AnyPose,
    ::testing::Values(Pose{"AlongX", {}, 0.01}, Pose{"AcrossX", Placement::turned(Vec3::UnitZ(), kPi / 2), 0.01},
                      Pose{"Horizontal", Placement::turned(Vec3::UnitX(), kPi / 2), 0.01},
                      Pose{"ThirtyDegreesAboutZ", Placement::turned(Vec3::UnitZ(), kPi / 6), 8.0},
                      Pose{"ThirtyDegreesAboutX", Placement::turned(Vec3::UnitX(), kPi / 6), 8.0},
                      Pose{"ThirtyDegreesAboutY", Placement::turned(Vec3::UnitY(), kPi / 6), 8.0},
                      Pose{"NearlyAlongX", Placement::turned(Vec3::UnitZ(), 0.01), 8.0},
                      Pose{"NearlyHorizontal", Placement::turned(Vec3(1, 0, 0.01).normalized(), kPi / 2 + 0.01), 8.0},
                      Pose{"Askew", Placement::turned(Vec3(1, 2, 3).normalized(), 1.0), 8.0}),
    [](const auto& pose) { return pose.param.name; });

/// Whether the reader says that both are instances of one body, and how far the tolerance goes.
struct CopiesCase {
  bool are_instances;
  double tolerance;
};

class TwoCopies : public ::testing::TestWithParam<CopiesCase> {
 protected:
  /// The block [0,2] x [0,1] x [0,1] and its copy beyond a gap of so many tolerances.
  [[nodiscard]] Scene copies(double gap) const {
    Scene scene;
    for (const double y : {0.0, 1.0 + gap}) {
      const std::size_t first = scene.faces.size();
      test::SolidOptions options;
      options.placement = Placement::at({0, y, 0});
      options.name = y == 0.0 ? "low" : "high";
      const SolidId id = test::add_box(scene, {0, 0, 0}, {2, 1, 1}, options).id;
      if (!GetParam().are_instances) continue;
      scene.solids[id].info.instance = Instance{0, Mat3::Identity(), Vec3(0, y, 0)};
      for (std::size_t f = first; f < scene.faces.size(); ++f) {
        scene.faces[FaceId{f}].step_entity = static_cast<int>(1 + f - first);
      }
    }
    return scene;
  }
  /// Row 100 runs in the middle of the gap.
  [[nodiscard]] test::SlicedScene sliced(double gap) const {
    const Scene scene = copies(gap);
    const Vec3 origin = Vec3::Constant(1.0 + 0.5 * gap - 0.5 * kPitch - 100 * kPitch);
    return test::slice_scene(scene, test::one_material_each(scene), lattice(origin),
                             touching_within(GetParam().tolerance));
  }
};

TEST_P(TwoCopies, WithANarrowGapShareASurface) {
  const double gap = 0.6 * GetParam().tolerance;
  const auto found = sliced(gap);
  std::size_t met = 0;
  for (const Layer& layer : found.layers) {
    for (std::size_t r = 81; r < 120; ++r) {
      const auto row = layer.raster.row(r);
      if (row.empty()) continue;
      EXPECT_NEAR(covered(row), 2.0, 1e-5) << "row " << r << " of " << layer.index;
      EXPECT_EQ(row.size(), 1U);
      ++met;
    }
    // No hole.
    if (!layer.raster.row(90).empty()) {
      EXPECT_FALSE(layer.raster.row(100).empty()) << layer.index;
    }
  }
  EXPECT_GT(met, 700U);
  ASSERT_EQ(found.report.interfaces.size(), 1U);
  EXPECT_NEAR(found.report.interfaces[0].area, 2.0, 1e-9);
  EXPECT_NEAR(found.report.interfaces[0].largest_gap, gap, 1e-12);
  EXPECT_TRUE(found.report.open_gaps.empty());
}

TEST_P(TwoCopies, WithAWiderGapLeaveItOpen) {
  const double gap = 3.0 * GetParam().tolerance;
  const auto found = sliced(gap);
  for (const Layer& layer : found.layers) EXPECT_TRUE(layer.raster.row(100).empty()) << layer.index;
  EXPECT_TRUE(found.report.interfaces.empty());
  ASSERT_EQ(found.report.open_gaps.size(), 1U);
  EXPECT_NEAR(found.report.open_gaps[0].area, 2.0, 1e-9);
  EXPECT_NEAR(found.report.open_gaps[0].volume, 2.0 * gap, 1e-9);
  EXPECT_NEAR(found.report.open_gaps[0].least_gap, gap, 1e-12);
  EXPECT_NEAR(found.report.open_gaps[0].largest_gap, gap, 1e-12);
}

// With the wide tolerance the copies are clusters of their own, which are cut once.
INSTANTIATE_TEST_SUITE_P(Copies, TwoCopies,
                         ::testing::Values(CopiesCase{false, kTolerance}, CopiesCase{true, kTolerance},
                                           CopiesCase{true, 1e-2}));

TEST(GapFiller, AWiderGapStaysAndIsReported) {
  const double gap = 3.0 * kTolerance;
  const Scene scene = blocks(gap, {});
  const Vec3 origin = Vec3::Constant(1.0 + 0.5 * gap - 0.5 * kPitch - 100 * kPitch);
  const auto sliced =
      test::slice_scene(scene, test::one_material_each(scene), lattice(origin), touching_within(kTolerance));
  for (const Layer& layer : sliced.layers) {
    EXPECT_TRUE(layer.raster.row(100).empty()) << layer.index;
  }
  EXPECT_TRUE(sliced.report.interfaces.empty());
  EXPECT_TRUE(sliced.report.gaps.empty());
  ASSERT_EQ(sliced.report.open_gaps.size(), 1U);
  const ContactReport& open = sliced.report.open_gaps[0];
  EXPECT_NEAR(open.area, 2.0, 1e-9);
  EXPECT_NEAR(open.volume, 2.0 * gap, 1e-9);
  EXPECT_NEAR(open.least_gap, gap, 1e-12);
  EXPECT_NEAR(open.largest_gap, gap, 1e-12);
  EXPECT_GE(open.layers, 20U);
}

TEST(GapFiller, WithoutAToleranceTheFacesOwnCount) {
  Scene scene = blocks(0.5 * kTolerance, {});
  const Vec3 origin = Vec3::Constant(1.0 + 0.25 * kTolerance - 0.5 * kPitch - 100 * kPitch);
  const auto open = test::slice_scene(scene, test::one_material_each(scene), lattice(origin), {});
  EXPECT_TRUE(open.layers[90].raster.row(100).empty());
  // One of the two faces is enough.
  for (const FaceId face : faces_of(scene, SolidId{1})) scene.faces[face].tolerance = kTolerance;
  const auto closed = test::slice_scene(scene, test::one_material_each(scene), lattice(origin), {});
  EXPECT_NEAR(covered(closed.layers[90].raster.row(100)), 2.0, 1e-5);
}

TEST(GapFiller, TheGapGoesToTheHigherPriority) {
  const double gap = 0.5 * kTolerance;
  const Scene scene = blocks(gap, {});
  const Vec3 origin = Vec3::Constant(1.0 + 0.5 * gap - 0.5 * kPitch - 100 * kPitch);
  for (const std::uint32_t winner : {0U, 1U}) {
    const auto table = test::one_material_each(scene, {winner == 0 ? 1 : 0, winner == 1 ? 1 : 0});
    const auto sliced = test::slice_scene(scene, table, lattice(origin), touching_within(kTolerance));
    const auto row = sliced.layers[90].raster.row(100);
    ASSERT_EQ(row.size(), 1U);
    EXPECT_EQ(row[0].solid, SolidId{winner});
    EXPECT_EQ(row[0].material, MaterialId{winner});
  }
}

/// A ball in a hollow that is wider by a gap: every row through it is one piece, also those that graze the gap.
TEST(GapFiller, ABallInItsHollowLeavesNoHole) {
  const double gap = 0.8 * kTolerance;
  Scene scene;
  test::add_box_with_void(scene, {-2, -2, -2}, {2, 2, 2}, 1.0 + gap);
  test::SolidOptions ball;
  ball.name = "ball";
  test::add_sphere(scene, 1.0, ball);
  // Rows and layers whose middles lie in the gap at the poles: y and z = 1 + gap / 2.
  const Vec3 origin = Vec3::Constant(1.0 + 0.5 * gap - 0.5 * kPitch - 62 * kPitch);
  PlanOptions plan = lattice(origin);
  plan.hatch = HatchLattice{2.0 * (1.0 + 0.5 * gap), 0.6, 0.0};
  const auto sliced = test::slice_scene(scene, test::one_material_each(scene), plan, touching_within(kTolerance));
  for (const Layer& layer : sliced.layers) {
    for (std::size_t r = 0; r < layer.raster.rows(); ++r) {
      const double y = origin.y() + (static_cast<double>(r) + 0.5) * kPitch;
      const bool is_in_box = std::abs(y) < 2.0 && std::abs(layer.z_sample) < 2.0;
      EXPECT_NEAR(covered(layer.raster.row(r)), is_in_box ? 4.0 : 0.0, 1e-5) << "row " << r << " of " << layer.index;
    }
    // The hatch rows +-1/2 lie in the gap where the layer goes through the middle.
    ASSERT_TRUE(layer.hatch);
    for (std::size_t r = 0; r < layer.hatch->rows.rows(); ++r) {
      const auto row = layer.hatch->rows.row(r);
      for (std::size_t i = 1; i < row.size(); ++i) EXPECT_EQ(row[i].x_begin, row[i - 1].x_end);
    }
  }
  ASSERT_EQ(sliced.report.interfaces.size(), 1U);
  EXPECT_NEAR(sliced.report.interfaces[0].area, 4.0 * kPi, 4.0 * kPi * 1e-3);
}

TEST(GapFiller, IdsDecideAboutNothing) {
  const Placement placement = Placement::turned(Vec3::UnitZ(), 0.01);
  const double gap = 0.6 * kTolerance;
  const Vec3 origin = Vec3::Constant(-1.0);
  const Scene scene = blocks(gap, placement);
  Scene swapped;
  test::SolidOptions options;
  options.placement = placement;
  options.name = "high";
  test::add_box(swapped, {0, 1 + gap, 0}, {2, 2, 1}, options);
  options.name = "low";
  test::add_box(swapped, {0, 0, 0}, {2, 1, 1}, options);
  const auto a = test::slice_scene(scene, test::one_material_each(scene), lattice(origin), touching_within(kTolerance));
  const auto b =
      test::slice_scene(swapped, test::one_material_each(swapped), lattice(origin), touching_within(kTolerance));
  ASSERT_EQ(a.layers.size(), b.layers.size());
  for (std::size_t k = 0; k < a.layers.size(); ++k) {
    ASSERT_EQ(a.layers[k].raster.row_start, b.layers[k].raster.row_start);
    for (std::size_t i = 0; i < a.layers[k].raster.segments.size(); ++i) {
      Segment other = b.layers[k].raster.segments[i];
      other.solid = SolidId{1 - other.solid.value()};
      other.material = MaterialId{1 - other.material.value()};
      EXPECT_EQ(a.layers[k].raster.segments[i], other);
    }
  }
}

/// Coincident faces have no gap to fill, and nothing is added at their edges.
TEST(GapFiller, AddsNothingWhereFacesCoincide) {
  for (const double angle : {0.0, kPi / 6}) {
    const Scene scene = blocks(0.0, Placement::turned(Vec3::UnitZ(), angle));
    const auto sliced = test::slice_scene(scene, test::one_material_each(scene), lattice(Vec3::Constant(-3.0)), {});
    double gaps = 0.0;
    for (const PairReport& gap : sliced.report.gaps) gaps += gap.volume;
    EXPECT_LT(gaps, 1e-9);
    for (const Layer& layer : sliced.layers) {
      for (const Segment& segment : layer.raster.segments) EXPECT_GT(segment.x_end - segment.x_begin, 1e-6);
    }
  }
}

}  // namespace
}  // namespace lamella
