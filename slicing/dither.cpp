#include "slicing/dither.h"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace lamella {
namespace {

constexpr std::size_t kSide = DitherMask::kSide;

/// One period of a row, all lanes alike so that compilers make vectors of them.
struct Lanes {
  std::array<float, kSide> thresholds;
  std::array<float, kSide> below;          ///< sum of the fractions so far
  std::array<std::int32_t, kSide> chosen;  ///< as wide as the floats that decide

  void clear() {
    below.fill(0.0F);
    chosen.fill(0);
  }
  void offer(const float* fractions, std::int32_t material) {
    for (std::size_t n = 0; n < kSide; ++n) {
      const float fraction = fractions[n];
      // Bits instead of branches; a NaN is not greater than 0.
      const std::int32_t takes = -static_cast<std::int32_t>((fraction > 0.0F) & (below[n] <= thresholds[n]));
      chosen[n] = (chosen[n] & ~takes) | (material & takes);
      below[n] += fraction > 0.0F ? fraction : 0.0F;
    }
  }
};

}  // namespace

DitherMask::DitherMask(const Vec3& pitch) {
  const std::vector<std::uint16_t> ranks = void_and_cluster(pitch);
  thresholds_.reserve(ranks.size());
  // Exact in a float: 16 bits over a power of two.
  for (const std::uint16_t rank : ranks) thresholds_.push_back((static_cast<float>(rank) + 0.5F) / 32768.0F);
  constexpr std::size_t kLayer = kSide * kSide;
  for (std::size_t v = 0; v < ranks.size(); ++v) {
    int below = 0;
    for (std::size_t w = v % kLayer; w < ranks.size(); w += kLayer) below += ranks[w] < ranks[v] ? 1 : 0;
    column_ranks_.push_back(static_cast<std::uint8_t>(below));
  }
}

void dither_row(const DitherMask& mask, const VoxelIndex& first, std::span<const float> fractions,
                std::span<std::uint8_t> out) {
  if (out.empty()) return;
  const std::size_t materials = fractions.size() / out.size();
  if (materials < 1 || materials > 256 || materials * out.size() != fractions.size()) {
    throw std::invalid_argument("dither_row: there must be as many fractions as voxels times 1 to 256 materials");
  }
  Lanes lanes;
  const std::span<const float, kSide> row = mask.row(first.j, first.k);
  std::rotate_copy(row.begin(), row.begin() + DitherMask::index(first.i), row.end(), lanes.thresholds.begin());
  std::array<float, kSide> rest{};
  for (std::size_t begin = 0; begin < out.size(); begin += kSide) {
    const std::size_t count = std::min(kSide, out.size() - begin);
    lanes.clear();
    for (std::size_t m = 0; m < materials; ++m) {
      const float* source = fractions.data() + m * out.size() + begin;
      if (count < kSide) source = std::copy_n(source, count, rest.begin()) - count;
      lanes.offer(source, static_cast<std::int32_t>(m));
    }
    for (std::size_t n = 0; n < count; ++n) out[begin + n] = static_cast<std::uint8_t>(lanes.chosen[n]);
  }
}

}  // namespace lamella
