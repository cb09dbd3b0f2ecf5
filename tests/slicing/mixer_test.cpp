#include "slicing/mixer.h"

#include <cmath>
#include <gtest/gtest.h>

#include "slicing/layer_check.h"
#include "slicing/store/store.h"
#include "tests/slicing/store_sample.h"
#include "tests/support/graded_scene.h"
#include "tests/support/layers.h"
#include "tests/support/paths.h"

namespace lamella {
namespace {

using test::GradedScene;

/// The share of the first component at `x` by the knots.
double share_at(const Mixtures& mixtures, std::size_t g, double x) {
  const auto knots = mixtures.knots(g);
  const auto fractions = mixtures.fractions(g);
  if (x <= knots.front()) return fractions[0];
  for (std::size_t k = 1; k < knots.size(); ++k) {
    if (x > knots[k]) continue;
    const double part = (x - knots[k - 1]) / (knots[k] - knots[k - 1]);
    return (1.0 - part) * fractions[2 * (k - 1)] + part * fractions[2 * k];
  }
  return fractions[2 * (knots.size() - 1)];
}

/// The largest error of fractions at points of a row, and how many there were. Points within 2 um of the jump of the
/// formula don't count.
struct Error {
  double largest = 0.0;
  std::size_t points = 0;
};

void compare(const GradedScene& scene, const SegmentRows& rows, const Vec2& along, const Vec2& across, double z,
             const std::function<double(std::size_t)>& position, Error& error) {
  const Compositions compositions(scene.scene, scene.table);
  Compositions::Probe probe(compositions);
  std::size_t g = 0;
  for (std::size_t r = 0; r < rows.rows(); ++r) {
    for (std::uint64_t i = rows.row_start[r]; i < rows.row_start[r + 1]; ++i) {
      const Segment& segment = rows.segments[i];
      if (compositions.components(segment.solid) == 0) continue;
      ASSERT_EQ(rows.mixtures.segment[g], i);
      probe.start(segment.solid);
      for (double x = segment.x_begin; x < segment.x_end; x += 0.0173) {
        Vec3 point;
        point << x * along + position(r) * across, z;
        if (segment.solid == SolidId{2} && std::abs(point.x() - 4.0) < 2e-3) continue;
        std::array<double, 2> exact{};
        probe.sample(point, exact);
        error.largest = std::max(error.largest, std::abs(share_at(rows.mixtures, g, x) - exact[0]));
        ++error.points;
      }
      ++g;
    }
  }
  EXPECT_EQ(g, rows.mixtures.segment.size());
}

TEST(Mixer, FractionsBetweenKnotsStayWithinTheTolerance) {
  const GradedScene scene(0.5);
  test::CollectingSink sink;
  (void)scene.slice_into(sink);
  Error raster;
  Error hatch;
  std::size_t knots = 0;
  for (const Layer& layer : sink.layers) {
    const Grid& grid = scene.plan.grid;
    compare(
        scene, layer.raster, Vec2::UnitX(), Vec2::UnitY(), layer.z_sample,
        [&](std::size_t r) { return grid.origin.y() + (static_cast<double>(r) + 0.5) * grid.pitch.y(); }, raster);
    const HatchAxes axes = hatch_axes(*scene.plan.hatch, layer.index);
    compare(
        scene, layer.hatch->rows, axes.along, axes.across, layer.z_sample,
        [&](std::size_t r) {
          return (static_cast<double>(layer.hatch->first_row + static_cast<std::int64_t>(r)) + 0.5) *
                 layer.hatch->spacing;
        },
        hatch);
    knots += layer.raster.mixtures.x.size();
  }
  EXPECT_GT(raster.points, 100'000U);
  EXPECT_GT(hatch.points, 50'000U);
  EXPECT_LE(raster.largest, kMixTolerance);
  EXPECT_LE(hatch.largest, kMixTolerance);
  EXPECT_LT(knots, raster.points / 10);
}

TEST(Mixer, AConstantOrStraightFieldNeedsOneOrTwoKnots) {
  const GradedScene scene(0.5, false);
  test::CollectingSink sink;
  (void)scene.slice_into(sink);
  for (const Layer& layer : sink.layers) {
    for (std::size_t g = 0; g < layer.raster.mixtures.segment.size(); ++g) {
      const Segment& segment = layer.raster.segments[layer.raster.mixtures.segment[g]];
      // Along a row of the box the fraction is one number.
      if (segment.solid == SolidId{0}) {
        EXPECT_EQ(layer.raster.mixtures.knots(g).size(), 1U);
      }
    }
  }
}

TEST(Mixer, VolumesCountTheFractions) {
  const GradedScene scene(0.1, false);
  test::CollectingSink sink;
  const SliceReport report = scene.slice_into(sink);
  EXPECT_EQ(report.materials[MaterialId{2}].volume, 0.0);
  EXPECT_EQ(report.materials[MaterialId{3}].volume, 0.0);
  // The box gives half of 512 to each. In the torus the share of B at depth s is min(s / 1.5, 1): by Pappus' rule,
  // with the ring of radius 2 - s, 2 pi 5 times the integral of 2 pi (2 - s) min(s / 1.5, 1) over s in [0, 2], which is
  // 0.75 + 0.125.
  const double torus_b = 2.0 * kPi * 5.0 * 2.0 * kPi * (0.75 + 0.125);
  double sphere_a = 0.0;
  const double h = 0.01;
  for (double x = -3.0 + 0.5 * h; x < 3.0; x += h) {
    for (double y = -3.0 + 0.5 * h; y < 3.0; y += h) {
      const double chord = 9.0 - x * x - y * y;
      if (chord > 0.0) sphere_a += 2.0 * std::sqrt(chord) * h * h * (x > 0.0 ? 0.8 : 0.5 + 0.3 * std::sin(16.0 + y));
    }
  }
  // The fractions may be off by the tolerance, and the lattice misses of each solid what it misses of its volume.
  double allowed = 0.0;
  for (const SolidReport& solid : report.solids) {
    allowed += kMixTolerance * solid.volume_exact + std::abs(solid.volume_sliced - solid.volume_exact);
  }
  EXPECT_LT(allowed, 2.0);
  const double torus = 2.0 * kPi * kPi * 5.0 * 4.0;
  const double sphere = 36.0 * kPi;
  EXPECT_NEAR(report.materials[MaterialId{0}].volume, 256.0 + torus - torus_b + sphere_a, allowed);
  EXPECT_NEAR(report.materials[MaterialId{1}].volume, 256.0 + torus_b + sphere - sphere_a + 96.0, allowed);
  const double all = report.materials[MaterialId{0}].volume + report.materials[MaterialId{1}].volume;
  double sliced = 0.0;
  for (const SolidReport& solid : report.solids) sliced += solid.volume_sliced;
  EXPECT_NEAR(all, sliced, 1e-4);
  EXPECT_NEAR(report.materials[MaterialId{1}].mass, 3e-3 * report.materials[MaterialId{1}].volume, 1e-12);
}

TEST(Mixer, TheStoreGivesBackTheSameForAnyNumberOfThreads) {
  const GradedScene scene(0.5);
  const test::TemporaryFolder folder;
  test::CollectingSink sink;
  (void)scene.slice_into(sink);
  for (const int threads : {1, 2, 5}) {
    const auto store = make_store_sink(folder / std::to_string(threads));
    (void)scene.slice_into(*store, threads);
  }
  EXPECT_EQ(test::contents(folder / "1"), test::contents(folder / "2"));
  EXPECT_EQ(test::contents(folder / "1"), test::contents(folder / "5"));
  const StoreReader reader(folder / "1");
  EXPECT_EQ(reader.info().materials[MaterialId{3}].components, (std::vector<MaterialId>{MaterialId{0}, MaterialId{1}}));
  ASSERT_GT(sink.layers.size(), 10U);
  for (const Layer& layer : sink.layers) EXPECT_EQ(reader.read_layer(layer.index), layer);
  const std::string command = "xmllint --nonet --noout --schema '" +
                              (test::source_dir() / "schemas/build.xsd").string() + "' '" +
                              (folder / "1/build.xml").string() + "' >/dev/null 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

TEST(Mixer, ChangedFractionsChangeTheChecksum) {
  const GradedScene scene(0.5);
  const test::TemporaryFolder folder;
  const auto store = make_store_sink(folder / "b");
  (void)scene.slice_into(*store);
  const std::string text = test::read_file(folder / "b/build.xml");
  for (const char* name : {" knots=\"", " fractions=\"", " graded_segments=\""}) {
    std::string changed = text;
    const std::size_t at = changed.find(name, changed.find("<layers")) + std::string(name).size();
    changed[at] = changed[at] == '9' ? '8' : '9';
    test::write_file(folder / "b/build.xml", changed);
    EXPECT_THROW(for (std::uint32_t k = 0; k < 20; ++k)(void) StoreReader(folder / "b").read_layer(k), InputError);
  }
}

TEST(Mixer, FaultsOfMixturesAreFound) {
  const GradedScene scene(0.5, false);
  test::CollectingSink sink;
  (void)scene.slice_into(sink);
  const Layer good = sink.layers[8];
  const LayerLimits limits =
      make_layer_limits(scene.plan.grid.size[1], scene.table.materials, scene.scene.solids.size());
  EXPECT_EQ(find_layer_fault(good, limits), std::nullopt);
  const auto fault_of = [&](const std::function<void(Mixtures&)>& change) {
    Layer layer = good;
    change(layer.raster.mixtures);
    return find_layer_fault(layer, limits);
  };
  EXPECT_TRUE(fault_of([](Mixtures& m) { m.clear(); }));
  EXPECT_TRUE(fault_of([](Mixtures& m) { m.fraction[3] += 0.1F; }));
  EXPECT_TRUE(fault_of([](Mixtures& m) { m.fraction[3] = std::nanf(""); }));
  EXPECT_TRUE(fault_of([](Mixtures& m) { m.fraction[0] = -m.fraction[0] - 1.0F; }));
  EXPECT_TRUE(fault_of([](Mixtures& m) { m.x[5] = std::nan(""); }));
  EXPECT_TRUE(fault_of([](Mixtures& m) { m.x[5] += 100.0; }));
  EXPECT_TRUE(fault_of([](Mixtures& m) { m.segment[2] += 1; }));
  EXPECT_TRUE(fault_of([](Mixtures& m) { m.segment.back() = 1ULL << 40; }));
  EXPECT_TRUE(fault_of([](Mixtures& m) { m.knot_start[2] = 1ULL << 40; }));
  EXPECT_TRUE(fault_of([](Mixtures& m) { m.fraction_start[2] += 1; }));
  EXPECT_TRUE(fault_of([](Mixtures& m) { m.fraction_start.pop_back(); }));
}

}  // namespace
}  // namespace lamella
