#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "model/scene.h"
#include "slicing/layer_plan.h"

namespace lamella {

/// Pixels of 1, 2, 4, 8, 16 or 32 bits, packed as PNG has them: the leftmost pixel in the highest bits, rows padded to
/// a byte. Row 0 is the top of the picture. All zero at first.
class PackedImage {
 public:
  /// Throws UsageError when the pixels would take 2 GiB or more.
  PackedImage(std::int64_t width, std::int64_t height, int bits);

  /// Gives one pixel of 8 or 16 bits its value.
  void set(std::int64_t row, std::int64_t column, unsigned value);

  /// Of up to 8 bits, or of 32. Gives pixels [begin, end) of `row` the value `value`, of 32 bits red in the
  /// highest and alpha in the lowest eight; work is proportional to bytes, not pixels.
  void fill(std::int64_t row, std::int64_t begin, std::int64_t end, unsigned value);

  [[nodiscard]] std::int64_t width() const { return width_; }
  [[nodiscard]] std::int64_t height() const { return height_; }
  [[nodiscard]] int bits() const { return bits_; }
  /// Height rows of one filter byte (0) and the row's bytes: PNG's own layout before compression.
  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }
  /// Bytes per row without the filter byte.
  [[nodiscard]] std::size_t stride() const { return stride_; }

 private:
  void fill_colors(std::int64_t row, std::int64_t begin, std::int64_t end, unsigned value);

  std::int64_t width_;
  std::int64_t height_;
  int bits_;
  std::size_t stride_;
  std::vector<std::uint8_t> bytes_;
};

/// What a PNG says besides its pixels.
struct PngStyle {
  /// Pixels per metre along x and y (chunk pHYs).
  std::array<std::uint32_t, 2> pixels_per_metre{};
  /// Colour per value; empty: greyscale, where the largest value is white. Not for pixels of 32 bits, which are
  /// colours.
  std::vector<Color> palette;
};

/// Pixels per metre of a grid's raster, rounded, at least 1.
[[nodiscard]] std::array<std::uint32_t, 2> pixels_per_metre(const Grid& grid);

/// The image as a PNG file (ISO/IEC 15948). With a palette value 0 is fully transparent (chunk tRNS). The same image
/// gives the same bytes.
[[nodiscard]] std::string encode_png(const PackedImage& image, const PngStyle& style);

}  // namespace lamella
