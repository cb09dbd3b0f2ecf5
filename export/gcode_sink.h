#pragma once

#include <filesystem>
#include <memory>

#include "materials/machine.h"
#include "slicing/layer_sink.h"
#include "slicing/plan/build_plan.h"

namespace lamella {

/// How G-code is written.
struct GcodeOptions {
  BuildPlan plan;
  Machine machine;
};

/// Writes machine instructions (docs/formats/gcode.md): the hatch rows of each layer as tracks, tool by tool in the
/// plan's order. A track is extruded from one end of its segments to the other and nowhere else. begin() throws
/// UsageError when the build has no hatch rows, InputError when plan, machine and build don't belong together or the
/// part is larger than the build volume.
[[nodiscard]] std::unique_ptr<LayerSink> make_gcode_sink(const std::filesystem::path& file, GcodeOptions options);

}  // namespace lamella
