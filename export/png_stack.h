#pragma once

#include <filesystem>
#include <memory>

#include "slicing/layer_sink.h"

namespace lamella {

/// One folder per material of 1-bit PNGs, one per layer, row 0 at the top is y-max; pHYs set; with layers.csv beside.
[[nodiscard]] std::unique_ptr<LayerSink> make_png_sink(const std::filesystem::path& folder);

/// One indexed PNG per layer: index 0 is void (transparent black), index 1 + id is the material in its colour.
[[nodiscard]] std::unique_ptr<LayerSink> make_indexed_png_sink(const std::filesystem::path& folder);

}  // namespace lamella
