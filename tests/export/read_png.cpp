#include "tests/export/read_png.h"

#include <cstdio>
#include <memory>
#include <png.h>
#include <stdexcept>

namespace lamella::test {

namespace {

void throw_error(png_structp, png_const_charp message) { throw std::runtime_error(message); }

void read_palette(png_structp png, png_infop info, PngPicture& picture) {
  png_colorp colors = nullptr;
  int count = 0;
  if (png_get_PLTE(png, info, &colors, &count) != 0) {
    for (int i = 0; i < count; ++i) picture.palette.push_back({colors[i].red, colors[i].green, colors[i].blue});
  }
  png_bytep alpha = nullptr;
  png_color_16p ignored = nullptr;
  int alphas = 0;
  if (png_get_tRNS(png, info, &alpha, &alphas, &ignored) != 0) picture.alpha.assign(alpha, alpha + alphas);
}

}  // namespace

PngPicture read_png(const std::filesystem::path& file) {
  const std::unique_ptr<std::FILE, decltype(&std::fclose)> stream(std::fopen(file.c_str(), "rb"), &std::fclose);
  if (!stream) throw std::runtime_error("can't open " + file.string());
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, throw_error, throw_error);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, stream.get());
  png_read_info(png, info);

  PngPicture picture;
  picture.width = png_get_image_width(png, info);
  picture.height = png_get_image_height(png, info);
  picture.bits = png_get_bit_depth(png, info);
  picture.color_type = png_get_color_type(png, info);
  int unit = 0;
  png_get_pHYs(png, info, &picture.pixels_per_metre[0], &picture.pixels_per_metre[1], &unit);
  if (unit != PNG_RESOLUTION_METER) throw std::runtime_error("pHYs is missing or not in metres");
  read_palette(png, info, picture);

  png_set_packing(png);
  png_read_update_info(png, info);
  const auto row_bytes = static_cast<std::int64_t>(png_get_rowbytes(png, info));
  picture.pixels.resize(static_cast<std::size_t>(row_bytes * picture.height));
  for (std::int64_t row = 0; row < picture.height; ++row) {
    png_read_row(png, picture.pixels.data() + row * row_bytes, nullptr);
  }
  png_read_end(png, nullptr);
  png_destroy_read_struct(&png, &info, nullptr);
  return picture;
}

}  // namespace lamella::test
