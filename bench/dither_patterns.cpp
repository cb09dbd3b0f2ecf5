// Writes what ways of dithering make of constant fractions of two materials, for plot_dither.py: a file
// METHOD_PERCENT.raw each, 128 x 128 x 128 bytes of 0 or 1, x fastest, of voxels of 42 x 84 x 27 um.

#include <algorithm>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/error_diffusion.h"
#include "slicing/dither.h"

namespace lamella {
namespace {

constexpr std::size_t kSide = 128;
/// Voxels that error diffusion runs through before what is kept: its patterns take some rows to settle.
constexpr std::size_t kSettle = 64;

/// Fills out the row of voxels from (0, j, k) on.
using DitherRow = std::function<void(std::size_t j, std::size_t k, std::span<std::uint8_t> out)>;

void write(const std::filesystem::path& path, const DitherRow& dither) {
  std::ofstream file(path, std::ios::binary);
  std::vector<std::uint8_t> row(kSide);
  for (std::size_t k = 0; k < kSide; ++k) {
    for (std::size_t j = 0; j < kSide; ++j) {
      dither(j, k, row);
      file.write(reinterpret_cast<const char*>(row.data()), static_cast<std::streamsize>(row.size()));
    }
  }
  if (!file.flush()) throw std::runtime_error("can't write " + path.string());
}

DitherRow by_mask(const DitherMask& mask, float fraction) {
  std::vector<float> fractions(2 * kSide, fraction);
  std::fill_n(fractions.begin(), kSide, 1.0F - fraction);
  return [&mask, fractions](std::size_t j, std::size_t k, std::span<std::uint8_t> out) {
    dither_row(mask, {0, static_cast<std::int64_t>(j), static_cast<std::int64_t>(k)}, fractions, out);
  };
}

DitherRow by_chance(float fraction) {
  return [random = std::mt19937(7), fraction](std::size_t, std::size_t, std::span<std::uint8_t> out) mutable {
    for (std::uint8_t& m : out) m = static_cast<float>(random() >> 8U) / 16777216.0F < fraction ? 1 : 0;
  };
}

/// Layers of error diffusion, each kSettle voxels larger on all sides than what is kept.
class DiffusedLayers {
 public:
  DiffusedLayers(float fraction, float upward) : fraction_(fraction), peer_(kAll, kAll, upward) {
    for (std::size_t k = 0; k < kSettle; ++k) make_next();
  }

  /// The first row's fractions have no order, or all layers would be alike.
  void make_next() {
    std::vector<float> fractions(kAll);
    for (float& f : fractions) f = static_cast<float>(random_() >> 8U) / 16777216.0F;
    for (std::size_t j = 0; j < kAll; ++j) {
      peer_.dither_row(j, fractions, std::span(layer_).subspan(j * kAll, kAll));
      fractions.assign(kAll, fraction_);
    }
    peer_.end_layer();
  }
  void copy_row(std::size_t j, std::span<std::uint8_t> out) const {
    std::copy_n(layer_.begin() + static_cast<std::ptrdiff_t>((j + kSettle) * kAll + kSettle), kSide, out.begin());
  }

 private:
  static constexpr std::size_t kAll = kSide + 2 * kSettle;
  float fraction_;
  ErrorDiffusion peer_;
  std::mt19937 random_{7};
  std::vector<std::uint8_t> layer_ = std::vector<std::uint8_t>(kAll * kAll);
};

DitherRow by_diffusion(float fraction, float upward) {
  return [layers = DiffusedLayers(fraction, upward)](std::size_t j, std::size_t, std::span<std::uint8_t> out) mutable {
    if (j == 0) layers.make_next();
    layers.copy_row(j, out);
  };
}

std::filesystem::path name_file(const std::filesystem::path& folder, std::string method, int percent) {
  return folder / method.append("_").append(std::to_string(percent)).append(".raw");
}

void write_all(const std::filesystem::path& folder) {
  const DitherMask mask(Vec3(0.042, 0.084, 0.027));
  for (const int percent : {50, 25, 10}) {
    const float fraction = static_cast<float>(percent) / 100.0F;
    write(name_file(folder, "mask", percent), by_mask(mask, fraction));
    write(name_file(folder, "white", percent), by_chance(fraction));
    write(name_file(folder, "diffusion", percent), by_diffusion(fraction, 0.0F));
    write(name_file(folder, "diffusion3", percent), by_diffusion(fraction, 1.0F / 3.0F));
  }
}

}  // namespace
}  // namespace lamella

int main(int argc, char** argv) {
  try {
    if (argc != 2) throw std::invalid_argument("usage: dither_patterns FOLDER");
    lamella::write_all(argv[1]);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
