#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "slicing/dither_band.h"

namespace lamella::test {

inline constexpr int kSide = DitherMask::kSide;
inline constexpr int kVoxels = kSide * kSide * kSide;

/// Voxels of a material jetting printer, mm. Ranked once for all tests.
inline const DitherMask& printer_mask() {
  static const DitherMask mask(Vec3(0.042, 0.084, 0.027));
  return mask;
}

/// What dither_row() is to do, voxel by voxel and in double precision.
inline int choose(double threshold, const std::vector<double>& fractions) {
  double sum = 0.0;
  int chosen = -1;
  for (std::size_t m = 0; m < fractions.size(); ++m) {
    if (fractions[m] > 0.0 && sum <= threshold) chosen = static_cast<int>(m);
    sum += fractions[m];
  }
  return chosen;
}

/// Fractions of sum 1 that are multiples of 1/1024, so that sums are exact in floats too; some are 0.
inline std::vector<double> draw_fractions(std::size_t materials, std::mt19937& random) {
  std::vector<double> fractions(materials);
  int rest = 1024;
  for (std::size_t m = 0; m + 1 < materials; ++m) {
    const int part = random() % 3 == 0 ? 0 : static_cast<int>(random() % static_cast<unsigned>(rest + 1));
    fractions[m] = part / 1024.0;
    rest -= part;
  }
  fractions.back() = rest / 1024.0;
  return fractions;
}

/// Sets voxel n of a row of `count` voxels.
inline void set_voxel(std::vector<float>& row, std::size_t count, std::size_t n, const std::vector<double>& fractions) {
  for (std::size_t m = 0; m < fractions.size(); ++m) row[m * count + n] = static_cast<float>(fractions[m]);
}

using Field = std::function<std::vector<double>(const std::array<std::int64_t, 3>&)>;

/// Rows [16 band, 16 band + 16) of a layer, columns from i to i + count, of a field of `materials`.
inline void add_band(DitherBand& band, const VoxelIndex& first, std::size_t count, std::size_t materials,
                     const Field& field) {
  std::vector<float> row(materials * count);
  band.begin();
  for (std::int64_t j = first.j; j < first.j + DitherBand::kRows; ++j) {
    for (std::size_t n = 0; n < count; ++n) {
      set_voxel(row, count, n, field({first.i + static_cast<std::int64_t>(n), j, first.k}));
    }
    band.add(0, {first.i, j, first.k}, row, count);
  }
}

/// The greatest difference of any material between the mean of the field and that of the dithered voxels, over the
/// cube of one period that starts at `corner`. The field is there in all tiles that the cube meets.
inline double mean_error(const DitherMask& mask, const VoxelIndex& corner, std::size_t materials, const Field& field) {
  std::vector<double> error(materials, 0.0);
  DitherBand band(mask);
  const std::int64_t i_begin = DitherTile::tile_of(corner.i) * DitherTile::kSide;
  const auto count = static_cast<std::size_t>(3 * DitherTile::kSide);
  const auto skip = static_cast<std::size_t>(corner.i - i_begin);
  for (std::int64_t k = corner.k; k < corner.k + kSide; ++k) {
    std::int64_t j = DitherTile::tile_of(corner.j) * DitherTile::kSide;
    for (; j < corner.j + kSide; j += DitherBand::kRows) {
      add_band(band, {i_begin, j, k}, count, materials, field);
      band.settle();
      for (std::size_t run = 0; run < static_cast<std::size_t>(DitherBand::kRows); ++run) {
        const std::int64_t row = j + static_cast<std::int64_t>(run);
        if (row < corner.j || row >= corner.j + kSide) continue;
        for (const std::uint8_t m : band.chosen(run).subspan(skip, kSide)) error[m] += 1.0;
        for (int n = 0; n < kSide; ++n) {
          const std::vector<double> f = field({corner.i + n, row, k});
          for (std::size_t m = 0; m < materials; ++m) error[m] -= f[m];
        }
      }
    }
  }
  double worst = 0.0;
  for (const double e : error) worst = std::max(worst, std::abs(e) / kVoxels);
  return worst;
}

}  // namespace lamella::test
