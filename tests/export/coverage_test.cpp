#include <cmath>
#include <gtest/gtest.h>

#include "export/grey_png_stack.h"
#include "tests/export/read_png.h"
#include "tests/support/command.h"
#include "tests/support/layers.h"

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

}  // namespace
}  // namespace lamella::test
