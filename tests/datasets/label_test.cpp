#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <string>
#include <vector>

#include "materials/material_rules.h"
#include "slicing/slicer.h"
#include "tests/slicing/known_scene.h"
#include "tests/support/step_scenes.h"

namespace lamella {
namespace {

namespace fs = std::filesystem;

/// Enough to cross every contact of the data sets many times.
constexpr double kRows = 90.0;
constexpr double kLayers = 60.0;

struct Sliced {
  Grid grid;
  std::vector<Layer> layers;
};

Sliced slice_all(const Scene& scene, const MaterialTable& table) {
  const auto measures = measure_solids(scene);
  Box3 bounds;
  for (const SolidMeasure& measure : measures) bounds.extend(measure.bounds);
  PlanOptions options;
  options.pitch = Vec2::Constant(bounds.sizes().head<2>().maxCoeff() / kRows);
  options.layer_height = bounds.sizes().z() / kLayers;
  options.hatch = HatchLattice{1.7 * options.pitch->y(), 0.5, 1.1};
  const LayerPlan plan = plan_layers(bounds, options);
  test::Recorder recorder;
  (void)slice(scene, table, measures, plan, {}, recorder);
  return {plan.grid, std::move(recorder.layers)};
}

/// The same scene with its solids in the opposite order.
Scene reversed(Scene scene) {
  Scene out = scene;
  const std::size_t count = scene.solids.size();
  for (const SolidId id : scene.solids.ids()) out.solids[SolidId{count - 1 - id.value()}] = scene.solids[id];
  for (Shell& shell : out.shells) shell.solid = SolidId{count - 1 - shell.solid.value()};
  return out;
}

void expect_same_labels(const SegmentRows& a, const SegmentRows& b, const std::vector<SolidId>& renamed) {
  ASSERT_EQ(a.row_start, b.row_start);
  for (std::size_t i = 0; i < a.segments.size(); ++i) {
    Segment expected = a.segments[i];
    expected.solid = renamed[expected.solid.value()];
    ASSERT_EQ(b.segments[i], expected);
  }
}

void expect_same_labels(const Sliced& a, const Sliced& b, const std::vector<SolidId>& renamed) {
  ASSERT_EQ(a.layers.size(), b.layers.size());
  for (std::size_t k = 0; k < a.layers.size(); ++k) {
    expect_same_labels(a.layers[k].raster, b.layers[k].raster, renamed);
    expect_same_labels(a.layers[k].hatch->rows, b.layers[k].hatch->rows, renamed);
  }
}

/// Which solid of `to` has the path of each of `from`.
std::vector<SolidId> by_path(const Scene& from, const Scene& to) {
  std::map<std::string, SolidId> known;
  for (const SolidId id : to.solids.ids()) known[to.solids[id].info.path] = id;
  std::vector<SolidId> out;
  for (const Solid& solid : from.solids) out.push_back(known.at(solid.info.path));
  return out;
}

class DatasetLabels : public ::testing::TestWithParam<fs::path> {
 protected:
  void SetUp() override {
    scene_ = test::read_scene(GetParam());
    rules_ = read_material_rules(GetParam().parent_path() / "materials.xml");
  }

  Scene scene_;
  MaterialRules rules_;
};

/// Counted voxel by voxel, with a search of its own: no centre lies in two segments, and materials and void make up the
/// box.
TEST_P(DatasetLabels, ArePartitionsOfTheBox) {
  const MaterialTable table = assign_materials(scene_, rules_);
  const Sliced sliced = slice_all(scene_, table);
  std::vector<std::int64_t> voxels(table.materials.size(), 0);
  std::int64_t empty = 0;
  for (const Layer& layer : sliced.layers) {
    ASSERT_EQ(layer.raster.rows(), static_cast<std::size_t>(sliced.grid.size[1]));
    for (std::size_t r = 0; r < layer.raster.rows(); ++r) {
      for (std::int64_t i = 0; i < sliced.grid.size[0]; ++i) {
        const double x = sliced.grid.origin.x() + (static_cast<double>(i) + 0.5) * sliced.grid.pitch.x();
        std::size_t holders = 0;
        for (const Segment& segment : layer.raster.row(r)) {
          if (!(segment.x_begin <= x && x < segment.x_end)) continue;
          ++holders;
          ++voxels.at(segment.material.value());
        }
        ASSERT_LE(holders, 1U) << "voxel " << i << ", row " << r << ", layer " << layer.index;
        empty += holders == 0 ? 1 : 0;
      }
    }
  }
  std::int64_t total = empty;
  for (const std::int64_t count : voxels) total += count;
  EXPECT_LT(empty, total);
  EXPECT_EQ(total, sliced.grid.size[0] * sliced.grid.size[1] * sliced.grid.size[2]);
}

TEST_P(DatasetLabels, DontDependOnTheOrderOfSolids) {
  const Sliced one = slice_all(scene_, assign_materials(scene_, rules_));
  const Scene other_scene = reversed(scene_);
  const Sliced other = slice_all(other_scene, assign_materials(other_scene, rules_));
  expect_same_labels(one, other, by_path(scene_, other_scene));
}

INSTANTIATE_TEST_SUITE_P(All, DatasetLabels, ::testing::ValuesIn(test::dataset_files()),
                         [](const auto& param) { return test::test_name(param.param); });

/// Three files that overlap and touch, one of them three times.
std::vector<StepPart> overlapping_parts() {
  const auto file = [](const std::string& name) { return test::datasets_dir() / name / (name + ".step"); };
  Motion turned;
  turned.turn << 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0;
  turned.shift = {6.0, 2.0, 0.0};
  Motion shifted;
  shifted.shift = {3.0, 1.0, 0.5};
  return {{file("touching_boxes"), "boxes", {Motion{}}},
          {file("nested_spheres"), "spheres", {shifted}},
          {file("connector"), "plug", {turned}}};
}

TEST(Labels, DontDependOnTheOrderOfFiles) {
  std::vector<StepPart> parts = overlapping_parts();
  const Scene scene = read_step_parts(parts);
  const Sliced one = slice_all(scene, assign_materials(scene));
  std::sort(parts.begin(), parts.end(), [](const StepPart& a, const StepPart& b) { return a.label < b.label; });
  do {
    const Scene other_scene = read_step_parts(parts);
    const Sliced other = slice_all(other_scene, assign_materials(other_scene));
    expect_same_labels(one, other, by_path(scene, other_scene));
  } while (std::next_permutation(parts.begin(), parts.end(),
                                 [](const StepPart& a, const StepPart& b) { return a.label < b.label; }));
}

/// Instances get their numbers by their order, so they are told apart by where they lie.
TEST(Labels, DontDependOnTheOrderOfInstances) {
  const auto file = test::datasets_dir() / "connector" / "connector.step";
  std::vector<Motion> places(3);
  places[1].shift = {8.0, 0.7, 0.0};
  places[2].shift = {4.0, 5.0, 1.0};
  const std::vector<StepPart> parts{{file, "plug", places}};
  const std::vector<StepPart> turned_round{{file, "plug", {places[2], places[0], places[1]}}};
  const Scene scene = read_step_parts(parts);
  const Scene other_scene = read_step_parts(turned_round);
  const std::size_t each = scene.solids.size() / 3;
  std::vector<SolidId> renamed;
  for (std::size_t copy = 0; copy < 3; ++copy) {
    for (std::size_t i = 0; i < each; ++i) renamed.emplace_back((copy + 1) % 3 * each + i);
  }
  // Paths decide last among solids of one priority and volume, so the copies keep theirs.
  Scene same_paths = other_scene;
  for (const SolidId id : scene.solids.ids())
    same_paths.solids[renamed[id.value()]].info.path = scene.solids[id].info.path;
  expect_same_labels(slice_all(scene, assign_materials(scene)), slice_all(same_paths, assign_materials(same_paths)),
                     renamed);
}

}  // namespace
}  // namespace lamella
