#include "materials/color.h"

#include <gtest/gtest.h>
#include <limits>
#include <set>

namespace lamella {
namespace {

TEST(ColorText, ReadsSixHexadecimalDigitsAndNothingElse) {
  EXPECT_EQ(parse_color("#ff0080"), (Color{1.0, 0.0, 128.0 / 255.0}));
  EXPECT_EQ(parse_color("#FF0080"), parse_color("#ff0080"));
  for (const char* text :
       {"", "#", "red", "#ff008", "#ff00800", "ff0080", "#ff 080", "#-f0080", "#gg0000", "#0x1234"}) {
    EXPECT_FALSE(parse_color(text).has_value()) << text;
  }
}

TEST(ColorText, EveryByteSurvivesTheRoundTrip) {
  for (int byte = 0; byte < 256; ++byte) {
    const Color color{byte / 255.0, 0.0, 1.0};
    EXPECT_EQ(parse_color(format_color(color)), color);
  }
}

TEST(ColorText, OutOfRangeAndNanAreClamped) {
  EXPECT_EQ(format_color({-1.0, 2.0, std::numeric_limits<double>::quiet_NaN()}), "#00ff00");
}

TEST(ColorWord, NamesPlainColors) {
  EXPECT_EQ(color_word({1, 0, 0}), "red");
  EXPECT_EQ(color_word({0.02, 0.02, 0.02}), "black");
  EXPECT_EQ(color_word({0.5, 0.5, 0.5}), "grey");
  EXPECT_EQ(color_word({0.27, 0.5, 0.7}), "steel blue");
}

TEST(DistinctColors, DifferForHundredsOfMaterials) {
  std::set<std::string> seen;
  for (std::size_t i = 0; i < 300; ++i) seen.insert(format_color(distinct_color(i)));
  EXPECT_GT(seen.size(), 290U);
  EXPECT_EQ(format_color(distinct_color(8)), "#d93636");
}

}  // namespace
}  // namespace lamella
