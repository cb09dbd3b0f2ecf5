#pragma once

#include <filesystem>
#include <memory>

#include "slicing/layer_sink.h"

namespace lamella {

/// A folder with one SLC 2.0 file (3D Systems) per material that a solid is made of: its contours, little-endian,
/// coordinates as 32-bit floats in mm (docs/formats/slc.md). Needs contours. Throws as LayerSink says; ExportError when
/// the folder holds other files, UsageError when layers have more than 255 thicknesses.
[[nodiscard]] std::unique_ptr<LayerSink> make_slc_sink(const std::filesystem::path& folder);

}  // namespace lamella
