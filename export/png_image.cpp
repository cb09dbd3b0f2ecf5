#include "export/png_image.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <libdeflate.h>
#include <limits>
#include <string_view>

#include "core/error.h"
#include "export/byte_order.h"
#include "export/deflate_writer.h"

namespace lamella {

namespace {

constexpr std::uint64_t kMaxImageBytes = std::numeric_limits<std::int32_t>::max();

void put_chunk(std::string& out, std::string_view type, std::string_view data) {
  append_big_endian(out, static_cast<std::uint32_t>(data.size()));
  const std::size_t begin = out.size();
  out += type;
  out += data;
  append_big_endian(out, libdeflate_crc32(0, out.data() + begin, out.size() - begin));
}

std::string header(const PackedImage& image, bool indexed) {
  std::string data;
  append_big_endian(data, static_cast<std::uint32_t>(image.width()));
  append_big_endian(data, static_cast<std::uint32_t>(image.height()));
  const bool is_color = image.bits() == 32;
  data.push_back(static_cast<char>(is_color ? 8 : image.bits()));
  data.push_back(indexed ? 3 : is_color ? 6 : 0);  // colour type: palette, colour with alpha, or grey
  data.append(3, '\0');                            // deflate, adaptive filters, no interlace
  return data;
}

std::string physical_size(const PngStyle& style) {
  std::string data;
  append_big_endian(data, style.pixels_per_metre[0]);
  append_big_endian(data, style.pixels_per_metre[1]);
  data.push_back(1);  // the unit is the metre
  return data;
}

std::string palette_bytes(const std::vector<Color>& palette) {
  std::string data;
  for (const Color& color : palette) {
    for (double channel : color) {
      data.push_back(static_cast<char>(std::lround(std::clamp(channel, 0.0, 1.0) * 255.0)));
    }
  }
  return data;
}

}  // namespace

PackedImage::PackedImage(std::int64_t width, std::int64_t height, int bits)
    : width_(width), height_(height), bits_(bits), stride_((static_cast<std::size_t>(width) * bits + 7) / 8) {
  // Neither factor exceeds 2^31, so the product does not overflow.
  if ((stride_ + 1) * static_cast<std::uint64_t>(height) > kMaxImageBytes) {
    throw UsageError(
        "a layer of " + std::to_string(width) + " x " + std::to_string(height) + " pixels is too large for a PNG", "",
        "choose a coarser --pitch");
  }
  bytes_.resize((stride_ + 1) * static_cast<std::size_t>(height));
}

void PackedImage::set(std::int64_t row, std::int64_t column, unsigned value) {
  std::uint8_t* bytes = bytes_.data() + static_cast<std::size_t>(row) * (stride_ + 1) + 1;
  if (bits_ == 8) {
    bytes[column] = static_cast<std::uint8_t>(value);
    return;
  }
  bytes[2 * column] = static_cast<std::uint8_t>(value >> 8);
  bytes[2 * column + 1] = static_cast<std::uint8_t>(value);
}

void PackedImage::fill(std::int64_t row, std::int64_t begin, std::int64_t end, unsigned value) {
  if (begin >= end) return;
  if (bits_ == 32) return fill_colors(row, begin, end, value);
  // 1 / (2^bits - 1) of 255 times the value repeats it through the byte: 0x55 * 3 = 0xFF.
  const auto pattern = static_cast<std::uint8_t>(value * (255u / ((1u << bits_) - 1u)));
  std::uint8_t* bytes = bytes_.data() + static_cast<std::size_t>(row) * (stride_ + 1) + 1;
  const auto first_bit = static_cast<std::size_t>(begin) * bits_;
  const auto last_bit = static_cast<std::size_t>(end) * bits_;
  const auto blend = [&](std::size_t at, unsigned mask) {
    bytes[at] = static_cast<std::uint8_t>((bytes[at] & ~mask) | (pattern & mask));
  };
  const unsigned head = 0xFFu >> (first_bit % 8);
  const unsigned tail = ~(0xFFu >> (last_bit % 8)) & 0xFFu;
  const std::size_t first = first_bit / 8;
  const std::size_t last = last_bit / 8;
  if (first == last) return blend(first, head & tail);
  blend(first, head);
  std::memset(bytes + first + 1, pattern, last - first - 1);
  if (tail != 0) blend(last, tail);
}

void PackedImage::fill_colors(std::int64_t row, std::int64_t begin, std::int64_t end, unsigned value) {
  const std::array<std::uint8_t, 4> color = {static_cast<std::uint8_t>(value >> 24),
                                             static_cast<std::uint8_t>(value >> 16),
                                             static_cast<std::uint8_t>(value >> 8), static_cast<std::uint8_t>(value)};
  std::uint8_t* to = bytes_.data() + static_cast<std::size_t>(row) * (stride_ + 1) + 1 + 4 * begin;
  for (std::int64_t i = begin; i < end; ++i, to += 4) std::memcpy(to, color.data(), 4);
}

std::array<std::uint32_t, 2> pixels_per_metre(const Grid& grid) {
  const auto rounded = [](double pitch) {
    constexpr double kMax = std::numeric_limits<std::int32_t>::max();
    return static_cast<std::uint32_t>(std::clamp(std::round(1000.0 / pitch), 1.0, kMax));
  };
  return {rounded(grid.pitch.x()), rounded(grid.pitch.y())};
}

std::string encode_png(const PackedImage& image, const PngStyle& style) {
  const std::size_t pixel_bytes = std::max(1, image.bits() / 8);
  const std::string pixels = zlib_rows(image.bytes(), image.stride() + 1, pixel_bytes);
  std::string out("\x89PNG\r\n\x1A\n", 8);
  out.reserve(pixels.size() + 4096);
  put_chunk(out, "IHDR", header(image, !style.palette.empty()));
  put_chunk(out, "pHYs", physical_size(style));
  if (!style.palette.empty()) {
    put_chunk(out, "PLTE", palette_bytes(style.palette));
    put_chunk(out, "tRNS", std::string(1, '\0'));
  }
  put_chunk(out, "IDAT", pixels);
  put_chunk(out, "IEND", {});
  return out;
}

}  // namespace lamella
