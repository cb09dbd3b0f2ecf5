#pragma once

#include <string>

#include "apps/json.h"
#include "slicing/plan/build_plan.h"

namespace lamella::apps {

/// The object of `lamella plan --json` (docs/command.md), but for its outputs.
[[nodiscard]] Json plan_json(const BuildPlan& plan);
/// Totals, materials and tools for people.
[[nodiscard]] std::string plan_text(const BuildPlan& plan);
/// "2 h 05 min", "3 min 20 s", "12.5 s"
[[nodiscard]] std::string time_text(double seconds);

}  // namespace lamella::apps
