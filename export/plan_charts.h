#pragma once

#include <string>

#include "slicing/plan/build_plan.h"

namespace lamella {

/// Inline SVG, each a chart over the height z in mm. Layers beyond a few hundred share a column; it shows the largest
/// of their values.
[[nodiscard]] std::string area_chart(const BuildPlan& plan);
[[nodiscard]] std::string time_chart(const BuildPlan& plan);
/// Which material each tool lays down where; reloads are marked.
[[nodiscard]] std::string tool_chart(const BuildPlan& plan);

}  // namespace lamella
