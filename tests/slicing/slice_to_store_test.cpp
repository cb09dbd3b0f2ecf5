/// The main job on hand-built solids: exact geometry, both engines, slicer and store together.

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
  EngineKind engine;

  explicit Assembly(EngineKind kind = EngineKind::span) : engine(kind) {
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
    options.engine = engine;
    options.threads = threads;
    options.allow_open = true;
    return slice(scene, table, measures, plan, options, sink, progress);
  }
};

class SliceToStore : public testing::TestWithParam<EngineKind> {};

INSTANTIATE_TEST_SUITE_P(Engines, SliceToStore, testing::Values(EngineKind::span, EngineKind::reference));

/// Both layers have the same rows of the same solids; ends agree within `tolerance` mm.
void expect_near(const SegmentRows& a, const SegmentRows& b, double tolerance) {
  ASSERT_EQ(a.row_start, b.row_start);
  for (std::size_t i = 0; i < a.segments.size(); ++i) {
    EXPECT_EQ(a.segments[i].solid, b.segments[i].solid);
    EXPECT_NEAR(a.segments[i].x_begin, b.segments[i].x_begin, tolerance);
    EXPECT_NEAR(a.segments[i].x_end, b.segments[i].x_end, tolerance);
  }
}

TEST(SliceByBothEngines, GivesTheSameSegmentsAlsoWhereOpenSolidsGoToTheReferenceEngine) {
  for (const std::size_t open : {0, 1, 2, 3}) {
    Assembly spans(EngineKind::span);
    Assembly rays(EngineKind::reference);
    // Said to be open; the geometry is as before.
    if (open < 3) spans.scene.solids[SolidId{open}].info.status = SolidStatus::open;
    if (open < 3) rays.scene.solids[SolidId{open}].info.status = SolidStatus::open;
    test::CollectingSink by_spans;
    test::CollectingSink by_rays;
    const SliceReport report = spans.slice_into(by_spans, 2);
    const SliceReport expected = rays.slice_into(by_rays, 2);
    EXPECT_EQ(report.cast.hits, expected.cast.hits);
    ASSERT_EQ(by_spans.layers.size(), by_rays.layers.size());
    for (std::size_t k = 0; k < by_rays.layers.size(); ++k) {
      expect_near(by_spans.layers[k].raster, by_rays.layers[k].raster, 1e-6);
      expect_near(by_spans.layers[k].hatch->rows, by_rays.layers[k].hatch->rows, 1e-6);
    }
  }
}

TEST_P(SliceToStore, GivesVolumesWithinTheQuadratureBound) {
  const Assembly assembly(GetParam());
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

TEST_P(SliceToStore, WritesTheSameBytesForAnyNumberOfThreads) {
  const Assembly assembly(GetParam());
  const TemporaryFolder folder;
  for (const int threads : {1, 2}) {
    const auto sink = make_store_sink(folder / std::to_string(threads), {8, 4});
    (void)assembly.slice_into(*sink, threads);
  }
  EXPECT_GT(contents(folder / "1").size(), 4u);
  EXPECT_EQ(contents(folder / "1"), contents(folder / "2"));
}

TEST_P(SliceToStore, GivesBackWhatWasSliced) {
  const Assembly assembly(GetParam());
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

TEST_P(SliceToStore, LeavesOnlyWholeShardsWhenCancelled) {
  const Assembly assembly(GetParam());
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
