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

TEST(VoidAndCluster, GivesEachRankOnceAndTheSameTwice) {
  for (const Vec3& pitch : {Vec3(1, 1, 1), Vec3(0.042, 0.084, 0.027), Vec3(100, 1, 1), Vec3(1, 1, 100)}) {
    const std::vector<std::uint16_t> ranks = void_and_cluster(pitch);
    std::vector<int> seen(kVoxels);
    ASSERT_EQ(ranks.size(), seen.size());
    for (const std::uint16_t rank : ranks) ++seen.at(rank);
    EXPECT_EQ(seen, std::vector<int>(kVoxels, 1)) << pitch.transpose();
  }
  EXPECT_EQ(void_and_cluster(Vec3(1, 2, 3)), void_and_cluster(Vec3(1, 2, 3)));
}

TEST(VoidAndCluster, DependsOnRatiosOfThePitchOnly) {
  EXPECT_EQ(void_and_cluster(Vec3(0.5, 1, 0.25)), void_and_cluster(Vec3(2, 4, 1)));
  EXPECT_NE(void_and_cluster(Vec3(0.5, 1, 0.25)), void_and_cluster(Vec3(1, 1, 1)));
}

TEST(VoidAndCluster, RefusesAPitchThatIsNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, nan, infinite, 1e-3, 1e3}) {
    EXPECT_THROW((void)void_and_cluster(Vec3(bad, 1, 1)), std::invalid_argument) << bad;
    EXPECT_THROW((void)void_and_cluster(Vec3(1, bad, 1)), std::invalid_argument) << bad;
    EXPECT_THROW((void)void_and_cluster(Vec3(1, 1, bad)), std::invalid_argument) << bad;
  }
}

/// Squared distance on the torus, in units of the pitch.
double squared_distance(int a, int b, const Vec3& pitch) {
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const int d = std::abs(a % kSide - b % kSide);
    const double length = std::min(d, kSide - d) * pitch[axis];
    sum += length * length;
    a /= kSide;
    b /= kSide;
  }
  return sum;
}

/// Of n points without order the two nearest are (3 / (2 pi n))^(1/3) mean spacings apart, 0.20 and 0.11 for these.
TEST(VoidAndCluster, KeepsFewVoxelsApart) {
  for (const Vec3& pitch : {Vec3(1, 1, 1), Vec3(0.042, 0.084, 0.027)}) {
    const std::vector<std::uint16_t> ranks = void_and_cluster(pitch);
    for (const int count : {64, 327}) {
      std::vector<int> points;
      for (int v = 0; v < kVoxels; ++v) {
        if (ranks[static_cast<std::size_t>(v)] < count) points.push_back(v);
      }
      const double spacing = std::cbrt(pitch.prod() * kVoxels / count);
      double nearest = std::numeric_limits<double>::max();
      for (const int a : points) {
        for (const int b : points) {
          if (a != b) nearest = std::min(nearest, squared_distance(a, b, pitch));
        }
      }
      EXPECT_GT(std::sqrt(nearest), 0.4 * spacing) << count << " points, pitch " << pitch.transpose();
    }
  }
}

TEST(DitherMask, HoldsEveryThresholdOnceAndRepeats) {
  const DitherMask& mask = printer_mask();
  std::vector<int> seen(kVoxels);
  for (int k = 0; k < kSide; ++k) {
    for (int j = 0; j < kSide; ++j) {
      for (int i = 0; i < kSide; ++i) {
        const float threshold = mask.threshold({i, j, k});
        const float rank = threshold * kVoxels - 0.5F;
        ASSERT_EQ(rank, std::floor(rank));
        ++seen.at(static_cast<std::size_t>(rank));
        ASSERT_EQ(threshold, mask.threshold({i - 3 * kSide, j + 5 * kSide, k - kSide}));
      }
    }
  }
  EXPECT_EQ(seen, std::vector<int>(kVoxels, 1));
}

TEST(DitherRow, ChoosesAsTheDefinitionDoesForAnyRow) {
  const DitherMask& mask = printer_mask();
  std::mt19937 random(5);
  for (int round = 0; round < 400; ++round) {
    const std::size_t materials = 1 + random() % 8;
    const std::size_t count = 1 + random() % 150;
    const VoxelIndex first{static_cast<int>(random() % 1000) - 500, static_cast<int>(random() % 1000) - 500,
                           static_cast<int>(random() % 1000) - 500};
    std::vector<float> row(materials * count);
    std::vector<std::uint8_t> expected(count);
    for (std::size_t n = 0; n < count; ++n) {
      const std::vector<double> fractions = draw_fractions(materials, random);
      set_voxel(row, count, n, fractions);
      const VoxelIndex at{first.i + static_cast<std::int64_t>(n), first.j, first.k};
      expected[n] = static_cast<std::uint8_t>(choose(mask.threshold(at), fractions));
    }
    std::vector<std::uint8_t> out(count, 255);
    dither_row(mask, first, row, out);
    ASSERT_EQ(out, expected) << "round " << round;
  }
}

TEST(DitherRow, NeverChoosesAMaterialThatIsNotThereAndAlwaysAPureOne) {
  const DitherMask& mask = printer_mask();
  constexpr std::size_t kMaterials = 5;
  std::vector<float> row(kMaterials * kSide);
  std::vector<std::uint8_t> out(kSide);
  for (std::size_t missing = 0; missing < kMaterials; ++missing) {
    for (int pure = 0; pure < 2; ++pure) {
      // Sums that rounding leaves short of 1 on purpose: 4 times 0.24999.
      for (std::size_t m = 0; m < kMaterials; ++m) {
        const float fraction = pure == 1 ? (m == missing ? 1.0F : 0.0F) : (m == missing ? 0.0F : 0.24999F);
        std::fill_n(row.begin() + static_cast<std::ptrdiff_t>(m * kSide), kSide, fraction);
      }
      for (int j = 0; j < kSide * kSide; ++j) {
        dither_row(mask, {0, j % kSide, j / kSide}, row, out);
        for (const std::uint8_t m : out) ASSERT_EQ(m == missing, pure == 1);
      }
    }
  }
}

TEST(DitherRow, TakesNoNotANumberForAMaterial) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const std::vector<float>& voxel : {std::vector<float>{nan, 0.5F, 0.5F}, {-1.0F, 0.5F, 0.5F}}) {
    std::vector<float> row;
    for (const float f : voxel) row.insert(row.end(), kSide, f);
    std::vector<std::uint8_t> out(kSide);
    dither_row(printer_mask(), {}, row, out);
    EXPECT_EQ(std::count(out.begin(), out.end(), 0), 0);
    EXPECT_GT(std::count(out.begin(), out.end(), 1), 0);
    EXPECT_GT(std::count(out.begin(), out.end(), 2), 0);
  }
}

TEST(DitherRow, RefusesFractionsThatDoNotFitTheRow) {
  std::vector<std::uint8_t> out(3);
  const std::vector<float> fractions(3 * 257);
  const std::span<const float> all(fractions);
  EXPECT_THROW(dither_row(printer_mask(), {}, all.first(0), out), std::invalid_argument);
  EXPECT_THROW(dither_row(printer_mask(), {}, all.first(2), out), std::invalid_argument);
  EXPECT_THROW(dither_row(printer_mask(), {}, all.first(7), out), std::invalid_argument);
  EXPECT_THROW(dither_row(printer_mask(), {}, all, out), std::invalid_argument);
  EXPECT_NO_THROW(dither_row(printer_mask(), {}, all.first(3 * 256), out));
  EXPECT_NO_THROW(dither_row(printer_mask(), {}, {}, {}));
}

TEST(DitherRow, GivesTheSameHoweverRowsAreCutAndSharedOut) {
  constexpr std::size_t kCount = 500;
  constexpr std::size_t kRows = 64;
  std::mt19937 random(11);
  std::vector<float> row(3 * kCount);
  for (std::size_t n = 0; n < kCount; ++n) set_voxel(row, kCount, n, draw_fractions(3, random));
  std::vector<std::vector<std::uint8_t>> whole(kRows, std::vector<std::uint8_t>(kCount));
  for (std::size_t j = 0; j < kRows; ++j) dither_row(printer_mask(), {-7, static_cast<int>(j), 3}, row, whole[j]);

  std::vector<std::vector<std::uint8_t>> parts = whole;
  for (std::vector<std::uint8_t>& part : parts) part.assign(kCount, 255);
  const auto work = [&](std::size_t thread) {
    for (std::size_t j = thread; j < kRows; j += 4) {
      for (std::size_t n = 0; n < kCount; ++n) {  // the worst cut: each voxel alone
        const std::array<float, 3> voxel{row[n], row[kCount + n], row[2 * kCount + n]};
        dither_row(printer_mask(), {static_cast<std::int64_t>(n) - 7, static_cast<int>(j), 3}, voxel,
                   std::span(parts[j]).subspan(n, 1));
      }
    }
  };
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 4; ++t) threads.emplace_back(work, t);
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(parts, whole);
}

/// A cube of 32 voxels holds every threshold once, wherever it starts: a material's count is off by less than one.
TEST(DitherMean, OfConstantsIsExactInAnyCube) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  for (int round = 0; round < 40; ++round) {
    double total = 0.0;
    std::vector<double> fractions(2 + random() % 5);
    for (double& f : fractions) total += f = part(random);
    for (double& f : fractions) f /= total;
    const VoxelIndex corner{static_cast<int>(random() % 100), static_cast<int>(random() % 100),
                            static_cast<int>(random() % 100)};
    EXPECT_LT(mean_error(printer_mask(), corner, fractions.size(), [&](const auto&) { return fractions; }),
              1.1 / kVoxels);
  }
}

/// The requirement is 1e-3 of the field's mean for each material.
TEST(DitherMean, OfGradientsAlongAnAxisIsWithinAThousandth) {
  for (const Vec3& pitch : {Vec3(0.042, 0.084, 0.027), Vec3(1, 1, 1)}) {
    const DitherMask mask(pitch);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const int length : {64, 77, 100, 128, 150, 200, 256, 300}) {
        const Field ramp = [&](const auto& at) {
          const double f = (static_cast<double>(at[axis]) + 0.5) / length;
          return std::vector{1.0 - f, f};
        };
        for (int start = 0; start + kSide <= length; start += 3) {
          VoxelIndex corner{11 * start, 5 * start + 3, 7 * start + 1};
          std::array{&corner.i, &corner.j, &corner.k}[axis][0] = start;
          ASSERT_LT(mean_error(mask, corner, 2, ramp), 1e-3)
              << "axis " << axis << " length " << length << " from " << start << " pitch " << pitch.transpose();
        }
      }
    }
  }
}

/// Four materials along one axis: each is between two sums that change, or beside one.
TEST(DitherMean, OfFourMaterialsAlongAnAxisIsWithinAThousandth) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const int length : {64, 100, 200, 300}) {
      const Field blend = [&](const auto& at) {
        const double f = (static_cast<double>(at[axis]) + 0.5) / length;
        return std::vector{(1.0 - f) / 2, f / 2, 0.5 - f / 2, f / 2};
      };
      for (int start = 0; start + kSide <= length; start += 3) {
        VoxelIndex corner{11 * start, 5 * start + 3, 7 * start + 1};
        std::array{&corner.i, &corner.j, &corner.k}[axis][0] = start;
        ASSERT_LT(mean_error(printer_mask(), corner, 4, blend), 1e-3) << "axis " << axis << " length " << length;
      }
    }
  }
}

/// The mask alone has an rms of 3.9e-4 here and cubes beyond 1e-3: docs/methods/dithering.md.
TEST(DitherMean, OfObliqueGradientsIsWithinAThousandth) {
  std::mt19937 random(23);
  std::normal_distribution<double> normal;
  constexpr int kRounds = 400;
  double squares = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
    const double length = 64.0 + random() % 236;
    const VoxelIndex corner{static_cast<int>(random() % 100), static_cast<int>(random() % 100),
                            static_cast<int>(random() % 100)};
    const Vec3 centre =
        Vec3(static_cast<double>(corner.i), static_cast<double>(corner.j), static_cast<double>(corner.k)) +
        Vec3::Constant(0.5 * (kSide - 1));
    const Field ramp = [&](const auto& at) {
      const Vec3 place(static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2]));
      const double f = std::clamp(0.5 + direction.dot(place - centre) / length, 0.0, 1.0);
      return std::vector{1.0 - f, f};
    };
    const double error = mean_error(printer_mask(), corner, 2, ramp);
    squares += error * error;
    EXPECT_LT(error, 1e-3) << "direction " << direction.transpose();
  }
  EXPECT_LT(std::sqrt(squares / kRounds), 2.8e-4);
}

/// Shells around a point, of three materials.
TEST(DitherMean, OfRadialGradientsIsWithinAThousandth) {
  std::mt19937 random(29);
  for (int round = 0; round < 100; ++round) {
    const VoxelIndex corner{static_cast<int>(random() % 100), static_cast<int>(random() % 100),
                            static_cast<int>(random() % 100)};
    const Vec3 centre(random() % 160, random() % 160, random() % 160);
    const Field shells = [&](const auto& at) {
      const Vec3 place(static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2]));
      const double f = std::clamp((place - centre).norm() / 250.0, 0.0, 1.0);
      return std::vector{(1.0 - f) * (1.0 - f), 2.0 * f * (1.0 - f), f * f};
    };
    EXPECT_LT(mean_error(printer_mask(), corner, 3, shells), 1e-3) << "round " << round;
  }
}

}  // namespace
}  // namespace lamella::test
