#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <stdexcept>
#include <thread>
#include <vector>

#include "tests/slicing/dither_fields.h"

namespace lamella::test {
namespace {

/// A layer's tile of random fractions that vary from voxel to voxel; some voxels may be missing.
struct RandomTile {
  std::size_t materials;
  TileIndex at;
  std::vector<std::vector<double>> fractions;  ///< by place; empty where there is no voxel
  DitherTile tile;

  RandomTile(std::mt19937& random, std::size_t count) : materials(count) {
    at = {static_cast<int>(random() % 9) - 4, static_cast<int>(random() % 9) - 4, static_cast<int>(random() % 99)};
    tile.clear(materials);
    const bool has_holes = random() % 2 == 0;
    for (std::size_t v = 0; v < DitherTile::kVoxels; ++v) {
      fractions.emplace_back();
      if (has_holes && random() % 4 == 0) continue;
      fractions.back() = draw_fractions(materials, random);
      for (std::size_t m = 0; m < materials; ++m) tile.fractions(m)[v] = static_cast<float>(fractions.back()[m]);
      tile.chosen()[v] = choose(threshold(v), fractions.back());
    }
  }
  [[nodiscard]] double threshold(std::size_t v) const {
    const auto place = static_cast<std::int64_t>(v);
    return printer_mask().threshold({at.column * DitherTile::kSide + place % DitherTile::kSide,
                                     at.row * DitherTile::kSide + place / DitherTile::kSide, at.layer});
  }
  /// Voxels of the materials before `border` that there should be, and are.
  [[nodiscard]] double wanted(std::size_t border) const {
    double sum = 0.0;
    for (const std::vector<double>& f : fractions) {
      for (std::size_t m = 0; m < std::min(border, f.size()); ++m) sum += f[m];
    }
    return sum;
  }
  [[nodiscard]] double counted(std::size_t border) {
    double sum = 0.0;
    for (const std::int32_t m : tile.chosen()) sum += m >= 0 && m < static_cast<std::int32_t>(border) ? 1.0 : 0.0;
    return sum;
  }
};

TEST(DitherTile, HasTheNumberOfVoxelsThatFractionsAddUpTo) {
  std::mt19937 random(31);
  int changed = 0;
  for (int round = 0; round < 300; ++round) {
    RandomTile random_tile(random, 2 + random() % 5);
    const auto before = random_tile.tile.chosen();
    random_tile.tile.settle(printer_mask(), random_tile.at);
    changed += before != random_tile.tile.chosen() ? 1 : 0;
    const TileIndex& at = random_tile.at;
    const double rounding = (printer_mask().rank_in_column({at.column, at.row, at.layer}) + 0.5) / kSide;
    for (std::size_t border = 1; border < random_tile.materials; ++border) {
      ASSERT_EQ(random_tile.counted(border), std::floor(random_tile.wanted(border) + rounding)) << "round " << round;
    }
    for (std::size_t v = 0; v < DitherTile::kVoxels; ++v) {
      const std::int32_t m = random_tile.tile.chosen()[v];
      const std::vector<double>& fractions = random_tile.fractions[v];
      ASSERT_EQ(m < 0, fractions.empty());
      if (m >= 0) {
        ASSERT_GT(fractions[static_cast<std::size_t>(m)], 0.0);
      }
    }
  }
  EXPECT_GT(changed, 290);
}

/// Over many tiles the rounding of their numbers adds up to nothing.
TEST(DitherTile, RoundsWithoutBias) {
  std::mt19937 random(37);
  double error = 0.0;
  for (int k = 0; k < kSide; ++k) {
    for (int row = 0; row < kSide; ++row) {
      RandomTile random_tile(random, 2);
      random_tile.at = {row / 7, row, k};
      random_tile.tile.settle(printer_mask(), random_tile.at);
      error += random_tile.counted(1) - random_tile.wanted(1);
    }
  }
  EXPECT_LT(std::abs(error), 0.03 * kSide * kSide);
}

/// The mask's planes are even already: settled, such gradients would be worse.
TEST(DitherTile, LeavesGradientsAlongAnAxisToTheMask) {
  DitherBand band(printer_mask());
  for (const std::array<double, 3>& slope :
       {std::array{0.0, 0.0, 0.01}, {0.01, 0.0, 0.01}, {0.0, 0.01, 0.01}, {0.01, 0.01, 0.0}}) {
    const Field ramp = [&](const auto& at) {
      double f = 0.1;
      for (std::size_t axis = 0; axis < 3; ++axis) f += slope[axis] * static_cast<double>(at[axis]);
      return std::vector{f / 2, f / 2, 1.0 - f};
    };
    int changed = 0;
    for (int k = 0; k < 16; ++k) {
      add_band(band, {0, 0, k}, 16, 3, ramp);
      std::vector<std::vector<std::uint8_t>> before;
      for (std::size_t run = 0; run < 16; ++run) before.emplace_back(band.chosen(run).begin(), band.chosen(run).end());
      band.settle();
      for (std::size_t run = 0; run < 16; ++run) {
        changed += std::equal(before[run].begin(), before[run].end(), band.chosen(run).begin()) ? 0 : 1;
      }
    }
    const bool is_oblique = slope[0] > 0.0 && slope[1] > 0.0;
    EXPECT_EQ(changed > 0, is_oblique) << slope[0] << ' ' << slope[1];
  }
}

/// Where fractions of 0 stand between a voxel's materials, and where hardly a voxel may change.
TEST(DitherTile, NeverGivesWhatIsNotThere) {
  std::mt19937 random(41);
  DitherBand band(printer_mask());
  for (int round = 0; round < 50; ++round) {
    const int only = static_cast<int>(random() % 16);
    const Field field = [&](const auto& at) {
      if (at[1] % 16 != only) return std::vector{0.0, 0.0, 0.0, 1.0};
      const double f = static_cast<double>(at[0] % 50) / 50.0;
      return std::vector{f, 0.0, 1.0 - f, 0.0};
    };
    add_band(band, {-16, 16, round}, 100, 4, field);
    band.settle();
    for (std::size_t run = 0; run < 16; ++run) {
      for (std::size_t n = 0; n < 100; ++n) {
        const auto place = static_cast<std::int64_t>(n) - 16;
        ASSERT_GT(field({place, 16 + static_cast<std::int64_t>(run), 0})[band.chosen(run)[n]], 0.0);
      }
    }
  }
}

/// However a row is cut into runs, in whatever order they come, and with another mixture between.
TEST(DitherBand, GivesTheSameHoweverRowsAreCut) {
  const Field field = [](const auto& at) {
    const double f = 0.5 + 0.4 * std::sin(0.05 * static_cast<double>(at[0]) + 0.09 * static_cast<double>(at[1]));
    return std::vector{1.0 - f, 0.25 * f, 0.75 * f};
  };
  constexpr std::size_t kCount = 130;
  DitherBand whole(printer_mask());
  add_band(whole, {-20, -32, 7}, kCount, 3, field);
  whole.settle();
  DitherBand parts(printer_mask());
  std::mt19937 random(43);
  for (int round = 0; round < 20; ++round) {
    parts.begin();
    std::vector<std::array<std::size_t, 3>> runs;  // number, row, first voxel
    for (std::size_t row = 16; row-- > 0;) {
      for (std::size_t n = 0; n < kCount;) {
        const std::size_t count = std::min<std::size_t>(kCount - n, 1 + random() % 40);
        std::vector<float> fractions(3 * count);
        const VoxelIndex first{static_cast<std::int64_t>(n) - 20, static_cast<std::int64_t>(row) - 32, 7};
        for (std::size_t v = 0; v < count; ++v) {
          set_voxel(fractions, count, v, field({first.i + static_cast<std::int64_t>(v), first.j, first.k}));
        }
        runs.push_back({parts.add(4, first, fractions, count), row, n});
        // Somewhere else, of another mixture.
        parts.add(9, {first.i + 1000, first.j, first.k}, std::vector<float>(2, 0.5F), 1);
        n += count;
      }
    }
    parts.settle();
    for (const auto& [number, row, begin] : runs) {
      const auto chosen = parts.chosen(number);
      ASSERT_TRUE(
          std::equal(chosen.begin(), chosen.end(), whole.chosen(row).begin() + static_cast<std::ptrdiff_t>(begin)));
    }
  }
}

TEST(DitherBand, CountsMixturesApart) {
  DitherBand band(printer_mask());
  // Two mixtures side by side within each tile: halves of 128 voxels, of which each has its own number right.
  for (int k = 0; k < 16; ++k) {
    band.begin();
    double wanted = 0.0;
    for (std::int64_t j = 0; j < 16; ++j) {
      std::vector<float> left(16);
      for (std::size_t n = 0; n < 8; ++n) {
        left[n] = 0.1F + 0.01F * static_cast<float>(n) + 0.02F * static_cast<float>(j);
        left[8 + n] = 1.0F - left[n];
        wanted += left[n];
      }
      band.add(1, {0, j, k}, left, 8);
      std::rotate(left.begin(), left.begin() + 8, left.end());
      band.add(2, {8, j, k}, left, 8);
    }
    band.settle();
    const double rounding = (printer_mask().rank_in_column({0, 0, k}) + 0.5) / kSide;
    std::array<double, 2> counted{};
    for (std::size_t run = 0; run < 32; ++run) {
      const auto chosen = band.chosen(run);
      counted[run % 2] += static_cast<double>(std::count(chosen.begin(), chosen.end(), 0));
    }
    EXPECT_EQ(counted[0], std::floor(wanted + rounding));
    EXPECT_EQ(counted[1], std::floor(128.0 - wanted + rounding));
  }
}

TEST(DitherBand, TakesNoNotANumberForAMaterial) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  DitherBand band(printer_mask());
  band.begin();
  for (std::int64_t j = 0; j < 16; ++j) {
    std::vector<float> row;
    for (std::size_t n = 0; n < 16; ++n) row.push_back(n % 3 == 0 ? nan : -1.0F);
    const auto share = [&](std::size_t n) {
      return 0.025F * static_cast<float>(n + 1) + 0.03F * static_cast<float>(j);
    };
    for (std::size_t n = 0; n < 16; ++n) row.push_back(share(n));
    for (std::size_t n = 0; n < 16; ++n) row.push_back(1.0F - share(n));
    band.add(0, {0, j, 0}, row, 16);
  }
  band.settle();
  std::ptrdiff_t ones = 0;
  for (std::size_t run = 0; run < 16; ++run) {
    EXPECT_EQ(std::count(band.chosen(run).begin(), band.chosen(run).end(), 0), 0);
    ones += std::count(band.chosen(run).begin(), band.chosen(run).end(), 1);
  }
  EXPECT_NEAR(static_cast<double>(ones), 16 * 0.025 * 136 + 16 * 0.03 * 120, 1.0);
}

}  // namespace
}  // namespace lamella::test
