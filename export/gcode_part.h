#pragma once

#include <cstdint>
#include <vector>

#include "slicing/layer_sink.h"
#include "slicing/plan/build_plan.h"

namespace lamella {

/// What of a plan is in a file of some of its layers.
struct GcodePart {
  LayerRange layers;                    ///< within the plan's
  bool is_whole = true;                 ///< all of the plan's layers
  double time = 0.0;                    ///< s
  std::uint64_t tool_changes = 0;       ///< the tool that the file begins with isn't changed to
  std::uint64_t reloads = 0;            ///< by an operator
  std::vector<PlanMaterial> materials;  ///< name, tools, volume, length and mass alone are those of these layers
};

/// The plan's own figures where the range has all its layers.
[[nodiscard]] GcodePart part_of(const BuildPlan& plan, LayerRange range);

}  // namespace lamella
