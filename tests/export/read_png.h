#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace lamella::test {

/// A PNG as libpng, which shares no code with the writer, reads it.
struct PngPicture {
  std::int64_t width = 0;
  std::int64_t height = 0;
  int bits = 0;
  int color_type = 0;
  std::array<std::uint32_t, 2> pixels_per_metre{};
  std::vector<std::array<std::uint8_t, 3>> palette;
  std::vector<std::uint8_t> alpha;   ///< tRNS of the palette
  std::vector<std::uint8_t> pixels;  ///< unpacked, row 0 at the top; of 16 bits the high byte first

  [[nodiscard]] int at(std::int64_t column, std::int64_t row) const {
    return pixels[static_cast<std::size_t>(row * width + column)];
  }
  /// Of pictures of 16 bits.
  [[nodiscard]] int at16(std::int64_t column, std::int64_t row) const {
    const auto at = static_cast<std::size_t>(2 * (row * width + column));
    return 256 * pixels[at] + pixels[at + 1];
  }
};

/// Throws std::runtime_error when the file isn't a sound PNG.
[[nodiscard]] PngPicture read_png(const std::filesystem::path& file);

}  // namespace lamella::test
