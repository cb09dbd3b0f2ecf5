#pragma once

#include "slicing/layer_sink.h"

namespace lamella {

/// Throws ExportError unless the grid has a positive finite pitch, a finite origin and 1 to 2^31 - 1 voxels a side.
/// Exporters size their buffers by it, so they call it first.
void check_build(const BuildInfo& info);

/// Throws ExportError unless the layer belongs to the build: one raster row per grid row, offsets in order, a known
/// material and solid in every segment. Exporters index by these without another look.
void check_layer(const Layer& layer, const BuildInfo& info);

}  // namespace lamella
