#pragma once

#include <filesystem>
#include <memory>

#include "slicing/layer_sink.h"

namespace lamella {

/// One 3MF package with the Slice extension: per material an object with a stack of slices, exact to the contours'
/// chord error, and a coarse mesh for programs that don't know slices (docs/formats/3mf.md). Needs contours. Throws as
/// LayerSink says.
[[nodiscard]] std::unique_ptr<LayerSink> make_3mf_sink(const std::filesystem::path& file);

}  // namespace lamella
