/// Contours of materials against closed forms, and that neither ids nor the order of solids matter.

#include "export/material_contours.h"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>

#include "core/error.h"
#include "slicing/store/store.h"
#include "tests/support/command.h"
#include "tests/support/layers.h"

namespace lamella::test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

using Polygon = std::vector<Vec2>;

Polygon box(double x0, double y0, double x1, double y1) { return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}; }

Polygon reversed(Polygon polygon) {
  std::reverse(polygon.begin(), polygon.end());
  return polygon;
}

/// The shoelace formula.
double area_of(const Polygon& polygon) {
  double sum = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2& a = polygon[i];
    const Vec2& b = polygon[(i + 1) % polygon.size()];
    sum += a.x() * b.y() - b.x() * a.y();
  }
  return 0.5 * sum;
}

double area_of(const std::vector<MaterialLoop>& loops) {
  double sum = 0.0;
  for (const MaterialLoop& loop : loops) {
    EXPECT_NEAR(loop.area, area_of(loop.points), 1e-9);
    sum += loop.area;
  }
  return sum;
}

/// A build of three solids, each of its own material, with the given priorities.
BuildInfo build_of(const std::vector<int>& priorities) {
  Grid grid;
  grid.size = {10, 10, 1};
  BuildInfo info = make_build(grid, {"a", "b", "c"});
  for (std::size_t i = 0; i < priorities.size(); ++i) info.solids[SolidId{i}].priority = priorities[i];
  info.plan.chord_error = 0.01;
  return info;
}

LayerContours contours_of(const std::vector<std::pair<std::size_t, Polygon>>& loops) {
  LayerContours contours;
  for (const auto& [solid, polygon] : loops) contours.add({SolidId{solid}, -1, area_of(polygon)}, polygon);
  return contours;
}

TEST(MaterialContours, GiveWhatOverlapsToTheHigherPriority) {
  const LayerContours contours = contours_of({{0, box(0, 0, 4, 4)}, {1, box(2, 1, 6, 3)}});
  const MaterialContours first = ContourCombiner(build_of({2, 1, 0}), "test").combine(contours);
  EXPECT_NEAR(area_of(first[MaterialId{0}]), 16, 1e-9);
  EXPECT_NEAR(area_of(first[MaterialId{1}]), 4, 1e-9);
  EXPECT_THAT(first[MaterialId{2}], IsEmpty());
  const MaterialContours second = ContourCombiner(build_of({1, 2, 0}), "test").combine(contours);
  EXPECT_NEAR(area_of(second[MaterialId{0}]), 12, 1e-9);
  EXPECT_NEAR(area_of(second[MaterialId{1}]), 8, 1e-9);
}

TEST(MaterialContours, LetTheSmallerSolidCutTheLargerAtEqualPriority) {
  BuildInfo info = build_of({0, 0, 0});
  info.solids[SolidId{0}].volume_exact = 5.0;
  info.solids[SolidId{1}].volume_exact = 50.0;
  const LayerContours contours = contours_of({{0, box(1, 1, 3, 3)}, {1, box(0, 0, 8, 8)}});
  const MaterialContours regions = ContourCombiner(info, "test").combine(contours);
  EXPECT_NEAR(area_of(regions[MaterialId{0}]), 4, 1e-9);
  ASSERT_THAT(regions[MaterialId{1}], SizeIs(2));
  EXPECT_EQ(regions[MaterialId{1}][0].parent, -1);
  EXPECT_EQ(regions[MaterialId{1}][1].parent, 0);
  EXPECT_NEAR(regions[MaterialId{1}][1].area, -4, 1e-9);
}

TEST(MaterialContours, UniteSolidsOfOneMaterialAcrossOneThatLiesBetweenInRank) {
  BuildInfo info = build_of({2, 1, 0});
  info.solids[SolidId{2}].material = MaterialId{0};
  const LayerContours contours = contours_of({{0, box(0, 0, 4, 2)}, {1, box(3, 0, 5, 2)}, {2, box(3.5, 0, 9, 2)}});
  const MaterialContours regions = ContourCombiner(info, "test").combine(contours);
  EXPECT_NEAR(area_of(regions[MaterialId{0}]), 8 + 8, 1e-9);
  EXPECT_NEAR(area_of(regions[MaterialId{1}]), 2, 1e-9);
}

TEST(MaterialContours, KeepIslandsInHoles) {
  const LayerContours contours =
      contours_of({{0, box(0, 0, 9, 9)}, {0, reversed(box(1, 1, 8, 8))}, {0, box(2, 2, 7, 7)}, {1, box(3, 3, 4, 4)}});
  const MaterialContours regions = ContourCombiner(build_of({0, 1, 0}), "test").combine(contours);
  ASSERT_THAT(regions[MaterialId{0}], SizeIs(4));
  EXPECT_NEAR(area_of(regions[MaterialId{0}]), 81 - 49 + 25 - 1, 1e-9);
  EXPECT_EQ(regions[MaterialId{0}][1].parent, 0);
  EXPECT_EQ(regions[MaterialId{0}][3].parent, 2);
}

TEST(MaterialContours, DropWhatOnlyRoundingLeaves) {
  const LayerContours contours = contours_of({{0, box(0, 0, 4, 4)}, {1, box(0, 0, 4, 4 + 1e-6)}});
  const MaterialContours regions = ContourCombiner(build_of({1, 0, 0}), "test").combine(contours);
  EXPECT_THAT(regions[MaterialId{1}], IsEmpty());
}

TEST(MaterialContours, DependOnIdsByNothingButIds) {
  const std::vector<Polygon> polygons{box(0, 0, 4, 4), box(2, 1, 6, 3), box(3.5, 2, 5, 9)};
  BuildInfo info = build_of({1, 2, 2});
  const MaterialContours straight =
      ContourCombiner(info, "test").combine(contours_of({{0, polygons[0]}, {1, polygons[1]}, {2, polygons[2]}}));
  std::swap(info.solids[SolidId{0}], info.solids[SolidId{2}]);
  const MaterialContours swapped =
      ContourCombiner(info, "test").combine(contours_of({{0, polygons[2]}, {1, polygons[1]}, {2, polygons[0]}}));
  for (const MaterialId material : straight.ids()) {
    ASSERT_EQ(straight[material].size(), swapped[material].size());
    for (std::size_t i = 0; i < straight[material].size(); ++i)
      EXPECT_EQ(straight[material][i].points, swapped[material][i].points);
  }
}

TEST(MaterialContours, SayWhatABuildLacks) {
  BuildInfo info = build_of({0, 0, 0});
  info.plan.chord_error.reset();
  try {
    const ContourCombiner combiner(info, "svg");
    FAIL() << "no error";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("svg"));
    EXPECT_THAT(error.hint(), HasSubstr("--contours"));
  }
}

TEST(MaterialContours, PutInterfacesWhereThePolicySays) {
  // A square and one that is turned by 45 degrees and dips into it from the right: on the line at y, the overlap begins
  // at 3 + |y| and ends at 4.
  const LayerContours contours = contours_of({{0, box(0, -2, 4, 2)}, {1, {{3, 0}, {6, -3}, {9, 0}, {6, 3}}}});
  BuildInfo info = build_of({1, 1, 0});
  const std::map<OverlapPolicy, double> lost{
      {OverlapPolicy::entry, 1.0}, {OverlapPolicy::exit, 0.0}, {OverlapPolicy::average, 0.5}};
  for (const auto& [policy, share] : lost) {
    info.policy = policy;
    const MaterialContours regions = ContourCombiner(info, "test").combine(contours);
    EXPECT_NEAR(area_of(regions[MaterialId{0}]), 16 - share, 1e-5);
    EXPECT_NEAR(area_of(regions[MaterialId{1}]), 18 - (1 - share), 1e-5);
  }
}

TEST(MaterialContours, LeaveContainedSolidsAndOtherPrioritiesOutOfThePolicy) {
  BuildInfo info = build_of({1, 1, 2});
  info.policy = OverlapPolicy::average;
  info.solids[SolidId{1}].volume_exact = 1e-3;
  // The second lies within the first, the third of higher priority across both.
  const LayerContours contours = contours_of({{0, box(0, 0, 9, 9)}, {1, box(2, 2, 4, 4)}, {2, box(3, 1, 4, 8)}});
  const MaterialContours regions = ContourCombiner(info, "test").combine(contours);
  EXPECT_NEAR(area_of(regions[MaterialId{2}]), 7, 1e-5);
  EXPECT_NEAR(area_of(regions[MaterialId{1}]), 2, 1e-5);
  EXPECT_NEAR(area_of(regions[MaterialId{0}]), 81 - 9, 1e-5);
}

/// Area of the disc in which a plane at height z cuts a ball about the origin's plane.
double disc(double radius, double z) { return std::abs(z) < radius ? kPi * (radius * radius - z * z) : 0.0; }

/// Slices a data set coarsely, with contours, and calls visit(info, layer) on each layer.
template <class Visit>
void visit_layers(const std::string& name, const std::string& options, const Visit& visit) {
  const TemporaryFolder folder;
  const std::filesystem::path set = datasets_dir() / name;
  const CommandResult run =
      run_lamella("slice " + quoted(set / (name + ".step")) + " --materials " + quoted(set / "materials.xml") + " -o " +
                  quoted(folder / "build") + " --quiet " + options);
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const StoreReader reader(folder / "build");
  ASSERT_GT(reader.info().plan.layers.size(), 5u);
  for (std::uint32_t k = 0; k < reader.info().plan.layers.size(); ++k) visit(reader.info(), reader.read_layer(k));
}

double length_of(const LayerContours& contours) {
  double length = 0.0;
  for (std::size_t i = 0; i < contours.loops.size(); ++i) {
    const auto points = contours.polygon(i);
    for (std::size_t p = 0; p < points.size(); ++p) length += (points[(p + 1) % points.size()] - points[p]).norm();
  }
  return length;
}

TEST(MaterialContours, OfNestedSpheresHaveTheAreasOfTheirRings) {
  visit_layers("nested_spheres", "--layer-height 0.9 --pitch 1 --contours 0.0001",
               [](const BuildInfo& info, const Layer& layer) {
                 const MaterialContours regions = ContourCombiner(info, "test").combine(*layer.contours);
                 const double z = layer.z_sample;
                 const std::vector<double> exact{disc(4, z), disc(7, z) - disc(4, z), disc(10, z) - disc(8, z),
                                                 disc(14, z) - disc(10, z) - disc(1.25, z)};
                 const double bound = 2e-4 * (1.0 + length_of(*layer.contours));
                 for (const MaterialId material : info.materials.ids())
                   EXPECT_NEAR(area_of(regions[material]), exact[material.value()], bound) << z;
               });
}

/// What two solids have in common goes to one of them, so the areas of materials are at most those of the solids, and
/// where nothing overlaps they are the same.
void expect_areas_of_solids(const std::string& name, bool overlaps) {
  double lost = 0.0;
  visit_layers(name, "--layer-height 1.1 --pitch 1 --contours 0.001", [&](const BuildInfo& info, const Layer& layer) {
    const MaterialContours regions = ContourCombiner(info, "test").combine(*layer.contours);
    double solids = 0.0;
    for (const ContourLoop& loop : layer.contours->loops) solids += loop.area;
    double materials = 0.0;
    for (const auto& loops : regions) materials += area_of(loops);
    const double bound = 2e-3 * (1.0 + length_of(*layer.contours));
    EXPECT_LT(materials, solids + bound) << layer.z_sample;
    if (!overlaps) {
      EXPECT_GT(materials, solids - bound) << layer.z_sample;
    }
    lost += (solids - materials) * (layer.z_top - layer.z_bottom);
  });
  if (overlaps) {
    EXPECT_GT(lost, 1.0);
  }
}

TEST(MaterialContours, OfTouchingSolidsLoseNothing) {
  expect_areas_of_solids("touching_boxes", false);
  expect_areas_of_solids("gradient_lens", false);
}

TEST(MaterialContours, OfOverlappingSolidsLoseWhatTheyShare) {
  expect_areas_of_solids("interpenetrating_bodies", true);
  expect_areas_of_solids("overmoulded_grip", true);
}

}  // namespace
}  // namespace lamella::test
