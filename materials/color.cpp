#include "materials/color.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>

namespace lamella {

namespace {

struct NamedColor {
  std::uint32_t rgb;
  const char* word;
};

constexpr std::array kNamedColors{
    NamedColor{0x000000, "black"},      NamedColor{0x404040, "dark grey"},  NamedColor{0x808080, "grey"},
    NamedColor{0xC0C0C0, "light grey"}, NamedColor{0xFFFFFF, "white"},      NamedColor{0xFF0000, "red"},
    NamedColor{0x8B0000, "dark red"},   NamedColor{0xFF8080, "light red"},  NamedColor{0xFFC0CB, "pink"},
    NamedColor{0xFFA500, "orange"},     NamedColor{0xA0522D, "brown"},      NamedColor{0x654321, "dark brown"},
    NamedColor{0xD2B48C, "tan"},        NamedColor{0xFFD700, "gold"},       NamedColor{0xFFFF00, "yellow"},
    NamedColor{0xFFFFC0, "cream"},      NamedColor{0x808000, "olive"},      NamedColor{0x00FF00, "lime"},
    NamedColor{0x008000, "green"},      NamedColor{0x004000, "dark green"}, NamedColor{0x90EE90, "light green"},
    NamedColor{0x008080, "teal"},       NamedColor{0x00FFFF, "cyan"},       NamedColor{0x87CEEB, "sky blue"},
    NamedColor{0x4682B4, "steel blue"}, NamedColor{0x0000FF, "blue"},       NamedColor{0x000080, "navy"},
    NamedColor{0x8080FF, "light blue"}, NamedColor{0x800080, "purple"},     NamedColor{0xEE82EE, "violet"},
    NamedColor{0xFF00FF, "magenta"},
};

/// Colours for up to eight materials that people with colour-blindness tell apart too (Okabe and Ito, 2008).
constexpr std::array<std::uint32_t, 8> kPalette{0xE69F00, 0x56B4E9, 0x009E73, 0xF0E442,
                                                0x0072B2, 0xD55E00, 0xCC79A7, 0x999999};

Color from_rgb(std::uint32_t rgb) { return {(rgb >> 16) / 255.0, ((rgb >> 8) & 0xFFu) / 255.0, (rgb & 0xFFu) / 255.0}; }

long to_byte(double component) {
  if (!(component > 0.0)) return 0;  // NaN too
  return std::lround(std::min(component, 1.0) * 255.0);
}

/// Squared distance with the weights of the eye's sensitivity to red, green and blue.
double distance(const Color& a, const Color& b) {
  constexpr std::array<double, 3> kWeights{2.0, 4.0, 3.0};
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i) sum += kWeights[i] * (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

/// Hue in turns, saturation and value in [0, 1] (Smith, 1978).
Color from_hsv(double hue, double saturation, double value) {
  Color color{};
  constexpr std::array<double, 3> kShift{5.0, 3.0, 1.0};
  for (std::size_t i = 0; i < 3; ++i) {
    const double k = std::fmod(kShift[i] + 6.0 * hue, 6.0);
    color[i] = value * (1.0 - saturation * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0));
  }
  return color;
}

}  // namespace

std::optional<Color> parse_color(std::string_view text) {
  if (text.size() != 7 || text.front() != '#') return std::nullopt;
  std::uint32_t rgb = 0;
  const auto [end, failure] = std::from_chars(text.data() + 1, text.data() + 7, rgb, 16);
  if (failure != std::errc{} || end != text.data() + 7) return std::nullopt;
  return from_rgb(rgb);
}

std::string format_color(const Color& color) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string out = "#";
  for (const double component : color) {
    const auto byte = static_cast<std::size_t>(to_byte(component));
    out += kDigits[byte / 16];
    out += kDigits[byte % 16];
  }
  return out;
}

bool same_color(const Color& a, const Color& b) { return format_color(a) == format_color(b); }

std::string color_word(const Color& color) {
  const char* best = "";
  double nearest = std::numeric_limits<double>::infinity();
  for (const NamedColor& named : kNamedColors) {
    const double d = distance(color, from_rgb(named.rgb));
    if (d >= nearest) continue;
    nearest = d;
    best = named.word;
  }
  return best;
}

Color distinct_color(std::size_t index) {
  if (index < kPalette.size()) return from_rgb(kPalette[index]);
  const auto n = static_cast<double>(index - kPalette.size());
  // Steps of the golden section never come back close to an earlier hue soon.
  constexpr double kGolden = 0.61803398874989485;
  return from_hsv(std::fmod(n * kGolden, 1.0), n < 16 ? 0.75 : 0.45, index % 2 == 0 ? 0.85 : 0.6);
}

}  // namespace lamella
