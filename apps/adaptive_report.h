#pragma once

#include <string>
#include <vector>

#include "apps/assembly.h"
#include "apps/json.h"
#include "slicing/adaptive/adaptive_plan.h"

namespace lamella::apps {

/// The object of docs/command.md.
[[nodiscard]] Json adaptive_json(const AdaptivePlan& plan, const Assembly& assembly, double deviation);
/// The same for people: layers against other ways to lay them, materials, features that no layer meets.
[[nodiscard]] std::string adaptive_text(const AdaptivePlan& plan, const Assembly& assembly, double deviation);
/// Warnings on features that no layer meets.
[[nodiscard]] std::vector<Finding> adaptive_findings(const AdaptivePlan& plan, const Assembly& assembly);

}  // namespace lamella::apps
