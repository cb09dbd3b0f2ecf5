#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "slicing/layer.h"

namespace lamella {

/// What a layer is judged by: how many rows it must have and how many materials and solids there are.
struct LayerLimits {
  std::size_t rows = 0;
  std::size_t materials = 0;
  std::size_t solids = 0;
};

/// The first thing wrong with `layer`, or nothing: heights that do not ascend, row starts that are not monotone or do
/// not end at the number of segments, segments that are empty, not finite or not in order, ids out of range.
[[nodiscard]] std::optional<std::string> find_layer_fault(const Layer& layer, const LayerLimits& limits);

}  // namespace lamella
