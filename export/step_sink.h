#pragma once

#include <filesystem>
#include <memory>

#include "slicing/layer_sink.h"

namespace lamella {

/// One STEP file (ISO 10303-21, AP242) that holds layers instead of solids: per material a product whose shape is a
/// curve set of polylines per layer, with layers, colours and material properties (docs/formats/step.md). Needs
/// contours. Throws as LayerSink says.
[[nodiscard]] std::unique_ptr<LayerSink> make_step_sink(const std::filesystem::path& file);

}  // namespace lamella
