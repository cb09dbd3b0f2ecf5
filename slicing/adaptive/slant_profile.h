#pragma once

#include <cstddef>
#include <vector>

#include "core/geometry.h"

namespace lamella {

/// From the lowest to the highest point of a box that isn't empty, mm.
[[nodiscard]] inline Interval heights_of(const Box3& box) { return {box.min().z(), box.max().z()}; }

/// How exact bounds of slants are to be.
inline constexpr double kSlantAccuracy = 0.005;

/// Part of a surface, its edges or its vertices: between these heights its normals have |n_z| of at most `slant` (0 on
/// a vertical wall, 1 where it is horizontal).
struct Slant {
  Interval z;  ///< mm
  double slant = 0.0;
};

/// The half of a layer that has a place, which recedes to the layer's middle.
enum class LayerHalf { upper, lower };

/// The largest slant of a surface over the height, and what layers deviate by it (docs/methods/adaptive-layers.md).
class SlantProfile {
 public:
  /// `count` bins of `width` mm, the first from `bottom` on.
  SlantProfile(double bottom, double width, std::size_t count);

  /// Takes a part into account; what lies beyond the bins is left out.
  void add(const Slant& part);
  /// The same where the surface is thin, and recedes by `part.slant` mm per mm, which may be more than 1, in one of the
  /// halves (docs/methods/adaptive-layers.md, "What layers lose").
  void add_thin(const Slant& part, LayerHalf half);
  /// Must be called after the last add() and before layer_deviation().
  void finish();

  [[nodiscard]] std::size_t size() const { return bins_.size(); }
  [[nodiscard]] double bottom() const { return bottom_; }
  [[nodiscard]] double width() const { return width_; }
  /// Of a bin, levels inside it included.
  [[nodiscard]] double slant(std::size_t bin) const;
  /// Smallest slant of the bins that an interval touches, levels left out.
  [[nodiscard]] double least_slant(const Interval& z) const;
  /// The same of what counts in one half of a layer, rates of thin places included.
  [[nodiscard]] double least_rate(const Interval& z, LayerHalf half) const;

  /// Bound in mm of the deviation of a layer that takes bins [begin, end), an even number of them (those behind the
  /// last one are empty) and is sampled in their middle (eq. 3).
  [[nodiscard]] double layer_deviation(std::size_t begin, std::size_t end) const;

 private:
  [[nodiscard]] std::size_t bin_of(double z) const;
  void raise(std::vector<double>& bins, const Slant& part) const;
  [[nodiscard]] double height(std::size_t bin) const { return bottom_ + static_cast<double>(bin) * width_; }
  [[nodiscard]] double upward(std::size_t begin, std::size_t end) const;
  [[nodiscard]] double downward(std::size_t begin, std::size_t end) const;

  double bottom_;
  double width_;
  std::vector<double> bins_;
  std::vector<double> upper_;  ///< rates of thin places by half
  std::vector<double> lower_;
  std::vector<Slant> levels_;             ///< parts far thinner than a bin, kept where they are
  std::vector<std::size_t> first_level_;  ///< of each bin, and behind the last one
};

}  // namespace lamella
