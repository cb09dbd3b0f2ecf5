/// Contours in the slicing pass and in the store: copies have those of their own cut, layers come back bit for bit, and
/// what is malformed or can't be made is refused.

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>

#include "core/error.h"
#include "slicing/contour_findings.h"
#include "slicing/layer_check.h"
#include "slicing/slicer.h"
#include "tests/slicing/store_sample.h"
#include "tests/support/layers.h"
#include "tests/support/paths.h"
#include "tests/support/solids.h"

namespace lamella {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

/// Three boxes with a ball in a corner each, instances of the same two bodies, and a ring apart.
struct Tray {
  Scene scene;
  IdVector<SolidId, SolidMeasure> measures;
  MaterialTable table;

  explicit Tray(bool are_instances) {
    for (const double x : {0.0, 13.1, 26.7}) {
      add(0, Vec3(x, 0.37 * x, 0));
      add(1, Vec3(x + 3, 0.37 * x + 2, 1));
    }
    add(2, Vec3(5, 21, 3));
    if (!are_instances) {
      for (Solid& solid : scene.solids) solid.info.instance.reset();
    }
    measures = measure_solids(scene);
  }

  void add(std::size_t body, const Vec3& shift) {
    const auto place = test::Placement::turned(Vec3(1, 2, 3).normalized(), 0.7, shift);
    const test::SolidOptions options{place, "s" + std::to_string(scene.solids.size()), "", {}};
    const std::size_t first = scene.faces.size();
    const SolidId id = body == 0   ? test::add_box(scene, Vec3(-4, -3, -2), Vec3(4, 3, 2), options).id
                       : body == 1 ? test::add_sphere(scene, 2.0, options).id
                                   : test::add_torus(scene, 3.0, 1.0, options).id;
    scene.solids[id].info.instance = Instance{body, place.linear, place.translation};
    for (std::size_t f = first; f < scene.faces.size(); ++f)
      scene.faces[FaceId{f}].step_entity = static_cast<int>(100 * body + 1 + f - first);
    table.materials.push_back({"m" + std::to_string(id.value()), 1.0, {}});
    table.assignments.push_back({MaterialId{id.value()}, static_cast<int>(body), ""});
  }

  [[nodiscard]] LayerPlan plan() const {
    Box3 bounds;
    for (const SolidMeasure& measure : measures) bounds.extend(measure.bounds);
    PlanOptions options;
    options.pitch = Vec2(0.5, 0.5);
    options.layer_height = 0.31;
    options.chord_error = 0.01;
    return plan_layers(bounds, options);
  }

  void slice_into(LayerSink& sink, const SliceOptions& options = {}) const {
    (void)slice(scene, table, measures, plan(), options, sink);
  }
};

Box2 bounds_of(std::span<const Vec2> polygon) {
  Box2 box;
  for (const Vec2& point : polygon) box.extend(point);
  return box;
}

TEST(Contours, OfCopiesAreThoseOfTheirOwnCut) {
  const Tray once(true);
  const Tray each(false);
  test::CollectingSink by_copies;
  test::CollectingSink by_each;
  once.slice_into(by_copies);
  each.slice_into(by_each);
  ASSERT_EQ(by_copies.layers.size(), by_each.layers.size());
  std::size_t loops = 0;
  for (std::size_t k = 0; k < by_each.layers.size(); ++k) {
    const LayerContours& a = *by_copies.layers[k].contours;
    const LayerContours& b = *by_each.layers[k].contours;
    ASSERT_EQ(a.loops.size(), b.loops.size());
    for (std::size_t i = 0; i < a.loops.size(); ++i) {
      EXPECT_EQ(a.loops[i].solid, b.loops[i].solid);
      EXPECT_EQ(a.loops[i].parent, b.loops[i].parent);
      EXPECT_NEAR(a.loops[i].area, b.loops[i].area, 1e-6);
      EXPECT_LT((bounds_of(a.polygon(i)).min() - bounds_of(b.polygon(i)).min()).norm(), 0.02);
      EXPECT_LT((bounds_of(a.polygon(i)).max() - bounds_of(b.polygon(i)).max()).norm(), 0.02);
      ++loops;
    }
  }
  EXPECT_GT(loops, 3 * by_each.layers.size());
}

TEST(Contours, EncloseTheSectionsAreaToTheChordError) {
  const Tray tray(true);
  test::CollectingSink sink;
  tray.slice_into(sink);
  double ring = 0.0;
  for (const Layer& layer : sink.layers) {
    for (std::size_t i = 0; i < layer.contours->loops.size(); ++i) {
      const auto points = layer.contours->polygon(i);
      double area = 0.0;
      double length = 0.0;
      for (std::size_t p = 0; p < points.size(); ++p) {
        const Vec2& a = points[p];
        const Vec2& b = points[(p + 1) % points.size()];
        area += 0.5 * (a.x() * b.y() - b.x() * a.y());
        length += (b - a).norm();
      }
      EXPECT_NEAR(area, layer.contours->loops[i].area, 0.011 * length);
      if (layer.contours->loops[i].solid == SolidId{6}) ring += layer.contours->loops[i].area * 0.31;
    }
  }
  // Pappus: 2 pi R times pi r^2; 0.31 mm layers of a body 7 mm high.
  EXPECT_NEAR(ring, 2 * kPi * kPi * 3, 1.0);
}

TEST(Contours, AreTheSameForAnyNumberOfThreads) {
  const Tray tray(true);
  SliceOptions options;
  options.threads = 1;
  test::CollectingSink one;
  tray.slice_into(one, options);
  options.threads = 3;
  test::CollectingSink many;
  tray.slice_into(many, options);
  EXPECT_EQ(one.layers, many.layers);
}

TEST(Contours, AreRefusedWhereTheEngineCanMakeNone) {
  const Tray tray(true);
  SliceOptions options;
  options.engine = EngineKind::reference;
  test::CollectingSink sink;
  try {
    tray.slice_into(sink, options);
    FAIL() << "no error";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.hint(), HasSubstr("--engine reference"));
  }
}

TEST(Contours, OpenSolidsHaveNoneAndAreNamedWhereTheyAreSliced) {
  Tray tray(true);
  Tray closed(true);
  const SolidId open{3};  // a ball in a box
  tray.scene.solids[open].info.status = SolidStatus::open;
  tray.scene.solids[open].info.closed = false;
  SliceOptions options;
  options.allow_open = true;
  test::CollectingSink sink;
  const SliceReport report = slice(tray.scene, tray.table, tray.measures, tray.plan(), options, sink);
  test::CollectingSink all;
  closed.slice_into(all);
  std::size_t rows = 0;
  std::size_t others = 0;
  for (std::size_t k = 0; k < sink.layers.size(); ++k) {
    for (const Segment& segment : sink.layers[k].raster.segments) rows += segment.solid == open ? 1 : 0;
    std::size_t left = 0;
    for (const ContourLoop& loop : all.layers[k].contours->loops) left += loop.solid == open ? 0 : 1;
    ASSERT_EQ(sink.layers[k].contours->loops.size(), left) << k;
    for (const ContourLoop& loop : sink.layers[k].contours->loops) EXPECT_NE(loop.solid, open);
    others += left;
  }
  EXPECT_GT(rows, 50U);
  EXPECT_GT(others, sink.layers.size());
  EXPECT_FALSE(report.within_budget());
  std::size_t named = 0;
  for (const Finding& finding : report.findings) {
    if (finding.what.find("no contours") == std::string::npos) continue;
    EXPECT_EQ(finding.solid, "/s3");
    EXPECT_THAT(finding.what, HasSubstr("more"));
    ++named;
  }
  EXPECT_EQ(named, 1U);
}

LayerContours sample_contours() {
  LayerContours contours;
  contours.add({SolidId{0}, -1, 16.0}, std::vector<Vec2>{{0, 0}, {4, 0}, {4, 4}, {0, 4}});
  contours.add({SolidId{0}, 0, -1.0}, std::vector<Vec2>{{1, 1}, {1, 2}, {2, 2}, {2, 1}});
  contours.add({SolidId{2}, -1, 0.5}, std::vector<Vec2>{{7, 7}, {8, 7}, {7, 1.0 / 3.0 + 8}});
  return contours;
}

TEST(Contours, ComeBackFromTheStoreBitForBit) {
  test::Sample sample = test::make_sample(5);
  sample.info.plan.chord_error = 1.0 / 3.0;
  for (Layer& layer : sample.layers) layer.contours.emplace();
  sample.layers[1].contours = sample_contours();
  // More than one chunk's bytes would be slow to make by hand; many loops are enough to be compressed.
  for (int i = 0; i < 500; ++i) {
    const double x = 0.1 * i;
    sample.layers[3].contours->add({SolidId{1}, -1, 0.005}, std::vector<Vec2>{{x, 0}, {x + 0.1, 0}, {x, 0.1}});
  }
  const test::TemporaryFolder folder;
  test::write_sample(sample, folder / "build");
  EXPECT_THAT(test::read_file(folder / "build" / "build.xml"), HasSubstr("version=\"1.2\""));
  EXPECT_EQ(std::system(("xmllint --nonet --noout --schema '" + (test::source_dir() / "schemas/build.xsd").string() +
                         "' '" + (folder / "build" / "build.xml").string() + "' 2>/dev/null")
                            .c_str()),
            0);
  const StoreReader reader(folder / "build");
  EXPECT_EQ(reader.info().plan.chord_error, sample.info.plan.chord_error);
  for (std::uint32_t k = 0; k < 5; ++k) EXPECT_EQ(reader.read_layer(k), sample.layers[k]) << k;
}

TEST(Contours, AreReadAsTheSampleOfTheSchemaSaysAndOnlyWhereThePlanHasThem) {
  const test::TemporaryFolder folder;
  const std::string sample = test::read_file(test::source_dir() / "schemas/valid/build/contours.xml");
  test::write_file(folder / "build/build.xml", sample);
  EXPECT_EQ(StoreReader(folder / "build").info().plan.chord_error, 0.01);
  for (const std::string& part : {std::string("<contours chord_error=\"0.01\"/>"), std::string(" loops=\"2\"")}) {
    std::string without = sample;
    without.erase(without.find(part), part.size());
    test::write_file(folder / "build/build.xml", without);
    EXPECT_THROW(StoreReader(folder / "build"), InputError) << part;
  }
}

TEST(Contours, ThatAreMalformedAreNamed) {
  const test::Sample sample = test::make_sample(1);
  const LayerLimits limits = make_layer_limits(60, sample.info.materials, 3);
  Layer good = sample.layers[0];
  good.contours = sample_contours();
  EXPECT_EQ(find_layer_fault(good, limits), std::nullopt);
  const auto fault_of = [&](const auto& spoil) {
    Layer layer = good;
    spoil(*layer.contours);
    return find_layer_fault(layer, limits).value_or("none");
  };
  EXPECT_THAT(fault_of([](LayerContours& c) { c.loops[2].solid = SolidId{3}; }), HasSubstr("solid id"));
  EXPECT_THAT(fault_of([](LayerContours& c) { c.loops[0].solid = SolidId{1}; }), HasSubstr("order"));
  EXPECT_THAT(fault_of([](LayerContours& c) { c.loops[1].parent = 3; }), HasSubstr("parent"));
  EXPECT_THAT(fault_of([](LayerContours& c) { c.loops[1].parent = 1; }), HasSubstr("parent"));
  EXPECT_THAT(fault_of([](LayerContours& c) { c.loops[2].parent = 1; }), HasSubstr("parent"));
  EXPECT_THAT(fault_of([](LayerContours& c) { c.points[3].y() = std::nan(""); }), HasSubstr("finite"));
  EXPECT_THAT(fault_of([](LayerContours& c) { c.point_start[1] = 2; }), HasSubstr("three"));
  EXPECT_THAT(fault_of([](LayerContours& c) { c.point_start[1] = 12; }), HasSubstr("order"));
  EXPECT_THAT(fault_of([](LayerContours& c) { c.points.pop_back(); }), HasSubstr("order"));
}

Vec2 point_at(const ContourCurve& curve, double t) {
  const auto& n = curve.numbers;
  if (curve.kind == CurveKind::ellipse) {
    const double angle = n[6] + t * n[7];
    return Vec2(n[0], n[1]) + std::cos(angle) * Vec2(n[2], n[3]) + std::sin(angle) * Vec2(n[4], n[5]);
  }
  if (curve.kind == CurveKind::conic) {
    const double first = (1.0 - t) * (1.0 - t);
    const double middle = 2.0 * n[6] * t * (1.0 - t);
    const Vec2 sum = first * Vec2(n[0], n[1]) + middle * Vec2(n[2], n[3]) + t * t * Vec2(n[4], n[5]);
    return sum / (first + middle + t * t);
  }
  Vec2 at = Vec2::Zero();
  for (int k = 5; k >= 0; --k) at = at * t + Vec2(n[static_cast<std::size_t>(k)], n[static_cast<std::size_t>(k) + 6]);
  return at;
}

TEST(Contours, KeepCurvesThatTheirCornersLieOnWhenAsked) {
  const Tray tray(true);
  LayerPlan plan = tray.plan();
  test::CollectingSink without;
  tray.slice_into(without);
  plan.curves = true;
  test::CollectingSink sink;
  (void)slice(tray.scene, tray.table, tray.measures, plan, {}, sink);
  std::map<CurveKind, std::size_t> found;
  for (std::size_t k = 0; k < sink.layers.size(); ++k) {
    const LayerContours& contours = *sink.layers[k].contours;
    EXPECT_EQ(contours.points, without.layers[k].contours->points);
    EXPECT_TRUE(without.layers[k].contours->curves.empty());
    const double z = sink.layers[k].z_sample;
    for (std::size_t loop = 0; loop < contours.loops.size(); ++loop) {
      const auto polygon = contours.polygon(loop);
      for (const ContourCurve& curve : contours.curves_of(loop)) {
        ++found[curve.kind];
        EXPECT_LT((point_at(curve, 0.0) - polygon[curve.first_side]).norm(), 1e-6);
        EXPECT_LT((point_at(curve, 1.0) - polygon[(curve.first_side + curve.sides) % polygon.size()]).norm(), 1e-6);
        if (contours.loops[loop].solid.value() % 2 == 0) continue;
        // A ball's: everywhere, not only in the corners, at the distance of its radius from its centre.
        const Box3& bounds = tray.measures[contours.loops[loop].solid].bounds;
        const Vec3 centre = bounds.center();
        for (double t = 0.0; t <= 1.0; t += 0.125) {
          const Vec2 at = point_at(curve, t);
          EXPECT_NEAR((Vec3(at.x(), at.y(), z) - centre).norm(), 2.0, 1e-9) << k;
        }
      }
    }
  }
  EXPECT_GT(found[CurveKind::ellipse], sink.layers.size());
  EXPECT_GT(found[CurveKind::quintic], sink.layers.size());
}

LayerContours sample_with_curves() {
  LayerContours contours;
  const std::vector<ContourCurve> curves{{0, 2, CurveKind::ellipse, {1, 2, 3, 0, 0, 1.0 / 3.0, 0.1, -6.0}},
                                         {2, 1, CurveKind::conic, {4, 4, 2, 5, 0, 4, 1.0 / 7.0}},
                                         {3, 1, CurveKind::quintic, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 1e-300}}};
  contours.add({SolidId{0}, -1, 16.0}, std::vector<Vec2>{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, curves);
  contours.add({SolidId{0}, 0, -1.0}, std::vector<Vec2>{{1, 1}, {1, 2}, {2, 2}, {2, 1}});
  contours.add({SolidId{1}, -1, 16.0}, std::vector<Vec2>{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, curves);
  return contours;
}

TEST(Contours, CurvesComeBackFromTheStoreBitForBit) {
  test::Sample sample = test::make_sample(3);
  sample.info.plan.chord_error = 0.5;
  sample.info.plan.curves = true;
  for (Layer& layer : sample.layers) layer.contours.emplace();
  sample.layers[1].contours = sample_with_curves();
  const test::TemporaryFolder folder;
  test::write_sample(sample, folder / "build");
  EXPECT_THAT(test::read_file(folder / "build" / "build.xml"), HasSubstr("version=\"1.4\""));
  EXPECT_EQ(std::system(("xmllint --nonet --noout --schema '" + (test::source_dir() / "schemas/build.xsd").string() +
                         "' '" + (folder / "build" / "build.xml").string() + "' 2>/dev/null")
                            .c_str()),
            0);
  const StoreReader reader(folder / "build");
  EXPECT_TRUE(reader.info().plan.curves);
  for (std::uint32_t k = 0; k < 3; ++k) EXPECT_EQ(reader.read_layer(k), sample.layers[k]) << k;
}

TEST(Contours, CurvesMoveWithTheirLoops) {
  for (ContourCurve curve : sample_with_curves().curves) {
    const ContourCurve before = curve;
    curve.shift({0.25, -3.0});
    for (const double t : {0.0, 0.4, 1.0}) {
      EXPECT_LT((point_at(curve, t) - point_at(before, t) - Vec2(0.25, -3.0)).norm(), 1e-14);
    }
  }
}

TEST(Contours, CurvesThatAreMalformedAreNamed) {
  const test::Sample sample = test::make_sample(1);
  const LayerLimits limits = make_layer_limits(60, sample.info.materials, 3);
  Layer good = sample.layers[0];
  good.contours = sample_with_curves();
  EXPECT_EQ(find_layer_fault(good, limits), std::nullopt);
  const auto fault_of = [&](const auto& spoil) {
    Layer layer = good;
    spoil(layer.contours->curves);
    return find_layer_fault(layer, limits).value_or("none");
  };
  using Curves = std::vector<ContourCurve>;
  EXPECT_THAT(fault_of([](Curves& c) { c[1].first_side = 1; }), HasSubstr("order"));
  EXPECT_THAT(fault_of([](Curves& c) { c[1].sides = 2; }), HasSubstr("order"));
  EXPECT_THAT(fault_of([](Curves& c) { c[0].sides = 0; }), HasSubstr("order"));
  EXPECT_THAT(fault_of([](Curves& c) { c[3].first_side = 12; }), HasSubstr("order"));
  EXPECT_THAT(fault_of([](Curves& c) { c[0].numbers[4] = std::nan(""); }), HasSubstr("finite"));
  EXPECT_THAT(fault_of([](Curves& c) { c[1].numbers[6] = 0.0; }), HasSubstr("weight"));
  EXPECT_THAT(fault_of([](Curves& c) { c[1].kind = static_cast<CurveKind>(3); }), HasSubstr("kind"));
}

TEST(Contours, FaultsAreNamedOnceEach) {
  ContourFindings findings;
  for (int layer = 0; layer < 7; ++layer) findings.add({Severity::error, "/a", {}, "#12", "does not close", "repair"});
  findings.add({Severity::warning, "/a", {}, "#12", "a chord", {}});
  std::vector<Finding> all;
  findings.report(all);
  ASSERT_THAT(all, SizeIs(2));
  EXPECT_THAT(all[0].what + all[1].what, HasSubstr("and 6 more"));
}

}  // namespace
}  // namespace lamella
