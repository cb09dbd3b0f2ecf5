#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "slicing/dither.h"

namespace lamella {

/// Which tile: voxels from 16 `column` and 16 `row` on, of layer `layer`.
struct TileIndex {
  std::int64_t column = 0;
  std::int64_t row = 0;
  std::int64_t layer = 0;
};

/// The voxels of one mixture in 16 x 16 voxels of a layer, and how many of them get each material
/// (docs/methods/dithering.md, "Tiles").
class DitherTile {
 public:
  static constexpr std::int64_t kSide = 16;
  static constexpr std::size_t kVoxels = kSide * kSide;

  /// The tile that a voxel lies in, along one axis.
  [[nodiscard]] static std::int64_t tile_of(std::int64_t voxel) {
    return voxel >= 0 ? voxel / kSide : -1 - (-1 - voxel) / kSide;
  }
  /// A voxel's place in the tile, x fastest.
  [[nodiscard]] static std::size_t place(std::int64_t i, std::int64_t j) {
    return static_cast<std::size_t>((j - tile_of(j) * kSide) * kSide + (i - tile_of(i) * kSide));
  }

  /// Empties it, for a mixture of `materials`, 1 to 256.
  void clear(std::size_t materials);
  /// The volume fractions of material m by place; 0 where the mixture isn't.
  [[nodiscard]] std::span<float, kVoxels> fractions(std::size_t m) {
    return std::span<float, kVoxels>(fractions_.data() + m * kVoxels, kVoxels);
  }
  /// The material of each place; -1 where the mixture isn't.
  [[nodiscard]] std::array<std::int32_t, kVoxels>& chosen() { return chosen_; }

  /// Changes as few voxels as needed, so that the number of those of the first m materials, for each m, is the sum of
  /// their fractions, rounded down or up as the mask says; no voxel gets a material of fraction 0. Where the sum of
  /// fractions varies along neither or only one of x and y the mask alone does better, and nothing is changed.
  void settle(const DitherMask& mask, const TileIndex& at);

 private:
  /// What can become of a voxel: the nearest materials before and after its own that it has a fraction of, or -1.
  struct Neighbours {
    std::array<std::int32_t, kVoxels> before;
    std::array<std::int32_t, kVoxels> after;
  };

  class Evenness;
  struct Sums;
  /// Of a voxel's material, across a border.
  struct Change {
    std::size_t voxel;
    float cost;
  };

  void find_neighbours();
  /// Whether the share before a border varies along x and along y.
  [[nodiscard]] bool is_oblique() const;
  [[nodiscard]] Sums add_up(std::int32_t material) const;
  void settle_border(std::int32_t material, float rounding);
  /// The cheapest voxel to get a material up to `material` instead of one beyond (`more`), or the other way round.
  [[nodiscard]] Change find_change(std::int32_t material, bool more, const Evenness& evenness) const;
  bool shift(std::int32_t material, bool more, Evenness& evenness);
  bool exchange(std::int32_t material, Evenness& evenness);
  void move(std::size_t voxel, std::int32_t material);

  std::size_t materials_ = 0;
  std::vector<float> fractions_;
  std::array<std::int32_t, kVoxels> chosen_{};
  Neighbours neighbours_{};
  bool has_neighbours_ = false;
  std::array<float, kVoxels> thresholds_{};
  std::array<float, kVoxels> share_{};  ///< sum of the fractions of the materials before a border
};

}  // namespace lamella
