/// The main job on hand-built solids: exact geometry, reference engine, slicer and store together.

#include <atomic>
#include <fstream>
#include <gtest/gtest.h>
#include <map>

#include "slicing/slicer.h"
#include "slicing/store/store.h"
#include "tests/support/layers.h"
#include "tests/support/paths.h"
#include "tests/support/solids.h"

namespace lamella {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream stream(entry.path(), std::ios::binary);
    files[fs::relative(entry.path(), folder).string()] = {std::istreambuf_iterator<char>(stream), {}};
  }
  return files;
}

/// A tilted box, a sphere that overlaps it, and a torus apart.
struct Assembly {
  Scene scene;
  MaterialTable table;
  std::vector<test::KnownSolid> known;
  IdVector<SolidId, SolidMeasure> measures;
  LayerPlan plan;

  Assembly() {
    const auto tilted = test::Placement::turned(Vec3(1, 2, 3).normalized(), 0.7, Vec3(0, 0, 1));
    known.push_back(test::add_box(scene, Vec3(-4, -3, -2), Vec3(4, 3, 2), {tilted, "box", "", {}}));
    known.push_back(test::add_sphere(scene, 2.0, {test::Placement::at(Vec3(3, 1, 1)), "sphere", "", {}}));
    known.push_back(test::add_torus(scene, 3.0, 1.0, {test::Placement::at(Vec3(12, 0, 0)), "torus", "", {}}));
    for (std::size_t m = 0; m < 3; ++m) {
      table.materials.push_back({"m" + std::to_string(m), 1.0, {}});
      table.assignments.push_back({MaterialId{m}, static_cast<int>(m), ""});
    }
    measures = measure_solids(scene);
    Box3 bounds;
    for (const SolidMeasure& measure : measures) bounds.extend(measure.bounds);
    PlanOptions options;
    options.pitch = Vec2(0.1, 0.23);
    options.layer_height = 0.31;
    options.hatch = HatchLattice{0.5, 0.2, 1.1};
    plan = plan_layers(bounds, options);
  }

  SliceReport slice_into(LayerSink& sink, int threads, const Progress& progress = {}) const {
    SliceOptions options;
    options.engine = EngineKind::reference;
    options.threads = threads;
    return slice(scene, table, measures, plan, options, sink, progress);
  }
};

TEST(SliceToStore, GivesVolumesWithinTheQuadratureBound) {
  const Assembly assembly;
  test::CollectingSink sink;
  const SliceReport report = assembly.slice_into(sink, 2);
  EXPECT_TRUE(report.within_budget());
  for (const test::KnownSolid& known : assembly.known) {
    const SolidReport& solid = report.solids[known.id];
    EXPECT_EQ(solid.status, "ok");
    EXPECT_NEAR(solid.volume_exact, known.volume, 1e-6 * known.volume);
    EXPECT_NEAR(solid.volume_sliced, known.volume, 0.1 * solid.quadrature_bound);
  }
  ASSERT_EQ(report.overlaps.size(), 1u);
  EXPECT_GT(report.overlaps[0].volume, 1.0);
}

TEST(SliceToStore, WritesTheSameBytesForAnyNumberOfThreads) {
  const Assembly assembly;
  const TemporaryFolder folder;
  for (const int threads : {1, 2}) {
    const auto sink = make_store_sink(folder / std::to_string(threads), {8, 4});
    (void)assembly.slice_into(*sink, threads);
  }
  EXPECT_GT(contents(folder / "1").size(), 4u);
  EXPECT_EQ(contents(folder / "1"), contents(folder / "2"));
}

TEST(SliceToStore, GivesBackWhatWasSliced) {
  const Assembly assembly;
  const TemporaryFolder folder;
  test::CollectingSink direct;
  (void)assembly.slice_into(direct, 2);
  const auto sink = make_store_sink(folder / "build");
  (void)assembly.slice_into(*sink, 2);
  test::CollectingSink replayed;
  StoreReader(folder / "build").replay(replayed);
  EXPECT_EQ(replayed.layers, direct.layers);
  EXPECT_EQ(replayed.report.solids[SolidId{2}].volume_sliced, direct.report.solids[SolidId{2}].volume_sliced);
}

TEST(SliceToStore, LeavesOnlyWholeShardsWhenCancelled) {
  const Assembly assembly;
  const TemporaryFolder folder;
  const auto whole = make_store_sink(folder / "whole", {8, 4});
  (void)assembly.slice_into(*whole, 2);
  std::atomic<bool> cancel{false};
  const Progress progress(
      [&](std::string_view stage, double fraction) { cancel = stage == "slicing" && fraction > 0.6; }, &cancel);
  {
    const auto sink = make_store_sink(folder / "build", {8, 4});
    EXPECT_THROW((void)assembly.slice_into(*sink, 2, progress), Cancelled);
  }
  auto expected = contents(folder / "whole");
  auto files = contents(folder / "build");
  EXPECT_EQ(files.erase("unfinished.xml"), 1u);
  EXPECT_GE(files.size(), 1u);
  EXPECT_LT(files.size(), expected.size());
  for (const auto& [name, bytes] : files) EXPECT_EQ(bytes, expected[name]) << name;
}

}  // namespace
}  // namespace lamella
