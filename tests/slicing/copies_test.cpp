/// Clusters that come more than once: which are found, and that cutting them once gives what cutting each gives.

#include "slicing/copies.h"

#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>

#include "slicing/copied_engine.h"
#include "slicing/slicer.h"
#include "tests/support/layers.h"
#include "tests/support/solids.h"

namespace lamella {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

/// A scene of instances of three bodies: a tilted box (0), a ball that dips into it (1), a ring (2).
struct Tray {
  Scene scene;
  IdVector<SolidId, SolidMeasure> measures;
  MaterialTable table;

  SolidId add(std::size_t body, const Vec3& shift, double angle = 0.7) {
    const std::string name = "s" + std::to_string(scene.solids.size());
    const auto place = test::Placement::turned(Vec3(1, 2, 3).normalized(), angle, shift);
    const std::size_t first = scene.faces.size();
    const SolidId id = [&] {
      if (body == 0) return test::add_box(scene, Vec3(-4, -3, -2), Vec3(4, 3, 2), {place, name, "", {}}).id;
      if (body == 1) return test::add_sphere(scene, 2.0, {place, name, "", {}}).id;
      return test::add_torus(scene, 3.0, 1.0, {place, name, "", {}}).id;
    }();
    scene.solids[id].info.instance = Instance{body, place.linear, place.translation};
    for (std::size_t f = first; f < scene.faces.size(); ++f)
      scene.faces[FaceId{f}].step_entity = static_cast<int>(100 * body + 1 + f - first);
    return id;
  }
  /// A box with a ball in its corner.
  void add_pair(const Vec3& shift) {
    add(0, shift);
    add(1, shift + Vec3(3, 2, 1));
  }
  void finish() {
    measures = measure_solids(scene);
    table = {};
    for (std::size_t m = 0; m < 3; ++m) table.materials.push_back({"m" + std::to_string(m), 1.0, {}});
    for (const Solid& solid : scene.solids) {
      const std::size_t body = solid.info.instance ? solid.info.instance->body : 0;
      table.assignments.push_back({MaterialId{body}, static_cast<int>(body), ""});
    }
  }
  [[nodiscard]] std::vector<SolidId> all() const {
    std::vector<SolidId> ids;
    for (const SolidId id : scene.solids.ids()) ids.push_back(id);
    return ids;
  }
  [[nodiscard]] std::vector<CopiedCluster> copies() const { return find_copies(scene, measures, all()); }
  [[nodiscard]] LayerPlan plan() const {
    Box3 bounds;
    for (const SolidMeasure& measure : measures) bounds.extend(measure.bounds);
    PlanOptions options;
    options.pitch = Vec2(0.1, 0.23);
    options.layer_height = 0.31;
    options.hatch = HatchLattice{0.5, 0.2, 1.1};
    return plan_layers(bounds, options);
  }
  SliceReport slice_into(LayerSink& sink, int threads = 0) const {
    SliceOptions options;
    options.threads = threads;
    return slice(scene, table, measures, plan(), options, sink);
  }
};

/// Six pairs on two heights, a ring between them, and a loose box.
Tray usual_tray() {
  Tray tray;
  for (const double z : {0.0, 17.3}) {
    for (const double x : {0.0, 13.1, 26.7}) tray.add_pair(Vec3(x, 0.37 * x, z));
  }
  tray.add(2, Vec3(5, 21, 3));
  tray.add(0, Vec3(30, 30, 4), 0.2);
  tray.finish();
  return tray;
}

TEST(FindCopies, GivesClustersOfEqualHeightOnceWithTheirOffsets) {
  const Tray tray = usual_tray();
  const std::vector<CopiedCluster> copies = tray.copies();
  ASSERT_THAT(copies, SizeIs(2));
  for (const CopiedCluster& copied : copies) {
    ASSERT_THAT(copied.copies, SizeIs(3));
    for (const Cluster& cluster : copied.copies) EXPECT_THAT(cluster.solids, SizeIs(2));
    EXPECT_EQ(copied.offsets[0], Vec2(0, 0));
    EXPECT_NEAR(copied.offsets[1].x(), 13.1, 1e-12);
    EXPECT_NEAR(copied.offsets[2].y(), 0.37 * 26.7, 1e-12);
  }
}

TEST(FindCopies, LeavesAloneWhatTouchesIsTurnedOrIsNotSound) {
  Tray touching;
  for (const double x : {0.0, 4.0, 20.0}) touching.add(1, Vec3(x, 0, 0));  // balls of radius 2
  touching.finish();
  EXPECT_THAT(touching.copies(), IsEmpty());
  Tray turned;
  turned.add(0, Vec3(0, 0, 0), 0.7);
  turned.add(0, Vec3(20, 0, 0), 0.8);
  turned.finish();
  EXPECT_THAT(turned.copies(), IsEmpty());
  Tray open;
  open.add(1, Vec3(0, 0, 0));
  open.add(1, Vec3(20, 0, 0));
  open.finish();
  EXPECT_THAT(open.copies(), SizeIs(1));
  open.scene.solids[SolidId{1}].info.status = SolidStatus::invalid;
  EXPECT_THAT(open.copies(), IsEmpty());
  open.scene.solids[SolidId{1}].info.status = SolidStatus::ok;
  open.scene.solids[SolidId{1}].info.instance.reset();
  EXPECT_THAT(open.copies(), IsEmpty());
}

TEST(FindCopies, DistrustsAPlacementThatDoesNotFitTheBounds) {
  Tray tray = usual_tray();
  // A scene that was moved after it was read.
  for (Solid& solid : tray.scene.solids) solid.info.instance->shift *= 1.1;
  EXPECT_THAT(tray.copies(), IsEmpty());
}

TEST(CopiedEngine, GivesTheRowsOfEveryCopyAsItsOwnCutDoes) {
  const Tray once = usual_tray();
  Tray each = usual_tray();
  for (Solid& solid : each.scene.solids) solid.info.instance.reset();
  ASSERT_THAT(each.copies(), IsEmpty());
  test::CollectingSink by_copies;
  test::CollectingSink by_each;
  const SliceReport report = once.slice_into(by_copies);
  const SliceReport expected = each.slice_into(by_each);
  EXPECT_EQ(report.cast.hits, expected.cast.hits);
  EXPECT_EQ(report.overlaps.size(), 6u);
  for (const SolidId id : once.scene.solids.ids())
    EXPECT_NEAR(report.solids[id].volume_sliced, expected.solids[id].volume_sliced, 1e-7);
  ASSERT_EQ(by_copies.layers.size(), by_each.layers.size());
  for (std::size_t k = 0; k < by_each.layers.size(); ++k) {
    for (const auto rows :
         {+[](const Layer& layer) { return &layer.raster; }, +[](const Layer& layer) { return &layer.hatch->rows; }}) {
      const SegmentRows& a = *rows(by_copies.layers[k]);
      const SegmentRows& b = *rows(by_each.layers[k]);
      ASSERT_EQ(a.row_start, b.row_start) << k;
      for (std::size_t i = 0; i < a.segments.size(); ++i) {
        ASSERT_EQ(a.segments[i].solid, b.segments[i].solid) << k;
        EXPECT_NEAR(a.segments[i].x_begin, b.segments[i].x_begin, 1e-6);
        EXPECT_NEAR(a.segments[i].x_end, b.segments[i].x_end, 1e-6);
      }
    }
  }
}

TEST(CopiedEngine, GivesSpansThatNameTheFacesOfTheirOwnSolid) {
  const Tray tray = usual_tray();
  const SlabEngine engine = make_engine(tray.scene, tray.measures, tray.all(), {});
  std::vector<LayerRequest> requests(1);
  requests[0].z = 2.5;
  RowLattice lattice;
  lattice.anchor = -10;
  lattice.spacing = 0.1;
  lattice.last_row = 500;
  requests[0].lattices = {lattice};
  std::vector<LayerSpans> spans;
  make_layer_spans(requests, spans);
  engine.cut(requests, spans);
  std::vector<bool> seen(tray.scene.solids.size(), false);
  for (const Span& span : spans[0].lattices[0].spans) {
    EXPECT_EQ(tray.scene.solid_of(span.face_in), span.solid);
    EXPECT_EQ(tray.scene.solid_of(span.face_out), span.solid);
    seen[span.solid.value()] = true;
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), true), 8);
}

TEST(CopiedEngine, GivesTheSameForAnyNumberOfThreads) {
  const Tray tray = usual_tray();
  test::CollectingSink one;
  (void)tray.slice_into(one, 1);
  for (const int threads : {2, 0}) {
    test::CollectingSink many;
    (void)tray.slice_into(many, threads);
    EXPECT_EQ(many.layers, one.layers);
  }
}

TEST(CopiedEngine, DependsOnTheOrderOfSolidsByNothingButIds) {
  Tray tray;
  Tray reversed;
  const std::vector<Vec3> places{{0, 0, 0}, {13.1, 4, 0}, {26.7, -3, 0}};
  for (const Vec3& place : places) tray.add_pair(place);
  for (auto place = places.rbegin(); place != places.rend(); ++place) {
    reversed.add(1, *place + Vec3(3, 2, 1));
    reversed.add(0, *place);
  }
  tray.finish();
  reversed.finish();
  ASSERT_THAT(tray.copies(), SizeIs(1));
  test::CollectingSink straight;
  test::CollectingSink mirrored;
  (void)tray.slice_into(straight);
  (void)reversed.slice_into(mirrored);
  ASSERT_EQ(straight.layers.size(), mirrored.layers.size());
  for (std::size_t k = 0; k < straight.layers.size(); ++k) {
    Layer& layer = mirrored.layers[k];
    for (SegmentRows* rows : {&layer.raster, &layer.hatch->rows})
      for (Segment& segment : rows->segments) segment.solid = SolidId{5 - segment.solid.value()};
    EXPECT_EQ(layer, straight.layers[k]);
  }
}

TEST(CopiedEngine, CountsALostLoopForEveryCopyAndADoubtOfARowOnce) {
  const Tray tray = usual_tray();
  // Loses a loop of the section once a layer, and doubts every lattice that has rows.
  const EngineMaker make = [](std::span<const SolidId>) {
    SlabEngine engine;
    engine.cut = [](std::span<const LayerRequest> slab, std::span<LayerSpans> out) {
      for (std::size_t i = 0; i < slab.size(); ++i) {
        out[i].cast.uncertain_hits += 1;
        out[i].failed.push_back({Check::loops, SolidId{0}, FaceId{}, 1});
        for (std::size_t k = 0; k < slab[i].lattices.size(); ++k) {
          out[i].cast.uncertain_hits += 10;
          note_failed(out[i].failed, {Check::depth, SolidId{0}, FaceId{0}, 10});
          out[i].lattices[k].row_start.assign(slab[i].lattices[k].rows() + 1, 0);
        }
      }
    };
    return engine;
  };
  std::vector<SolidId> solids;
  for (const SolidId id : tray.all())
    if (id < SolidId{12}) solids.push_back(id);  // the pairs
  const SlabEngine engine = make_copied_engine(tray.scene, solids, tray.copies(), make);
  std::vector<LayerRequest> requests(1);
  requests[0].z = 0.5;
  RowLattice lattice;
  lattice.anchor = -100;
  lattice.last_row = 300;
  requests[0].lattices = {lattice};
  std::vector<LayerSpans> spans;
  make_layer_spans(requests, spans);
  engine.cut(requests, spans);
  // Three copies at this height: 3 times a section's loop, 3 lattices.
  EXPECT_EQ(spans[0].cast.uncertain_hits, 33u);
  std::map<Check, std::uint64_t> failed;
  for (const FailedCheck& check : spans[0].failed) failed[check.check] += check.count;
  EXPECT_EQ(failed[Check::loops], 3u);
  EXPECT_EQ(failed[Check::depth], 30u);
}

TEST(CopiedEngine, SaysWhatWasFoundOfEveryCopy) {
  const Tray tray = usual_tray();
  const EngineMaker make = [&tray](std::span<const SolidId> solids) {
    SlabEngine engine;
    engine.cut = [](std::span<const LayerRequest>, std::span<LayerSpans>) {};
    const std::string path = tray.scene.solids[solids.front()].info.path;
    engine.findings = [path] { return std::vector<Finding>{{Severity::warning, path, {}, "#7", "fitted", {}}}; };
    return engine;
  };
  const SlabEngine engine = make_copied_engine(tray.scene, tray.all(), tray.copies(), make);
  std::vector<std::string> paths;
  for (const Finding& finding : engine.findings()) paths.push_back(finding.solid);
  std::sort(paths.begin(), paths.end());
  EXPECT_EQ(paths.size(), 7u);
  EXPECT_EQ(std::unique(paths.begin(), paths.end()), paths.end());
}

}  // namespace
}  // namespace lamella
