#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "slicing/adaptive/adaptive_plan.h"
#include "slicing/slicer.h"
#include "tests/slicing/adaptive/occt_deviation.h"
#include "tests/support/step_scenes.h"

namespace lamella::test {
namespace {

struct Planned {
  std::vector<double> borders;
  double tolerance = 0.0;
};

/// Adaptive layers of a file at a tolerance that suits its height.
Planned plan_file(const std::filesystem::path& file) {
  const Scene scene = read_scene(file);
  MaterialTable table;
  table.materials.push_back({"Resin", std::nullopt});
  for (std::size_t s = 0; s < scene.solids.size(); ++s) table.assignments.push_back({MaterialId{0}, 0, "test"});
  const auto measures = measure_solids(scene);
  const auto solids = choose_solids(scene, measures, false);
  Box3 box;
  for (const SolidId id : solids) box.extend(measures[id].bounds);
  AdaptiveOptions options;
  options.deviation = box.sizes().z() / 200.0;
  const AdaptivePlan plan = plan_adaptive_layers(scene, table, measures, solids, box.min().z(), options);
  EXPECT_LE(plan.largest_deviation, options.deviation + 1e-9);
  // The greedy scheme may save layers by missing more that is flat, never otherwise.
  if (plan.greedy_layers && plan.greedy_missed == 0 && plan.missed == 0) {
    EXPECT_LE(plan.layers.size(), *plan.greedy_layers);
  }
  Planned planned{{plan.layers.front().z_bottom}, options.deviation};
  for (const LayerSpan& layer : plan.layers) planned.borders.push_back(layer.z_top);
  return planned;
}

class AdaptiveDeviation : public ::testing::TestWithParam<std::filesystem::path> {};

// Nothing of the planner judges it: OpenCASCADE reads the file, cuts it, and measures from points of the extruded
// sections to the surface.
TEST_P(AdaptiveDeviation, StaysWithinTheToleranceByOpenCascade) {
  const Planned planned = plan_file(GetParam());
  const MeasuredDeviation found = measure_deviation(GetParam(), planned.borders, {.samples = 300, .seconds = 2.0});
  EXPECT_GT(found.built_samples, 10U);
  EXPECT_GT(found.surface_samples, 0U);
  EXPECT_GT(found.built, 0.0);
  EXPECT_LE(found.built, planned.tolerance) << found.built_at.transpose();
  // The other way round too: none of these has thin places that no layer keeps.
  EXPECT_LE(found.surface, planned.tolerance) << found.surface_at.transpose();
  RecordProperty("built", std::to_string(found.built / planned.tolerance));
  RecordProperty("surface", std::to_string(found.surface / planned.tolerance));
}

std::vector<std::filesystem::path> files() {
  std::vector<std::filesystem::path> out;
  for (const char* name :
       {"bone_screw", "mirrored_brackets", "nested_spheres", "overmoulded_grip", "turbine_blade_16"}) {
    out.push_back(datasets_dir() / name / (std::string(name) + ".step"));
  }
  for (const char* name : {"free_geouned_torus.stp", "mech_netgen_screw.step", "mech_trimesh_featuretype.step"}) {
    if (std::filesystem::exists(corpus_dir() / name)) out.push_back(corpus_dir() / name);
  }
  return out;
}

// A place on the impeller's back plate, in a ring of level face: OpenCASCADE's classifier takes what is below for
// outside, and the nearest wall is 5.5 mm away. With layers that end at the face the deviation is none.
TEST(MeasureDeviation, IsNotMisledByTheClassifier) {
  const auto file = datasets_dir() / "impeller_135" / "impeller_135.step";
  EXPECT_NEAR(surface_deviation_at(file, 2, {-7.5, -0.2, -0.05, 0.0, 0.05, 0.5}, {5.86024371, 9.34457921, 0.0}), 0.0,
              1e-6);
  EXPECT_NEAR(surface_deviation_at(file, 2, {-7.5, -0.2, -0.05, 0.03, 0.05, 0.5}, {5.86024371, 9.34457921, 0.0}), 0.03,
              1e-6);
}

INSTANTIATE_TEST_SUITE_P(Files, AdaptiveDeviation, ::testing::ValuesIn(files()),
                         [](const auto& one) { return test_name(one.param); });

}  // namespace
}  // namespace lamella::test
