#include <cmath>
#include <gtest/gtest.h>

#include "export/grey_png_stack.h"
#include "slicing/slicer.h"
#include "tests/export/read_png.h"
#include "tests/support/command.h"
#include "tests/support/layers.h"
#include "tests/support/solids.h"

namespace lamella::test {
namespace {

Grid small_grid() {
  Grid grid;
  grid.origin = {-3.1, 20.0, 0.7};
  grid.pitch = {0.04, 0.08, 0.027};
  grid.size = {53, 21, 4};
  return grid;
}

/// The part of pixel i that segments of a material cover: a sum over all segments of the row.
double covered_part(const Layer& layer, const Grid& grid, std::int64_t i, std::int64_t j, int material) {
  const long double left = grid.origin.x() + static_cast<long double>(i) * grid.pitch.x();
  const long double right = left + grid.pitch.x();
  long double sum = 0.0L;
  for (const Segment& segment : layer.raster.row(static_cast<std::size_t>(j))) {
    if (segment.material.value() != static_cast<std::size_t>(material)) continue;
    const long double width =
        std::min<long double>(right, segment.x_end) - std::max<long double>(left, segment.x_begin);
    sum += std::max(width, 0.0L);
  }
  return static_cast<double>(sum / (right - left));
}

TEST(PngCoverage, EachPixelIsThePartOfItsWidthThatTheMaterialCovers) {
  const TemporaryFolder folder;
  const BuildInfo info = make_build(small_grid(), {"steel", "rubber"});
  std::mt19937 random(12);
  std::vector<Layer> layers;
  for (std::int64_t k = 0; k < 4; ++k) layers.push_back(random_layer(info, k, random));
  // Two slivers in one pixel, an empty segment, one beyond the grid and one over all of a row.
  const double p = info.plan.grid.pitch.x();
  const double x = info.plan.grid.origin.x() + 5 * p;
  Layer slivers = make_layer(info, 3);
  for (const auto& [begin, end] : std::vector<std::pair<double, double>>{{x - 90 * p, x - 80 * p},
                                                                         {x + 0.1 * p, x + 0.25 * p},
                                                                         {x + 0.5 * p, x + 0.5 * p},
                                                                         {x + 0.9 * p, x + 1.2 * p}})
    slivers.raster.segments.push_back({begin, end, MaterialId{0}, SolidId{0}});
  end_row(slivers.raster);
  slivers.raster.segments.push_back({x - 90 * p, x + 900 * p, MaterialId{1}, SolidId{1}});
  while (slivers.raster.rows() < 21) end_row(slivers.raster);
  layers[3] = slivers;
  for (const int bits : {8, 16}) {
    feed(*make_coverage_png_sink(folder / "out", bits), info, layers);
    const double white = bits == 8 ? 255.0 : 65535.0;
    std::int64_t between = 0;
    for (const Layer& layer : layers) {
      for (int m = 0; m < 2; ++m) {
        const auto file =
            folder / "out" / (m == 0 ? "steel" : "rubber") / ("layer_00000" + std::to_string(layer.index) + ".png");
        const PngPicture picture = read_png(file);
        ASSERT_EQ(picture.bits, bits);
        for (std::int64_t j = 0; j < 21; ++j) {
          for (std::int64_t i = 0; i < 53; ++i) {
            const int value = bits == 8 ? picture.at(i, 20 - j) : picture.at16(i, 20 - j);
            const double expected = white * covered_part(layer, info.plan.grid, i, j, m);
            ASSERT_NEAR(value, expected, 0.5 + 1e-6 * white) << i << ' ' << j << ' ' << layer.index;
            between += value > 0 && value < white ? 1 : 0;
          }
        }
      }
    }
    EXPECT_GT(between, 500);
    const PngPicture last = read_png(folder / "out/steel/layer_000003.png");
    EXPECT_EQ(bits == 8 ? last.at(5, 20) : last.at16(5, 20), bits == 8 ? 64 : 16384);  // 0.15 + 0.1
  }
  const CommandResult check = run_command("pngcheck " + quoted(folder / "out") + "/*/*.png");
  EXPECT_EQ(check.exit_code, 0) << check.output;
}

/// Sum of a stack's shares times a pixel's area, mm^2.
double covered_area(const std::filesystem::path& file, const Grid& grid) {
  const PngPicture picture = read_png(file);
  double sum = 0.0;
  for (std::int64_t j = 0; j < grid.size[1]; ++j)
    for (std::int64_t i = 0; i < grid.size[0]; ++i) sum += picture.at16(i, j);
  return sum / 65535.0 * grid.pitch.x() * grid.pitch.y();
}

/// Slices the tilted box and the cylinder of the test solids at one height, `lines` to a row of pixels.
double largest_area_error(int lines) {
  Scene scene;
  const auto tilted = Placement::turned(Vec3(0, 0, 1), 0.3, Vec3(0.013, 0.027, 0));
  add_box(scene, Vec3(-4, -3, -2), Vec3(4, 3, 2), {tilted, "box", "", {}});
  add_cylinder(scene, 2.7, 4.0, {Placement::turned(Vec3(0, 0, 1), 0.0, Vec3(20.1, 0.4, -2)), "rod", "", {}});
  const auto measures = measure_solids(scene);
  MaterialTable table;
  Box3 bounds;
  for (const SolidId solid : scene.solids.ids()) {
    table.materials.push_back({"m" + std::to_string(solid.value()), 1.0, {}});
    table.assignments.push_back({MaterialId{solid.value()}, 0, ""});
    bounds.extend(measures[solid].bounds);
  }
  PlanOptions options;
  options.pitch = Vec2(0.4, 0.7);
  options.layer_height = 4.0;
  options.sub_rows = lines > 1 ? lines : 0;
  const LayerPlan plan = plan_layers(bounds, options);
  const TemporaryFolder folder;
  const auto sink = make_coverage_png_sink(folder / "out", 16);
  (void)slice(scene, table, measures, plan, {}, *sink);
  const double box = covered_area(folder / "out/m0/layer_000000.png", plan.grid);
  const double rod = covered_area(folder / "out/m1/layer_000000.png", plan.grid);
  return std::max(std::abs(box - 48.0), std::abs(rod - kPi * 2.7 * 2.7));
}

TEST(PngCoverage, SumsToTheSectionsAreaTheCloserTheMoreLinesARowHas) {
  // Midpoint sums of lines: the error of a tilted side is of order 1 / lines^2, that of a circle's top 1 / lines^1.5.
  const double one = largest_area_error(1);
  const double four = largest_area_error(4);
  const double sixteen = largest_area_error(16);
  const double most = largest_area_error(64);
  EXPECT_GT(one, 0.02);
  EXPECT_LT(four, 0.3 * one);
  EXPECT_LT(sixteen, 0.3 * four);
  EXPECT_LT(most, 0.002);  // grey has 65535 steps: 800 pixels' rounding and 1 / 64^1.5
}

}  // namespace
}  // namespace lamella::test
