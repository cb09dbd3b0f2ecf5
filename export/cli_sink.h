#pragma once

#include <filesystem>
#include <memory>

#include "slicing/layer_sink.h"

namespace lamella {

/// One CLI 2.0 file (Common Layer Interface): hatches from the hatch rows, or from the raster rows where the build has
/// none, contours as polylines where the build has them, one label per material (docs/formats/cli.md). Throws as
/// LayerSink says.
[[nodiscard]] std::unique_ptr<LayerSink> make_cli_sink(const std::filesystem::path& file);

/// The same in the format's binary form: little-endian long commands, coordinates as 32-bit floats in mm.
[[nodiscard]] std::unique_ptr<LayerSink> make_binary_cli_sink(const std::filesystem::path& file);

}  // namespace lamella
