#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "slicing/layer_plan.h"

namespace lamella {

/// Slices [begin, end).
struct SliceRange {
  std::int64_t begin = 0;
  std::int64_t end = 0;
};

/// How the layers of a plan become slices of one thickness, for formats that know no other: slice s lies between
/// bottom() + s pitch() and bottom() + (s + 1) pitch().
class UniformZ {
 public:
  /// Without `z_pitch`, mm, the slices are the thickest that every border of layers is a border of, to a millionth of
  /// their thickness, and a layer is as many equal slices as it is thick. With it, a slice has the layer that holds its
  /// middle; the last one may overhang. Throws UsageError, which names `format`, when there are no such slices or more
  /// than 10^7.
  UniformZ(const LayerPlan& plan, std::optional<double> z_pitch, std::string_view format);

  [[nodiscard]] double bottom() const { return bottom_; }  ///< mm
  [[nodiscard]] double pitch() const { return pitch_; }    ///< mm
  [[nodiscard]] std::int64_t count() const { return count_; }
  /// The slices that show a layer of the plan, consecutive from layer to layer; none when z_pitch leaves it out.
  [[nodiscard]] SliceRange slices(std::size_t layer) const { return {first_[layer], first_[layer + 1]}; }
  /// The slices that show a range of layers.
  [[nodiscard]] SliceRange slices(std::size_t first_layer, std::size_t last_layer) const {
    return {first_[first_layer], first_[last_layer]};
  }
  /// Behind the last slice of the last layer.
  [[nodiscard]] std::int64_t end() const { return first_.back(); }

 private:
  void divide(const LayerPlan& plan, std::string_view format);
  void sample(const LayerPlan& plan, std::string_view format);
  [[nodiscard]] bool fits(const LayerPlan& plan, double quantum);

  double bottom_ = 0.0;
  double pitch_ = 0.0;
  std::int64_t count_ = 0;
  std::vector<std::int64_t> first_;  ///< slice of each layer, and behind the last one
};

}  // namespace lamella
