#include "export/view_page.h"

#include <algorithm>
#include <fstream>
#include <gmock/gmock.h>
#include <iterator>
#include <random>

#include "core/error.h"
#include "export/raster_row.h"
#include "export/view_chunk.h"
#include "tests/support/layers.h"
#include "tests/support/paths.h"

namespace lamella::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Grid grid_of(double origin, double pitch, std::int64_t width) {
  Grid grid;
  grid.origin = Vec3(origin, -1.0, 0.5);
  grid.pitch = Vec3(pitch, 0.5, 0.25);
  grid.size = {width, 4, 5};
  return grid;
}

std::int32_t code_of(const Grid& grid, double x) {
  return ViewScale(grid).code(x, pixels_of({x, HUGE_VAL, {}, {}}, grid).begin);
}

TEST(ViewScale, CodesLieOnTheSameSideOfEveryPixelsCentre) {
  std::mt19937_64 random(7);
  for (const Grid& grid :
       {grid_of(0.0, 0.1, 300), grid_of(-1234.567, 0.0423, 30000), grid_of(1e6, 1.0 / 3.0, 200000)}) {
    const std::int64_t one = std::int64_t{1} << ViewScale(grid).bits();
    std::uniform_int_distribution<std::int64_t> pixels(1, grid.size[0] - 2);
    for (int n = 0; n < 20000; ++n) {
      const std::int64_t i = pixels(random);
      const double centre = pixel_centre(grid.origin.x(), grid.pitch.x(), i);
      const double share = std::uniform_real_distribution(-0.6, 0.6)(random);
      for (const double x : {centre, std::nextafter(centre, -HUGE_VAL), std::nextafter(centre, HUGE_VAL),
                             centre + share * grid.pitch.x(), centre + 1e-9 * share}) {
        const std::int64_t code = code_of(grid, x);
        for (std::int64_t pixel = i - 1; pixel <= i + 1; ++pixel) {
          const bool lies_from = pixel_centre(grid.origin.x(), grid.pitch.x(), pixel) >= x;
          ASSERT_EQ(pixel * one >= code, lies_from) << x << " pixel " << pixel;
        }
      }
    }
  }
}

TEST(ViewScale, CodesAreOffByLessThanOneOfTheirUnits) {
  const Grid grid = grid_of(-3.0, 0.25, 1000);
  ASSERT_EQ(ViewScale(grid).bits(), 16);
  std::mt19937_64 random(8);
  for (int n = 0; n < 10000; ++n) {
    const double x = std::uniform_real_distribution(-3.0, 247.0)(random);
    EXPECT_NEAR(-3.0 + (code_of(grid, x) / 65536.0 + 0.5) * 0.25, x, 0.25 / 65536.0);
  }
}

TEST(HatchScale, CodesOfAllOfTheLatticeFitAndAreFine) {
  for (const double origin : {0.0, -3.0, 1e6}) {
    const Grid grid = grid_of(origin, 0.25, 1000);
    const HatchScale scale(grid);
    for (double angle = 0.0; angle < 6.3; angle += 0.37) {
      const Vec2 along(std::cos(angle), std::sin(angle));
      for (const Vec2& corner :
           {Vec2(origin, -1.0), Vec2(origin + 250.0, -1.0), Vec2(origin, 1.0), Vec2(origin + 250.0, 1.0)}) {
        const std::int64_t code = scale.code(corner.dot(along), along);
        EXPECT_LE(std::abs(code), std::int64_t{1} << 23);
        EXPECT_NEAR(static_cast<double>(code) * scale.unit + scale.centre.dot(along), corner.dot(along), 1e-5);
      }
    }
  }
}

TEST(ViewScale, WideLatticesHaveFewerBitsAndStillFit) {
  for (const std::int64_t width :
       {std::int64_t{1}, std::int64_t{32767}, std::int64_t{40000}, std::int64_t{0x7FFFFFFF}}) {
    const Grid grid = grid_of(0.0, 1.0, width);
    const int bits = ViewScale(grid).bits();
    EXPECT_GE(bits, 0);
    EXPECT_LE(std::ldexp(static_cast<double>(width), bits), 2147483648.0);
    // The lattice ends half a pixel behind its last centre.
    const std::int64_t half = bits > 0 ? std::int64_t{1} << (bits - 1) : 0;
    EXPECT_EQ(code_of(grid, static_cast<double>(width)), (width << bits) - half);
  }
  EXPECT_EQ(ViewScale(grid_of(0.0, 1.0, 32767)).bits(), 16);
  EXPECT_EQ(ViewScale(grid_of(0.0, 1.0, 40000)).bits(), 15);
}

class ViewPage : public ::testing::Test {
 protected:
  std::string write(const BuildInfo& info, std::uint32_t every, const std::vector<Layer>& layers) {
    const auto sink = make_view_sink(folder_ / "view.html", {.every = every});
    sink->begin(info);
    for (const Layer& layer : layers) sink->write(layer);
    SliceReport report;
    for (std::size_t m = 0; m < info.materials.size(); ++m) report.materials.push_back({});
    for (std::size_t s = 0; s < info.solids.size(); ++s) report.solids.push_back({});
    sink->finish(report);
    std::ifstream stream(folder_ / "view.html", std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  static std::vector<Layer> layers_of(const BuildInfo& info) {
    std::vector<Layer> layers;
    for (std::int64_t k = 0; k < info.plan.grid.size[2]; ++k) {
      layers.push_back(
          layer_of_labels(info, k, [](auto i, auto j, auto) { return static_cast<int>((i + j) % 3) - 1; }));
    }
    return layers;
  }

  TemporaryFolder folder_;
};

TEST_F(ViewPage, NamesCantEndItsScripts) {
  const BuildInfo info = make_build(grid_of(0.0, 0.1, 8), {"</script><b>\"\\\n", "b"});
  const std::string page = write(info, 1, layers_of(info));
  EXPECT_THAT(page, Not(HasSubstr("</script><b>")));
  EXPECT_THAT(page, HasSubstr("\\u003c/script>\\u003cb>\\u0022\\u005c\\u000a"));
}

TEST_F(ViewPage, TheSameLayersGiveTheSameBytes) {
  const BuildInfo info = make_build(grid_of(0.0, 0.1, 8), {"a", "b"});
  EXPECT_EQ(write(info, 1, layers_of(info)), write(info, 1, layers_of(info)));
}

TEST_F(ViewPage, HasTheRotationOfABuildThatWasTurned) {
  BuildInfo info = make_build(grid_of(0.0, 0.1, 8), {"a", "b"});
  EXPECT_THAT(write(info, 1, layers_of(info)), Not(HasSubstr("\"rotation\"")));
  info.turn = Mat3{{0.0, 0.0, 1.0}, {0.6, 0.8, 0.0}, {-0.8, 0.6, 0.0}};
  EXPECT_THAT(write(info, 1, layers_of(info)), HasSubstr("\"rotation\":[[0,0,1],[0.6,0.8,0],[-0.8,0.6,0]]"));
}

TEST_F(ViewPage, EveryNthLayerOnly) {
  const BuildInfo info = make_build(grid_of(0.0, 0.1, 8), {"a", "b"});
  EXPECT_THAT(write(info, 2, layers_of(info)), HasSubstr("\"planned\":5,\"index\":[0,2,4]"));
  EXPECT_THROW((void)make_view_sink(folder_ / "x.html", {.every = 0}), UsageError);
}

TEST_F(ViewPage, TooManyRowsAreRefusedWithAHintAndLeaveNothing) {
  Grid grid = grid_of(0.0, 0.1, 8);
  grid.size = {8, 4'000'000, 11};
  const BuildInfo info = make_build(grid, {"a"});
  const auto sink = make_view_sink(folder_ / "view.html");
  sink->begin(info);
  for (std::int64_t k = 0; k < 11; ++k) {
    Layer layer = make_layer(info, k);
    layer.raster.row_start.assign(4'000'001, 0);
    if (k < 10) {
      sink->write(layer);
      continue;
    }
    try {
      sink->write(layer);
      FAIL() << "no limit";
    } catch (const UsageError& error) {
      EXPECT_THAT(error.hint(), HasSubstr("--every"));
    }
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "view.html"));
}

}  // namespace
}  // namespace lamella::test
