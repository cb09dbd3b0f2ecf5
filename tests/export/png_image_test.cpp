#include "export/png_image.h"

#include <fstream>
#include <gtest/gtest.h>
#include <png.h>
#include <random>

#include "core/error.h"
#include "tests/export/read_png.h"
#include "tests/support/paths.h"

namespace lamella::test {
namespace {

PngPicture through_libpng(const PackedImage& image, const PngStyle& style) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.png", std::ios::binary) << encode_png(image, style);
  return read_png(folder / "a.png");
}

PngStyle style_with_palette(int colors) {
  PngStyle style{{1000, 2000}, {}};
  for (int i = 0; i < colors; ++i) style.palette.push_back({i / 255.0, 1.0 - i / 255.0, 0.5});
  return style;
}

TEST(PngImage, FillsRandomRunsAsPixelByPixelWouldAtEveryDepth) {
  std::mt19937 random(3);
  for (int bits : {1, 2, 4, 8}) {
    PackedImage image(123, 17, bits);
    std::vector<int> expected(123 * 17);
    for (int trial = 0; trial < 400; ++trial) {
      const auto row = std::uniform_int_distribution<std::int64_t>(0, 16)(random);
      const auto begin = std::uniform_int_distribution<std::int64_t>(0, 123)(random);
      const auto end = std::uniform_int_distribution<std::int64_t>(0, 123)(random);
      const auto value = std::uniform_int_distribution<unsigned>(0, (1u << bits) - 1)(random);
      image.fill(row, begin, end, value);
      for (std::int64_t i = begin; i < end; ++i) expected[row * 123 + i] = static_cast<int>(value);
    }
    const PngPicture picture = through_libpng(image, style_with_palette(1 << bits));
    ASSERT_EQ(picture.bits, bits);
    ASSERT_TRUE(std::equal(expected.begin(), expected.end(), picture.pixels.begin())) << bits;
  }
}

TEST(PngImage, StatesPixelsPerMetrePaletteAndTransparency) {
  PngStyle style = style_with_palette(3);
  style.palette[1] = {1.0, 0.5, -3.0};
  const PngPicture picture = through_libpng(PackedImage(5, 4, 2), style);
  EXPECT_EQ(picture.color_type, PNG_COLOR_TYPE_PALETTE);
  EXPECT_EQ(picture.pixels_per_metre, (std::array<std::uint32_t, 2>{1000, 2000}));
  ASSERT_EQ(picture.palette.size(), 3u);
  EXPECT_EQ(picture.palette[1], (std::array<std::uint8_t, 3>{255, 128, 0}));
  EXPECT_EQ(picture.alpha, std::vector<std::uint8_t>{0});
}

TEST(PngImage, IsGreyWithoutAPalette) {
  const PngPicture picture = through_libpng(PackedImage(5, 4, 1), {{1, 1}, {}});
  EXPECT_EQ(picture.color_type, PNG_COLOR_TYPE_GRAY);
  EXPECT_TRUE(picture.alpha.empty());
}

TEST(PngImage, StatesThePitchAsPixelsPerMetre) {
  Grid grid;
  grid.pitch = {25.4 / 600.0, 25.4 / 300.0, 0.027};
  EXPECT_EQ(pixels_per_metre(grid), (std::array<std::uint32_t, 2>{23622, 11811}));
  grid.pitch = {1e9, 1e-12, 1.0};
  EXPECT_EQ(pixels_per_metre(grid), (std::array<std::uint32_t, 2>{1, 2147483647}));
}

TEST(PngImage, RefusesAnImageOfTwoGibibytes) {
  EXPECT_THROW(PackedImage(2147483647, 2147483647, 8), UsageError);
  EXPECT_THROW(PackedImage(1 << 20, 1 << 14, 1), UsageError);
}

}  // namespace
}  // namespace lamella::test
