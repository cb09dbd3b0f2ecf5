#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry.h"
#include "slicing/void_and_cluster.h"

namespace lamella {

/// A voxel's place in the raster. Any sign: the mask repeats every 32 voxels along each axis.
struct VoxelIndex {
  std::int64_t i = 0;
  std::int64_t j = 0;
  std::int64_t k = 0;
};

/// Thresholds of blue noise by which voxels of mixed material become voxels of one (docs/methods/dithering.md).
///
/// Every one of the 32768 thresholds of a period is there once: (r + 1/2) / 32768. Immutable, so threads may share it.
class DitherMask {
 public:
  static constexpr int kSide = kTorusSide;  ///< voxels of a period along each axis

  /// `pitch` is a voxel's size, mm; only its ratios count. Takes about half a second. Throws as void_and_cluster()
  /// does.
  explicit DitherMask(const Vec3& pitch);

  /// Greater than 0, less than 1.
  [[nodiscard]] float threshold(const VoxelIndex& at) const { return row(at.j, at.k)[index(at.i)]; }
  /// The thresholds of a row of one period, from i = 0 on.
  [[nodiscard]] std::span<const float, kSide> row(std::int64_t j, std::int64_t k) const {
    return std::span<const float, kSide>(thresholds_.data() + (index(k) * kSide + index(j)) * kSide, kSide);
  }
  /// Which of its column's 32 thresholds, that is of all k, this one is: 0 for the least.
  [[nodiscard]] int rank_in_column(const VoxelIndex& at) const {
    return column_ranks_[(index(at.k) * kSide + index(at.j)) * kSide + index(at.i)];
  }
  /// Where `i` lies in its period.
  [[nodiscard]] static std::size_t index(std::int64_t i) { return static_cast<std::size_t>(i) % kSide; }

 private:
  std::vector<float> thresholds_;
  std::vector<std::uint8_t> column_ranks_;
};

/// Chooses one material for each voxel of a row: the one in whose part of [0, 1] the mask's threshold lies, when the
/// fractions are laid end to end in the order of materials.
///
/// `out[n]` is the material of voxel (first.i + n, first.j, first.k). `fractions` holds one row of out.size() volume
/// fractions after the other, a material each: that of material m at voxel n is fractions[m * out.size() + n]. They are
/// to be 0 or more with sum 1 in each voxel, for 1 to 256 materials; throws std::invalid_argument if the sizes don't
/// say so. A material of fraction 0 (or negative, or NaN) is never chosen while any other is positive, and where the
/// sum falls short of 1 the last positive one takes the rest. The result depends on voxel and fractions alone. Nothing
/// is allocated.
void dither_row(const DitherMask& mask, const VoxelIndex& first, std::span<const float> fractions,
                std::span<std::uint8_t> out);

}  // namespace lamella
