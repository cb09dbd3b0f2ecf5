#include "export/raster_row.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace lamella::test {
namespace {

Grid row_grid(double origin, double pitch, std::int64_t size) {
  Grid grid;
  grid.origin.x() = origin;
  grid.pitch.x() = pitch;
  grid.size = {size, 1, 1};
  return grid;
}

Segment segment(double begin, double end) { return {begin, end, MaterialId{0}, SolidId{0}}; }

/// The definition, pixel by pixel.
PixelRun slow_pixels_of(const Segment& s, const Grid& grid) {
  PixelRun run{grid.size[0], grid.size[0]};
  for (std::int64_t i = grid.size[0] - 1; i >= 0; --i) {
    const double centre = grid.origin.x() + (static_cast<double>(i) + 0.5) * grid.pitch.x();
    if (centre >= s.x_begin) run.begin = i;
    if (centre >= s.x_end) run.end = i;
  }
  return run;
}

TEST(RasterRow, TakesThePixelsWhoseCentresLieInside) {
  const Grid grid = row_grid(0.0, 1.0, 10);
  EXPECT_EQ(pixels_of(segment(0.6, 3.6), grid), (PixelRun{1, 4}));
  EXPECT_EQ(pixels_of(segment(0.6, 1.4), grid).begin, pixels_of(segment(0.6, 1.4), grid).end);
}

TEST(RasterRow, IncludesTheBeginAndExcludesTheEnd) {
  const Grid grid = row_grid(0.0, 1.0, 10);
  EXPECT_EQ(pixels_of(segment(0.5, 3.5), grid), (PixelRun{0, 3}));
  EXPECT_EQ(pixels_of(segment(std::nextafter(0.5, 1.0), std::nextafter(3.5, 4.0)), grid), (PixelRun{1, 4}));
}

TEST(RasterRow, ClipsToTheGrid) {
  const Grid grid = row_grid(-5.0, 0.1, 100);
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(pixels_of(segment(-1e300, 1e300), grid), (PixelRun{0, 100}));
  EXPECT_EQ(pixels_of(segment(-infinity, infinity), grid), (PixelRun{0, 100}));
  EXPECT_EQ(pixels_of(segment(-9.0, -6.0), grid), (PixelRun{0, 0}));
  EXPECT_EQ(pixels_of(segment(6.0, 9.0), grid), (PixelRun{100, 100}));
}

TEST(RasterRow, TakesNothingFromBoundsThatAreNotNumbersOrInDisorder) {
  const Grid grid = row_grid(0.0, 1.0, 10);
  const double nan = std::nan("");
  for (const Segment& s : {segment(nan, 5.0), segment(0.0, nan), segment(nan, nan), segment(5.0, 1.0)}) {
    const PixelRun run = pixels_of(s, grid);
    EXPECT_EQ(run.begin, run.end);
  }
}

TEST(RasterRow, AgreesWithTheDefinitionOnRandomRows) {
  std::mt19937 random(7);
  for (const auto& [origin, pitch] :
       {std::pair{0.0, 0.1}, {-3.7, 1.0 / 3.0}, {1e6, 1e-3}, {-1e9, 1e-6}, {1e15, 0.05}, {3.0, 1e-300}}) {
    const Grid grid = row_grid(origin, pitch, 300);
    std::uniform_real_distribution<double> x(-10.0, 310.0);
    for (int trial = 0; trial < 2000; ++trial) {
      const double a = origin + x(random) * pitch;
      const double b = origin + x(random) * pitch;
      const Segment s = segment(std::min(a, b), std::max(a, b));
      if (s.x_begin == s.x_end) continue;
      ASSERT_EQ(pixels_of(s, grid), slow_pixels_of(s, grid)) << origin << ' ' << pitch << ' ' << a << ' ' << b;
    }
  }
}

TEST(RasterRow, DecidesRoundedCentresAsTheirDoublesCompare) {
  const Grid grid = row_grid(0.3, 0.1, 1000);
  for (std::int64_t i = 0; i < 1000; ++i) {
    const double centre = pixel_centre(0.3, 0.1, i);
    ASSERT_EQ(pixels_of(segment(centre, 1e9), grid).begin, i);
    ASSERT_EQ(pixels_of(segment(std::nextafter(centre, 1e9), 1e9), grid).begin, i + 1);
    ASSERT_EQ(pixels_of(segment(-1e9, centre), grid).end, i);
  }
}

TEST(RasterRow, TouchingSegmentsShareNoPixelAndLeaveNone) {
  std::mt19937 random(11);
  const Grid grid = row_grid(12345.678, 0.0173, 5000);
  std::uniform_real_distribution<double> step(0.0, 0.05);
  std::int64_t next = 0;
  for (double x = 12345.0; x < 12345.678 + 5000 * 0.0173;) {
    const double end = x + step(random);
    const PixelRun run = pixels_of(segment(x, end), grid);
    if (run.begin < run.end) {
      ASSERT_EQ(run.begin, next);
      next = run.end;
    }
    x = end;
  }
  EXPECT_EQ(next, 5000);
}

}  // namespace
}  // namespace lamella::test
