#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numeric>

#include "model/measure.h"
#include "model/step/read_step.h"
#include "slicing/span/span_engine.h"
#include "tests/support/corpus.h"

namespace lamella {
namespace {

constexpr std::size_t kLayers = 24;
constexpr std::size_t kRows = 400;

std::filesystem::path bench_dir() { return test::source_dir().parent_path() / "shared" / "bench"; }

/// Closed solids only: what is open is named before slicing.
std::vector<SolidId> closed_solids(const Scene& scene) {
  std::vector<SolidId> solids;
  for (const SolidId id : scene.solids.ids()) {
    if (scene.solids[id].info.closed && scene.solids[id].info.status == SolidStatus::ok) solids.push_back(id);
  }
  return solids;
}

std::vector<double> layer_heights(const Box3& bounds) {
  std::vector<double> heights;
  for (std::size_t k = 0; k < kLayers; ++k) {
    heights.push_back(bounds.min().z() + bounds.sizes().z() * (static_cast<double>(k) + 0.5) / kLayers);
  }
  return heights;
}

RowLattice rows_over(const Box3& bounds, double angle) {
  RowLattice lattice;
  lattice.along = Vec2(std::cos(angle), std::sin(angle));
  lattice.across = Vec2(-std::sin(angle), std::cos(angle));
  double lo = std::numeric_limits<double>::infinity();
  double hi = -lo;
  for (int i = 0; i < 4; ++i) {
    const double at = lattice.across.dot(bounds.corner(static_cast<Box3::CornerType>(i)).head<2>());
    lo = std::min(lo, at);
    hi = std::max(hi, at);
  }
  lattice.anchor = lo;
  lattice.spacing = (hi - lo) / kRows;
  lattice.last_row = kRows;
  return lattice;
}

double polygon_length(const SectionLoop& loop) {
  double sum = 0.0;
  for (std::size_t i = 0; i < loop.points.size(); ++i) {
    sum += (loop.points[(i + 1) % loop.points.size()] - loop.points[i]).norm();
  }
  return sum;
}

/// Every loop closes and has a sense that fits its nesting.
void check_loops(const SectionContours& contours, const std::string& where) {
  EXPECT_TRUE(contours.open.empty()) << where;
  for (const Finding& finding : contours.findings) ADD_FAILURE() << where << ": " << finding.what;
  double sum = 0.0;
  for (const SectionLoop& loop : contours.loops) {
    sum += loop.area;
    EXPECT_GE(loop.points.size(), 3u) << where;
    // Loops within the tolerance of nothing may have either sense.
    if (std::abs(loop.area) < 1e-4 * polygon_length(loop)) continue;
    EXPECT_TRUE(loop.parent >= 0 || loop.area > 0.0) << where << ": a hole of " << loop.area << " mm^2 in nothing";
  }
  EXPECT_NEAR(sum, contours.area, 1e-9 * (1.0 + contours.area)) << where;
}

/// The midpoint rule is off by at most half a step times the variation of what it sums: along z that of the areas is at
/// most the integral of |n_z| over the surface, along y that of the widths at most the length of the loops.
void check_volume(const SpanEngine& engine, SolidId solid, const SolidMeasure& measure, const std::string& where) {
  const std::vector<double> heights = layer_heights(measure.bounds);
  const std::vector<double> areas = engine.section_areas(solid, heights);
  const double step = measure.bounds.sizes().z() / kLayers;
  const double volume = step * std::accumulate(areas.begin(), areas.end(), 0.0);
  EXPECT_NEAR(volume, measure.volume, 0.5 * step * 1.01 * measure.abs_normal_area.z()) << where;
}

void check_rows(const SpanEngine& engine, const std::vector<SectionContours>& layers, const Box3& bounds,
                const std::string& where) {
  const RowLattice lattice = rows_over(bounds, 0.3);
  std::vector<LayerRequest> requests;
  for (std::size_t k = 0; k < layers.size(); ++k) requests.push_back({k, layers[k].z, {lattice}});
  std::vector<LayerSpans> out(requests.size());
  engine.cut(requests, out);
  for (std::size_t k = 0; k < layers.size(); ++k) {
    double sum = 0.0;
    for (const Span& span : out[k].lattices[0].spans) sum += (span.end - span.begin) * lattice.spacing;
    double length = 0.0;
    for (const SectionLoop& loop : layers[k].loops) length += polygon_length(loop);
    EXPECT_NEAR(sum, layers[k].area, 0.5 * lattice.spacing * length + 1e-9) << where << " z " << layers[k].z;
  }
}

void check_file(const std::filesystem::path& path) {
  const Scene scene = read_step(std::span(&path, 1));
  const std::vector<SolidId> solids = closed_solids(scene);
  ASSERT_FALSE(solids.empty());
  std::size_t loops = 0;
  for (const SolidId solid : solids) {
    const std::string where = scene.solids[solid].info.path;
    const SolidMeasure measure = measure_solid(scene, solid, 1e-6);
    const SpanEngine engine(scene, std::span(&solid, 1), {});
    check_volume(engine, solid, measure, where);
    const std::vector<double> heights = layer_heights(measure.bounds);
    const double chord_error = 1e-3 * measure.bounds.diagonal().norm();
    const std::vector<SectionContours> layers = engine.contours(solid, heights, chord_error);
    for (const SectionContours& layer : layers) {
      check_loops(layer, where + " z " + std::to_string(layer.z));
      loops += layer.loops.size();
    }
    check_rows(engine, layers, measure.bounds, where);
  }
  EXPECT_GT(loops, 0u);
}

class CorpusContours : public testing::TestWithParam<test::CorpusFile> {};

TEST_P(CorpusContours, CloseAndAddUpToTheVolume) { check_file(GetParam().path()); }

INSTANTIATE_TEST_SUITE_P(Good, CorpusContours, testing::ValuesIn(test::corpus_files("ok")),
                         [](const auto& file) { return test::test_name(file.param); });
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(CorpusContours);

TEST(CorpusContoursThere, OrSkipped) { LAMELLA_NEEDS_CORPUS(); }

class BenchContours : public testing::TestWithParam<std::string> {};

TEST_P(BenchContours, CloseAndAddUpToTheVolume) {
  const std::filesystem::path path = bench_dir() / (GetParam() + ".step");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no bench model at " << path;
  check_file(path);
}

INSTANTIATE_TEST_SUITE_P(All, BenchContours,
                         testing::Values("analytic_assembly", "impeller", "knot_tube", "wavy_block"),
                         [](const auto& name) { return name.param; });

}  // namespace
}  // namespace lamella
