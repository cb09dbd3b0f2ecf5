#pragma once

#include <filesystem>
#include <memory>

#include "slicing/layer_sink.h"

namespace lamella {

/// One folder per plain material of grey PNGs, one per layer: black is none of it, white all of it, between them its
/// volume fraction at the pixel's centre in equal steps. `bits` a pixel, 8 or 16.
[[nodiscard]] std::unique_ptr<LayerSink> make_grey_png_sink(const std::filesystem::path& folder, int bits = 8);

/// The same of the share of each pixel that the material covers: along the row exact from the ends of segments, across
/// it the mean over the layer's sub-rows, or that of the line in the pixel's middle where a layer has none. Graded
/// segments count with their fraction at the middle of the pixel's width.
[[nodiscard]] std::unique_ptr<LayerSink> make_coverage_png_sink(const std::filesystem::path& folder, int bits = 8);

}  // namespace lamella
