#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace lamella {

/// Which layers there may be between borders 0, 1, 2, ... at multiples of a quantum, and what they cost.
struct LayerProblem {
  std::size_t height = 0;                ///< the border at which layers should end
  std::vector<std::size_t> thicknesses;  ///< in quanta, ascending
  /// Deviation in mm of the layer on border i with thicknesses[t] at [i * thicknesses.size() + t], i < height; kRefused
  /// where there can't be one. Layers may reach beyond `height`.
  std::vector<double> deviations;
  /// What it costs, for each border in [0, height], when no layer ends there.
  std::vector<std::uint64_t> missing;
  /// What it costs, for each border i in [0, height], when no layer ends there nor at i + 1; empty: nothing.
  std::vector<std::uint64_t> missing_both = {};

  static constexpr double kRefused = std::numeric_limits<double>::infinity();
};

struct LayerChoice {
  std::vector<std::size_t> borders;  ///< ascending from 0; the last one is not below the height
  std::uint64_t missed = 0;          ///< sum of `missing` and `missing_both` over the borders that were passed over
  double deviation_sum = 0.0;        ///< of deviation times thickness, mm times quanta
  double largest = 0.0;              ///< deviation, mm

  [[nodiscard]] std::size_t layers() const { return borders.size() - 1; }
};

/// The best choice or, if there is none, how far layers get.
struct LayerSearch {
  std::optional<LayerChoice> choice;
  std::vector<std::size_t> reached;  ///< borders that can be reached, ascending
};

/// The choice that misses least, of those the one of fewest layers, of those the one of least deviation_sum: by dynamic
/// programming, exact.
[[nodiscard]] LayerSearch choose_best(const LayerProblem& problem);

/// From the bottom up always the thickest layer that passes over no border that costs something, else the thickest.
/// What slicers do that look no further than the layer at hand.
[[nodiscard]] LayerSearch choose_greedily(const LayerProblem& problem);

}  // namespace lamella
