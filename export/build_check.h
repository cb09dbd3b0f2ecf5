#pragma once

#include <string>

#include "slicing/layer_sink.h"

namespace lamella {

/// What is wrong with a build, empty if nothing: the grid must have a positive finite pitch, a finite origin and 1 to
/// 2^31 - 1 voxels a side, the planned layers finite heights, each solid a known material, graded materials plain
/// components.
/// Exporters size their buffers by these, so they ask first.
[[nodiscard]] std::string find_build_fault(const BuildInfo& info);

/// What is wrong with a layer of a build, empty if nothing: its heights must be those of the plan, it has one raster
/// row per grid row, every row's segments are finite, ascending and disjoint with a known material and solid, and those
/// of graded material have their fractions.
/// Exporters index by these without another look.
[[nodiscard]] std::string find_layer_fault(const Layer& layer, const BuildInfo& info);

/// The same as an ExportError.
void check_build(const BuildInfo& info);
void check_layer(const Layer& layer, const BuildInfo& info);

}  // namespace lamella
