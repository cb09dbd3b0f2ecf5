#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "materials/material_table.h"
#include "slicing/layer.h"

namespace lamella {

/// What a layer is judged by: how many rows it must have and how many materials and solids there are.
struct LayerLimits {
  std::size_t rows = 0;
  std::size_t materials = 0;
  std::size_t solids = 0;
  std::vector<std::size_t> components;  ///< of each material, 0 where it isn't graded
};

[[nodiscard]] LayerLimits make_layer_limits(std::int64_t rows, const IdVector<MaterialId, Material>& materials,
                                            std::size_t solids);

/// What is wrong with the mixtures of rows whose segments are in order, or nothing: graded segments without knots,
/// knots that are out of order or beyond their segment, fractions that don't add up to 1.
[[nodiscard]] std::optional<std::string> find_mixtures_fault(const SegmentRows& rows, const LayerLimits& limits);

/// The first thing wrong with `layer`, or nothing: heights that do not ascend, row starts that are not monotone or do
/// not end at the number of segments, segments that are empty, not finite or not in order, loops of contours that are
/// out of order or too short, ids out of range, and find_mixtures_fault().
[[nodiscard]] std::optional<std::string> find_layer_fault(const Layer& layer, const LayerLimits& limits);

}  // namespace lamella
