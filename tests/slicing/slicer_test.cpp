#include "slicing/slicer.h"

#include <algorithm>
#include <atomic>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/slicing/known_scene.h"

namespace lamella {
namespace {

using test::Ball;
using test::KnownScene;
using test::Recorder;
using testing::HasSubstr;

SliceReport run(const KnownScene& known, const LayerPlan& plan, LayerSink& sink, int threads = 2) {
  SliceOptions options;
  options.threads = threads;
  return slice_with(known.engine(), known.scene, known.table, known.measures, plan, options, sink);
}

Box3 box(const Vec3& lo, const Vec3& hi) { return {lo, hi}; }

/// A ball in a box, a box that overlaps both, and a ball that touches nothing.
KnownScene mixed_scene() {
  KnownScene known;
  known.add(box(Vec3(0, 0, 0), Vec3(10, 10, 10)), 0, 0, "matrix");
  known.add(Ball{Vec3(5, 5, 5), 3}, 1, 1, "ball");
  known.add(box(Vec3(8, 2, 2), Vec3(14, 8, 8)), 2, 0, "block");
  known.add(Ball{Vec3(20, 5, 5), 2.5}, 1, 0, "lone");
  return known;
}

TEST(Slicer, CutsABoxExactlyOnAnAlignedLattice) {
  KnownScene known;
  known.add(box(Vec3(1, 2, 3), Vec3(5, 4, 6)), 0, 0, "box");
  Recorder recorder;
  const SliceReport report = run(known, known.plan(0.5, 0.5), recorder);
  ASSERT_EQ(recorder.layers.size(), 6u);
  EXPECT_TRUE(recorder.is_finished);
  for (std::size_t k = 0; k < 6; ++k) {
    const Layer& layer = recorder.layers[k];
    EXPECT_EQ(layer.index, k);
    EXPECT_DOUBLE_EQ(layer.z_sample, 3.25 + 0.5 * static_cast<double>(k));
    ASSERT_EQ(layer.raster.rows(), 4u);
    for (std::size_t r = 0; r < 4; ++r) {
      ASSERT_EQ(layer.raster.row(r).size(), 1u);
      EXPECT_EQ(layer.raster.row(r)[0], (Segment{1, 5, MaterialId{0}, SolidId{0}}));
    }
    EXPECT_FALSE(layer.hatch);
  }
  const SolidReport& solid = report.solids[SolidId{0}];
  EXPECT_DOUBLE_EQ(solid.volume_sliced, 24.0);
  EXPECT_DOUBLE_EQ(report.materials[MaterialId{0}].volume, 24.0);
  EXPECT_DOUBLE_EQ(report.materials[MaterialId{0}].mass, 24.0 * 2.0 * 1e-3);
  EXPECT_EQ(report.rows, 24u);
  EXPECT_EQ(report.rays, 24u);
  EXPECT_EQ(report.segments, 24u);
  EXPECT_EQ(report.cast.hits, 48u);
  EXPECT_TRUE(report.within_budget());
}

TEST(Slicer, MeasuresVolumesWithinTheQuadratureBound) {
  const KnownScene known = mixed_scene();
  Recorder recorder;
  const SliceReport report = run(known, known.plan(0.1, 0.13), recorder);
  for (const SolidId solid : known.scene.solids.ids()) {
    EXPECT_EQ(report.solids[solid].status, "ok");
    EXPECT_NEAR(report.solids[solid].volume_sliced, known.measures[solid].volume,
                report.solids[solid].quadrature_bound);
  }
  // Errors of curved solids cancel: the midpoint rule is far better than its bound.
  for (const SolidId ball : {SolidId{1}, SolidId{3}}) {
    EXPECT_NEAR(report.solids[ball].volume_sliced, known.measures[ball].volume,
                0.02 * report.solids[ball].quadrature_bound);
  }
  // Priorities move volume between materials and lose none of the union.
  double sliced = 0.0;
  for (const MaterialReport& material : report.materials) sliced += material.volume;
  double solids = 0.0;
  for (const SolidReport& solid : report.solids) solids += solid.volume_sliced;
  double overlaps = 0.0;
  for (const PairReport& pair : report.overlaps) overlaps += pair.volume;
  EXPECT_NEAR(sliced, solids - overlaps, 1e-9 * solids) << "no point lies in three solids here";
}

TEST(Slicer, ReportsOverlapsWithTheirLayersAndWarnsOfAmbiguousOnes) {
  const KnownScene known = mixed_scene();
  Recorder recorder;
  const SliceReport report = run(known, known.plan(0.5, 0.5), recorder);
  ASSERT_EQ(report.overlaps.size(), 2u);
  EXPECT_EQ(report.overlaps[0].first, SolidId{0});
  EXPECT_EQ(report.overlaps[0].second, SolidId{1});
  EXPECT_EQ(report.overlaps[1].second, SolidId{2});
  EXPECT_DOUBLE_EQ(report.overlaps[1].volume, 2.0 * 6.0 * 6.0);
  EXPECT_EQ(report.overlaps[1].layers, 12u);
  ASSERT_EQ(report.findings.size(), 1u) << "the ball has a priority of its own";
  EXPECT_EQ(report.findings[0].solid, "/matrix");
  EXPECT_THAT(report.findings[0].what, HasSubstr("/block"));
  EXPECT_TRUE(report.within_budget()) << "an overlap is a warning";
}

TEST(Slicer, GivesTheSameForAnyNumberOfThreads) {
  const KnownScene known = mixed_scene();
  const LayerPlan plan = known.plan(0.05, 0.3, HatchLattice{0.07, 0.3, 1.17});
  Recorder one;
  const SliceReport expected = run(known, plan, one, 1);
  for (const int threads : {2, 3, 0}) {
    Recorder many;
    const SliceReport report = run(known, plan, many, threads);
    EXPECT_EQ(many.layers, one.layers);
    for (const SolidId solid : known.scene.solids.ids()) {
      EXPECT_EQ(report.solids[solid].volume_sliced, expected.solids[solid].volume_sliced);
    }
    for (const MaterialId material : known.table.materials.ids()) {
      EXPECT_EQ(report.materials[material].volume, expected.materials[material].volume);
    }
    EXPECT_EQ(report.cast.rays, expected.cast.rays);
  }
}

TEST(Slicer, CutsHatchRowsAnchoredAtTheMachineOrigin) {
  KnownScene known;
  known.add(box(Vec3(1, 2, 0), Vec3(5, 4, 1)), 0, 0, "box");
  Recorder recorder;
  (void)run(known, known.plan(0.5, 0.5, HatchLattice{0.4, 0.0, 0.5 * kPi}), recorder);
  const HatchRows& along_x = *recorder.layers[0].hatch;
  EXPECT_EQ(along_x.first_row, 5) << "row 5 lies at y = 2.2";
  ASSERT_EQ(along_x.rows.rows(), 5u);
  EXPECT_EQ(along_x.rows.row(0)[0], (Segment{1, 5, MaterialId{0}, SolidId{0}}));
  // A quarter turn: rows run along +y, and -x counts them.
  const HatchRows& along_y = *recorder.layers[1].hatch;
  EXPECT_DOUBLE_EQ(along_y.angle, 0.5 * kPi);
  EXPECT_EQ(along_y.first_row, -13) << "row -13 lies at x = 5, row -12 at x = 4.6";
  EXPECT_EQ(along_y.rows.segments.front(), (Segment{2, 4, MaterialId{0}, SolidId{0}}));
}

TEST(Slicer, CoversTheSameAreaAtEveryHatchAngle) {
  KnownScene known;
  known.add(Ball{Vec3(3, -2, 0), 2}, 0, 0, "ball");
  Recorder recorder;
  (void)run(known, known.plan(0.5, 4.0, HatchLattice{0.01, 0.7, 0.0}), recorder);
  double area = 0.0;
  for (const Segment& segment : recorder.layers[0].hatch->rows.segments)
    area += 0.01 * (segment.x_end - segment.x_begin);
  EXPECT_NEAR(area, kPi * 4.0, 2e-3);
}

TEST(Slicer, CastsOnlySolidsWhoseBoxARowMeets) {
  KnownScene known;
  known.add(box(Vec3(0, 0, 0), Vec3(1, 1, 1)), 0, 0, "low");
  known.add(box(Vec3(0, 100, 100), Vec3(1, 101, 101)), 0, 0, "high");
  Recorder recorder;
  const SliceReport report = run(known, known.plan(0.25, 0.25), recorder);
  EXPECT_EQ(report.cast.rays, 2u * 4u * 4u);
}

TEST(Slicer, LeavesOpenSolidsOutAndNamesThem) {
  KnownScene known = mixed_scene();
  known.scene.solids[SolidId{1}].info.status = SolidStatus::open;
  known.scene.solids[SolidId{1}].info.closed = false;
  known.scene.solids[SolidId{1}].info.step_entity = 42;
  Recorder recorder;
  const SliceReport report = run(known, known.plan(0.5, 0.5), recorder);
  EXPECT_TRUE(report.solids[SolidId{1}].left_out);
  EXPECT_EQ(report.solids[SolidId{1}].status, "open");
  EXPECT_EQ(report.solids[SolidId{1}].volume_sliced, 0.0);
  EXPECT_FALSE(report.within_budget());
  EXPECT_EQ(report.findings[0].solid, "/ball");
  EXPECT_EQ(report.findings[0].entity, "#42");
  for (const Layer& layer : recorder.layers) {
    for (const Segment& segment : layer.raster.segments) ASSERT_NE(segment.solid, SolidId{1});
  }
}

TEST(Slicer, CutsOpenSolidsWhenAllowedAndStillSaysSo) {
  KnownScene known = mixed_scene();
  known.scene.solids[SolidId{1}].info.status = SolidStatus::open;
  known.scene.solids[SolidId{1}].info.closed = false;
  SliceOptions options;
  options.allow_open = true;
  Recorder recorder;
  const SliceReport report =
      slice_with(known.engine(true), known.scene, known.table, known.measures, known.plan(0.5, 0.5), options, recorder);
  EXPECT_FALSE(report.solids[SolidId{1}].left_out);
  EXPECT_GT(report.solids[SolidId{1}].volume_sliced, 0.0);
  EXPECT_FALSE(report.within_budget());
}

TEST(Slicer, RefusesWhenNoSolidIsLeft) {
  KnownScene known;
  known.add(Ball{Vec3::Zero(), 1}, 0, 0, "shell");
  known.scene.solids[SolidId{0}].info.status = SolidStatus::open;
  known.scene.solids[SolidId{0}].info.closed = false;
  Recorder recorder;
  try {
    (void)run(known, known.plan(0.5, 0.5), recorder);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.where(), HasSubstr("/shell"));
  }
  EXPECT_TRUE(recorder.build.solids.empty()) << "nothing has begun";
}

TEST(Slicer, JudgesAVolumeThatIsTooFarOff) {
  KnownScene known = mixed_scene();
  known.measures[SolidId{0}].volume *= 2.0;
  Recorder recorder;
  const SliceReport report = run(known, known.plan(0.25, 0.25), recorder);
  EXPECT_EQ(report.solids[SolidId{0}].status, "volume");
  EXPECT_EQ(report.solids[SolidId{1}].status, "ok");
  EXPECT_FALSE(report.within_budget());
}

TEST(Slicer, SaysWhereTheEnginesOwnChecksFailed) {
  const KnownScene known = mixed_scene();
  SlabEngine engine = known.engine();
  const SlabFunction cut = engine.cut;
  engine.cut = [&](std::span<const LayerRequest> slab, std::span<LayerSpans> out) {
    cut(slab, out);
    for (std::size_t i = 0; i < slab.size(); ++i) {
      if (slab[i].layer == 3) note_failed(out[i].failed, {Check::balance, SolidId{1}, {}, 4});
    }
  };
  Recorder recorder;
  SliceOptions options;
  const SliceReport report =
      slice_with(engine, known.scene, known.table, known.measures, known.plan(0.25, 0.25), options, recorder);
  const auto names = [](const Finding& finding) {
    return finding.solid == "/ball" &&
           finding.what.find("don't balance: layer 3 (z = 0.875 mm), rows: 4") != std::string::npos;
  };
  EXPECT_EQ(std::count_if(report.findings.begin(), report.findings.end(), names), 1);
}

TEST(Slicer, NamesASolidThatFallsBetweenTheRows) {
  KnownScene known;
  known.add(box(Vec3(0, 0, 0), Vec3(4, 4, 4)), 0, 0, "block");
  known.add(box(Vec3(1, 0.1, 1), Vec3(3, 0.2, 3)), 1, 0, "foil");
  Recorder recorder;
  const SliceReport report = run(known, known.plan(1, 1), recorder);
  EXPECT_EQ(report.solids[SolidId{1}].volume_sliced, 0.0);
  ASSERT_EQ(report.findings.size(), 1u);
  EXPECT_THAT(report.findings[0].solid, HasSubstr("foil"));
  EXPECT_THAT(report.findings[0].what, HasSubstr("no ray meets the solid"));
}

TEST(Slicer, StopsAtAnAmbiguousOverlapUnderPolicyError) {
  KnownScene known = mixed_scene();
  known.table.policy = OverlapPolicy::error;
  Recorder recorder;
  try {
    (void)run(known, known.plan(0.5, 0.5), recorder);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.where(), HasSubstr("/matrix"));
    EXPECT_THAT(error.where(), HasSubstr("/block"));
    EXPECT_THAT(error.where(), HasSubstr("z = 2.25"));
  }
  EXPECT_TRUE(recorder.is_abandoned);
  EXPECT_FALSE(recorder.is_finished);
}

TEST(Slicer, ForgivesAnOverlapThatPrioritiesDecideUnderPolicyError) {
  KnownScene known;
  known.add(box(Vec3(0, 0, 0), Vec3(10, 10, 10)), 0, 0, "matrix");
  known.add(Ball{Vec3(5, 5, 5), 3}, 1, 1, "ball");
  known.table.policy = OverlapPolicy::error;
  Recorder recorder;
  EXPECT_EQ(run(known, known.plan(0.5, 0.5), recorder).overlaps.size(), 1u);
}

TEST(Slicer, KeepsInterfacePoliciesOffTurnedHatches) {
  KnownScene known = mixed_scene();
  known.table.policy = OverlapPolicy::average;
  Recorder recorder;
  EXPECT_THROW((void)run(known, known.plan(0.5, 0.5, HatchLattice{0.4, 0.1, 0.0}), recorder), UsageError);
  EXPECT_NO_THROW((void)run(known, known.plan(0.5, 0.5, HatchLattice{0.4, 0.0, 0.0}), recorder));
}

TEST(Slicer, StopsWhenCancelledAndLetsTheSinkKeepWhatIsFinished) {
  const KnownScene known = mixed_scene();
  std::atomic<bool> cancel{false};
  const Progress progress([&](std::string_view, double fraction) { cancel = fraction > 0.3; }, &cancel);
  Recorder recorder;
  EXPECT_THROW((void)slice_with(known.engine(), known.scene, known.table, known.measures, known.plan(0.5, 0.1), {},
                                recorder, progress),
               Cancelled);
  EXPECT_FALSE(recorder.is_finished);
  EXPECT_FALSE(recorder.is_abandoned);
  EXPECT_GT(recorder.layers.size(), 0u);
  EXPECT_LT(recorder.layers.size(), 100u);
}

TEST(Slicer, ReportsProgressThatOnlyGrowsAndEndsAtOne) {
  const KnownScene known = mixed_scene();
  std::vector<double> fractions;
  const Progress progress([&](std::string_view, double fraction) { fractions.push_back(fraction); });
  Recorder recorder;
  (void)slice_with(known.engine(), known.scene, known.table, known.measures, known.plan(0.5, 0.1), {}, recorder,
                   progress);
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_GT(fractions.size(), 10u);
  EXPECT_EQ(fractions.back(), 1.0);
}

/// Fails at its third layer.
class FullDisk : public Recorder {
 public:
  void write(const Layer& layer) override {
    if (layer.index == 2) throw ExportError("disk full");
    Recorder::write(layer);
  }
};

TEST(Slicer, AbandonsTheSinkWhenItFails) {
  const KnownScene known = mixed_scene();
  FullDisk sink;
  EXPECT_THROW((void)run(known, known.plan(0.5, 0.1), sink), ExportError);
  EXPECT_TRUE(sink.is_abandoned);
  EXPECT_FALSE(sink.is_finished);
}

TEST(TeeSink, FeedsAllItsSinksInOrder) {
  const KnownScene known = mixed_scene();
  TeeSink tee;
  std::vector<Recorder*> recorders;
  for (int i = 0; i < 2; ++i) {
    auto recorder = std::make_unique<Recorder>();
    recorders.push_back(recorder.get());
    tee.add(std::move(recorder));
  }
  (void)run(known, known.plan(0.5, 1.0), tee);
  EXPECT_EQ(recorders[0]->layers.size(), 10u);
  EXPECT_EQ(recorders[0]->layers, recorders[1]->layers);
  EXPECT_TRUE(recorders[0]->is_finished && recorders[1]->is_finished);
  tee.abandon();
  EXPECT_TRUE(recorders[0]->is_abandoned && recorders[1]->is_abandoned);
}

TEST(BuildInfo, NamesSolidsMaterialsAndSources) {
  KnownScene known = mixed_scene();
  known.scene.files.push_back({"a.step", "AP242", "inch", 25.4, ""});
  const BuildInfo info = make_build_info(known.scene, known.table, known.measures, known.plan(1, 1));
  EXPECT_EQ(info.sources[0].path, "a.step");
  EXPECT_EQ(info.solids.size(), 4u);
  EXPECT_EQ(info.solids[SolidId{1}].path, "/ball");
  EXPECT_EQ(info.solids[SolidId{1}].priority, 1);
  EXPECT_EQ(info.solids[SolidId{1}].material, MaterialId{1});
  EXPECT_DOUBLE_EQ(info.solids[SolidId{0}].volume_exact, 1000.0);
}

TEST(SliceReport, CountsRepairedAndUncertainAgainstTheBudget) {
  SliceReport report;
  report.rays = 2'000'000;
  report.cast.hits = 4'000'000;
  report.solids.push_back({});
  EXPECT_TRUE(report.within_budget());
  report.cast.repaired_rays = 2;
  EXPECT_TRUE(report.within_budget());
  report.cast.unclosed_rays = 1;
  EXPECT_FALSE(report.within_budget());
  report.cast = {};
  report.cast.hits = 4'000'000;
  report.cast.uncertain_hits = 4;
  EXPECT_TRUE(report.within_budget());
  report.cast.uncertain_hits = 5;
  EXPECT_FALSE(report.within_budget());
  report.cast = {};
  EXPECT_TRUE(report.within_budget()) << "nothing hit, nothing doubted";
  report.solids[SolidId{0}].status = "invalid";
  EXPECT_FALSE(report.within_budget());
}

}  // namespace
}  // namespace lamella
