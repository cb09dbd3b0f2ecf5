#pragma once

#include <filesystem>
#include <memory>

#include "slicing/layer_sink.h"

namespace lamella {

/// A folder with one VTK file of lines per layer and a series of them, layers.pvd: the hatch rows' segments, or the
/// raster rows' where the build has none, and contours where the build has them, each line with its material and solid
/// (docs/formats/vtp.md). Throws as LayerSink says; ExportError when the folder holds anything else.
[[nodiscard]] std::unique_ptr<LayerSink> make_vtp_sink(const std::filesystem::path& folder);

}  // namespace lamella
