#include "slicing/accuracy/accuracy_study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "model/step/read_step.h"
#include "slicing/accuracy/exact_side.h"
#include "slicing/slicer.h"
#include "tests/support/paths.h"

namespace lamella::accuracy {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Model {
  Scene scene;
  StepShapes shapes;
  IdVector<SolidId, SolidMeasure> measures;
};

Model read_model(const std::string& name) {
  Model model;
  const std::vector<StepPart> parts{{test::datasets_dir() / name / (name + ".step"), {}}};
  model.scene = read_step_parts(parts, {}, {}, &model.shapes);
  model.measures = measure_solids(model.scene);
  return model;
}

StudyResult study(Model& model, const StudyOptions& options) {
  return run_study(model.scene, model.measures, model.shapes, options);
}

StudyOptions few(std::vector<double> deflections) {
  StudyOptions options;
  options.deflections = std::move(deflections);
  options.rays = 4000;
  options.oracle_rays = 500;
  options.threads = 1;
  return options;
}

TEST(StepShapes, AreAsManyAsTheSolids) {
  const Model model = read_model("nested_spheres");
  EXPECT_EQ(model.shapes.size(), model.scene.solids.size());
}

// The kernel is the ball of radius 4 about the origin.
TEST(ExactSide, CrossingsOfABallAreThoseOfItsEquation) {
  const Model model = read_model("nested_spheres");
  const std::vector<SolidId> solids{SolidId{0}};
  PlanOptions options;
  options.layer_height = 0.037;
  options.pitch = Vec2(0.1, 0.041);
  const LayerPlan plan = plan_layers(model.measures[SolidId{0}].bounds, options);
  const SlabEngine engine = make_engine(model.scene, model.measures, solids, {});
  CastCounters counters;
  const Crossings found = cut_exactly(engine, plan, solids, counters, {}, 1)[0];
  const RayLattice lattice = lattice_of(plan);
  Crossings exact;
  for (std::uint32_t ray = 0; ray < lattice.rays(); ++ray) {
    const double squared = 16.0 - lattice.ray_y(ray) * lattice.ray_y(ray) - lattice.ray_z(ray) * lattice.ray_z(ray);
    if (squared <= 0.0) continue;
    exact.push_back({ray, -std::sqrt(squared)});
    exact.push_back({ray, std::sqrt(squared)});
  }
  const CrossingErrors errors = compare_crossings(exact, found);
  EXPECT_GT(errors.matched, 60000U);
  EXPECT_EQ(errors.missed + errors.false_, 0U);
  EXPECT_LT(errors.largest, 1e-9);
  const auto areas = exact_section_areas(model.scene, model.measures, solids, lattice.z, {}, 1)[0];
  for (std::size_t k = 0; k < areas.size(); ++k) {
    const double squared = std::max(0.0, 16.0 - lattice.z[k] * lattice.z[k]);
    // Arcs may lie 1e-7 mm off (SpanOptions), over the whole length of the circle.
    EXPECT_NEAR(areas[k], kPi * squared, 1e-7 * kTwoPi * std::sqrt(squared)) << lattice.z[k];
  }
}

TEST(Study, ErrorsOfMeshesShrinkWithTheDeflectionAndThoseOfDirectSlicingAreFarBelow) {
  Model model = read_model("nested_spheres");
  const StudyResult result = study(model, few({0.01, 0.1, 1.0, 0.1}));
  ASSERT_EQ(result.stl.size(), 3U);
  EXPECT_GT(result.direct.oracle_rays, 400U);
  EXPECT_EQ(result.direct.errors.missed + result.direct.errors.false_, 0U);
  EXPECT_LT(result.direct.errors.largest, 1e-9);
  for (std::size_t i = 0; i < 3; ++i) {
    const StlResult& stl = result.stl[i];
    EXPECT_THAT(stl.skipped, IsEmpty());
    EXPECT_EQ(stl.bytes, 84 * result.solids.size() + 50 * stl.triangles);
    EXPECT_EQ(stl.errors.matched + stl.errors.missed, result.direct.hits);
    EXPECT_GT(stl.distance.largest, 0.1 * stl.deflection);
    EXPECT_GE(stl.errors.largest, stl.errors.rms());
    EXPECT_GE(stl.errors.rms(), stl.errors.mean());
    EXPECT_EQ(stl.unclosed_rays, 0U);
    if (i == 0) continue;
    EXPECT_LT(stl.errors.rms(), 0.7 * result.stl[i - 1].errors.rms());
    EXPECT_LT(stl.volume_error, 0.5 * result.stl[i - 1].volume_error);
    EXPECT_LT(stl.area.rms, 0.5 * result.stl[i - 1].area.rms);
    EXPECT_GT(stl.triangles, result.stl[i - 1].triangles);
  }
}

TEST(Study, PlanesAreExactInBoth) {
  Model model = read_model("touching_boxes");
  const StudyResult result = study(model, few({1.0}));
  const StlResult& stl = result.stl[0];
  EXPECT_EQ(stl.triangles, 12 * result.solids.size());
  EXPECT_EQ(stl.errors.missed + stl.errors.false_, 0U);
  EXPECT_LT(stl.errors.largest, 1e-5);  // single precision
  EXPECT_LT(stl.volume_error / result.volume, 1e-6);
}

TEST(Study, QuadratureKeepsItsBound) {
  Model model = read_model("nested_spheres");
  StudyOptions options = few({1.0});
  options.pitches = {0.2, 2.0, 0.7};
  const StudyResult result = study(model, options);
  ASSERT_EQ(result.lattices.size(), 3U);
  EXPECT_EQ(result.lattices[0].pitch, 2.0);
  for (const LatticeResult& lattice : result.lattices) {
    EXPECT_GT(lattice.volume_error, 0.0);
    EXPECT_LT(lattice.volume_error, lattice.volume_bound);
    EXPECT_DOUBLE_EQ(lattice.surface_bound, 0.5 * std::sqrt(3.0) * lattice.pitch);
  }
  EXPECT_LT(result.lattices[2].volume_error, result.lattices[0].volume_error);
}

TEST(Study, LatticesOfHoursAreRefusedAtOnce) {
  Model model = read_model("nested_spheres");
  StudyOptions options = few({1.0});
  options.pitches = {1.0, 1e-4};
  EXPECT_THROW((void)study(model, options), UsageError);
}

TEST(Study, WhatWouldBeTooManyTrianglesIsSkippedBeforeItIsMade) {
  Model model = read_model("nested_spheres");
  StudyOptions options = few({1.0, 0.1, 1e-5, 1e-7});
  options.max_triangles = 20'000;
  const StudyResult result = study(model, options);
  ASSERT_EQ(result.stl.size(), 4U);
  EXPECT_THAT(result.stl[0].skipped, IsEmpty());
  EXPECT_THAT(result.stl[1].skipped, IsEmpty());
  for (std::size_t i = 2; i < 4; ++i) {
    EXPECT_THAT(result.stl[i].skipped, HasSubstr("over 20000 triangles"));
    EXPECT_EQ(result.stl[i].triangles, 0U);
  }
}

TEST(Study, WhatTakesTooLongIsSkipped) {
  Model model = read_model("impeller_135");
  StudyOptions options = few({0.0005});
  options.max_triangles = 1'000'000'000;
  options.max_seconds = 0.2;
  EXPECT_THAT(study(model, options).stl[0].skipped, HasSubstr("over 0.2 s"));
}

TEST(Study, ThreadsChangeNothingButTimes) {
  Model model = read_model("turbine_blade_16");
  StudyOptions options = few({0.1});
  const StudyResult one = study(model, options);
  options.threads = 2;
  const StudyResult two = study(model, options);
  EXPECT_EQ(one.direct.errors.largest, two.direct.errors.largest);
  EXPECT_EQ(one.stl[0].triangles, two.stl[0].triangles);
  EXPECT_EQ(one.stl[0].errors.sum, two.stl[0].errors.sum);
  EXPECT_EQ(one.stl[0].area.rms, two.stl[0].area.rms);
  EXPECT_EQ(one.stl[0].volume_error, two.stl[0].volume_error);
  EXPECT_EQ(one.stl[0].distance.rms, two.stl[0].distance.rms);
  EXPECT_EQ(one.lattices.back().volume_error, two.lattices.back().volume_error);
}

TEST(Study, KeepsStlFilesWhenAsked) {
  Model model = read_model("touching_boxes");
  const test::TemporaryFolder folder;
  StudyOptions options = few({0.5});
  options.stl = folder / "meshes";
  const StudyResult result = study(model, options);
  for (const SolidId solid : result.solids) {
    const auto file = folder / "meshes" / "0.5mm" / ("solid_" + std::to_string(solid.value()) + ".stl");
    EXPECT_EQ(std::filesystem::file_size(file), 84U + 12U * 50U);
  }
}

TEST(Study, StopsWhenCancelled) {
  Model model = read_model("nested_spheres");
  std::atomic<bool> cancel = false;
  const Progress progress(
      [&](std::string_view stage, double) {
        if (stage == "tessellating") cancel = true;
      },
      &cancel);
  EXPECT_THROW((void)run_study(model.scene, model.measures, model.shapes, few({0.01}), progress), Cancelled);
  EXPECT_TRUE(cancel);
}

}  // namespace
}  // namespace lamella::accuracy
