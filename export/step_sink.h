#pragma once

#include <filesystem>
#include <memory>

#include "slicing/layer_sink.h"

namespace lamella {

struct StepLayersOptions {
  bool hatches = false;  ///< hatch rows besides, as a curve set of lines per layer and material
};

/// One STEP file (ISO 10303-21, AP242) that holds layers instead of solids: per material a product whose shape is a
/// curve set per layer, with layers, colours and material properties (docs/formats/step.md). Loops are polylines, or
/// the curves of the sections where the build keeps them (LayerPlan::curves). Needs contours. Throws as LayerSink says.
[[nodiscard]] std::unique_ptr<LayerSink> make_step_sink(const std::filesystem::path& file,
                                                        const StepLayersOptions& options = {});

}  // namespace lamella
