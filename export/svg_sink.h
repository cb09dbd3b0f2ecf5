#pragma once

#include <filesystem>
#include <memory>

#include "slicing/layer_sink.h"

namespace lamella {

/// A folder with one SVG picture per layer: what each material fills, as paths in mm, the part seen from above
/// (docs/formats/svg.md). Needs contours. Throws as LayerSink says; ExportError when the folder holds anything else.
[[nodiscard]] std::unique_ptr<LayerSink> make_svg_sink(const std::filesystem::path& folder);

}  // namespace lamella
