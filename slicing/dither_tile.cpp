#include "slicing/dither_tile.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace lamella {
namespace {

constexpr std::size_t kSide = DitherTile::kSide;
constexpr std::size_t kVoxels = DitherTile::kVoxels;
/// What an uneven tile weighs against the distance to a threshold: docs/methods/dithering.md has what others gave.
constexpr float kUnevenness = 0.1F / kSide;
/// Exchanges of a voxel for another one that make a tile more even, at most for each border.
constexpr int kExchanges = 2;
/// What differs by less from voxel to voxel is even.
constexpr float kSlope = 1e-5F;
constexpr float kNever = 1e30F;

using Lanes = std::array<float, kSide>;

}  // namespace

/// How even the error, voxels before a border less those that there should be, is spread over the tile.
class DitherTile::Evenness {
 public:
  void add(std::size_t place, float error) {
    columns_[place % kSide] += error;
    rows_[place / kSide] += error;
  }
  void add_row(std::size_t row, const Lanes& errors) {
    std::array<float, 4> quarters{};  // added up four at a time, as vectors can
    for (std::size_t i = 0; i < kSide; ++i) columns_[i] += errors[i];
    for (std::size_t i = 0; i < kSide; i += quarters.size()) {
      for (std::size_t n = 0; n < quarters.size(); ++n) quarters[n] += errors[i + n];
    }
    rows_[row] += (quarters[0] + quarters[1]) + (quarters[2] + quarters[3]);
  }
  /// What a change by `sign` costs in each column: by how much the sum of the squares of the errors of all columns up
  /// to a column grows, for all columns but the last, whose sum is the tile's own error.
  [[nodiscard]] Lanes cost_by_column(float sign) const { return cost(columns_, sign); }
  [[nodiscard]] Lanes cost_by_row(float sign) const { return cost(rows_, sign); }

 private:
  static Lanes cost(const Lanes& errors, float sign) {
    Lanes sums;
    float sum = 0.0F;
    for (std::size_t n = 0; n < kSide; ++n) sums[n] = sum += errors[n];
    Lanes cost{};
    for (std::size_t n = kSide - 1; n-- > 0;) cost[n] = cost[n + 1] + kUnevenness * (2.0F * sign * sums[n] + 1.0F);
    return cost;
  }

  Lanes columns_{};
  Lanes rows_{};
};

void DitherTile::clear(std::size_t materials) {
  materials_ = materials;
  fractions_.assign(materials * kVoxels, 0.0F);
  chosen_.fill(-1);
}

void DitherTile::settle(const DitherMask& mask, const TileIndex& at) {
  for (std::size_t j = 0; j < kSide; ++j) {
    const auto row = mask.row(at.row * DitherTile::kSide + static_cast<std::int64_t>(j), at.layer);
    const float* const first = row.data() + DitherMask::index(at.column * DitherTile::kSide);
    std::copy_n(first, kSide, thresholds_.begin() + j * kSide);
  }
  has_neighbours_ = false;
  share_.fill(0.0F);
  // Over 32 layers each rounding once, in another order for each column of tiles.
  const float rounding = (static_cast<float>(mask.rank_in_column({at.column, at.row, at.layer})) + 0.5F) /
                         static_cast<float>(DitherMask::kSide);
  for (std::size_t m = 0; m + 1 < materials_; ++m) {
    const std::span<const float, kVoxels> fractions = this->fractions(m);
    for (std::size_t v = 0; v < kVoxels; ++v) share_[v] += fractions[v] > 0.0F ? fractions[v] : 0.0F;
    settle_border(static_cast<std::int32_t>(m), rounding);
  }
}

void DitherTile::find_neighbours() {
  has_neighbours_ = true;
  neighbours_.before.fill(-1);
  neighbours_.after.fill(-1);
  for (std::size_t n = 0; n < materials_; ++n) {
    const auto m = static_cast<std::int32_t>(n);
    const std::span<const float, kVoxels> fractions = this->fractions(n);
    for (std::size_t v = 0; v < kVoxels; ++v) {
      const bool is_there = fractions[v] > 0.0F;
      const bool is_before = is_there & (m < chosen_[v]);
      const bool is_after = is_there & (m > chosen_[v]) & (neighbours_.after[v] < 0);
      neighbours_.before[v] = is_before ? m : neighbours_.before[v];
      neighbours_.after[v] = is_after ? m : neighbours_.after[v];
    }
  }
}

/// A border's voxels added up.
struct DitherTile::Sums {
  double share = 0.0;       ///< voxels that there should be before the border
  std::int32_t before = 0;  ///< voxels that there are
  Evenness evenness;
};

DitherTile::Sums DitherTile::add_up(std::int32_t material) const {
  Lanes share{};
  std::array<std::int32_t, kSide> before{};
  Sums sums;
  for (std::size_t j = 0; j < kSide; ++j) {
    Lanes errors;
    for (std::size_t i = 0; i < kSide; ++i) {
      const std::size_t v = j * kSide + i;
      // All bits or none; where there is no voxel its share is 0.
      const std::int32_t is_before =
          -static_cast<std::int32_t>(chosen_[v] >= 0) & -static_cast<std::int32_t>(chosen_[v] <= material);
      before[i] -= is_before;
      share[i] += share_[v];
      errors[i] = -static_cast<float>(is_before) - share_[v];
    }
    sums.evenness.add_row(j, errors);
  }
  for (std::size_t i = 0; i < kSide; ++i) {
    sums.share += share[i];
    sums.before += before[i];
  }
  return sums;
}

bool DitherTile::is_oblique() const {
  const auto differ = [this](std::size_t a, std::size_t b) {
    return chosen_[a] >= 0 && chosen_[b] >= 0 && std::abs(share_[a] - share_[b]) > kSlope;
  };
  bool along_x = false;
  bool along_y = false;
  for (std::size_t v = 1; v < kVoxels; ++v) {
    along_x = along_x || (v % kSide > 0 && differ(v, v - 1));
    along_y = along_y || (v >= kSide && differ(v, v - kSide));
    if (along_x && along_y) return true;
  }
  return false;
}

void DitherTile::settle_border(std::int32_t material, float rounding) {
  if (!is_oblique()) return;
  if (!has_neighbours_) find_neighbours();
  const Sums sums = add_up(material);
  const auto target = static_cast<std::int32_t>(sums.share + rounding);
  Evenness evenness = sums.evenness;
  // Where fractions of 0 forbid it the number stays wrong.
  for (std::int32_t n = sums.before; n != target && shift(material, n < target, evenness);) n += n < target ? 1 : -1;
  for (int n = 0; n < kExchanges && exchange(material, evenness); ++n) {
  }
}

DitherTile::Change DitherTile::find_change(std::int32_t material, bool more, const Evenness& evenness) const {
  const float sign = more ? 1.0F : -1.0F;
  const Lanes column_cost = evenness.cost_by_column(sign);
  const Lanes row_cost = evenness.cost_by_row(sign);
  // The cheapest of each column, all columns alike so that compilers make vectors of them.
  Lanes least;
  least.fill(kNever);
  std::array<std::int32_t, kSide> row{};
  for (std::size_t j = 0; j < kSide; ++j) {
    for (std::size_t i = 0; i < kSide; ++i) {
      const std::size_t v = j * kSide + i;
      const bool can_move =
          more ? neighbours_.before[v] == material : (chosen_[v] == material) & (neighbours_.after[v] >= 0);
      const float cost = std::abs(share_[v] - thresholds_[v]) + column_cost[i] + row_cost[j];
      const bool is_less = can_move & (cost < least[i]);
      row[i] = is_less ? static_cast<std::int32_t>(j) : row[i];
      least[i] = is_less ? cost : least[i];
    }
  }
  const auto column = static_cast<std::size_t>(std::min_element(least.begin(), least.end()) - least.begin());
  return {static_cast<std::size_t>(row[column]) * kSide + column, least[column]};
}

bool DitherTile::shift(std::int32_t material, bool more, Evenness& evenness) {
  const Change change = find_change(material, more, evenness);
  if (change.cost == kNever) return false;
  evenness.add(change.voxel, more ? 1.0F : -1.0F);
  move(change.voxel, more ? material : neighbours_.after[change.voxel]);
  return true;
}

bool DitherTile::exchange(std::int32_t material, Evenness& evenness) {
  const Change one = find_change(material, true, evenness);
  if (one.cost == kNever) return false;
  evenness.add(one.voxel, 1.0F);
  const Change other = find_change(material, false, evenness);
  if (!(one.cost + other.cost < 0.0F)) {
    evenness.add(one.voxel, -1.0F);
    return false;
  }
  evenness.add(other.voxel, -1.0F);
  move(other.voxel, neighbours_.after[other.voxel]);
  move(one.voxel, material);
  return true;
}

void DitherTile::move(std::size_t voxel, std::int32_t material) {
  chosen_[voxel] = material;
  const auto is_there = [&](std::int32_t m) { return fractions(static_cast<std::size_t>(m))[voxel] > 0.0F; };
  std::int32_t before = material - 1;
  while (before >= 0 && !is_there(before)) --before;
  neighbours_.before[voxel] = before;
  const auto end = static_cast<std::int32_t>(materials_);
  std::int32_t after = material + 1;
  while (after < end && !is_there(after)) ++after;
  neighbours_.after[voxel] = after < end ? after : -1;
}

}  // namespace lamella
