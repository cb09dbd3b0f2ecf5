#pragma once

#include <optional>
#include <string>

#include "slicing/adaptive/layer_rules.h"
#include "slicing/layer_plan.h"

namespace lamella::apps {

/// Takes pitch and layer height from the machine file, if any, where `plan` leaves them open. Throws InputError on a
/// file that can't be read, UsageError when the layer height asked for doesn't suit the machine. Adaptive layers get
/// the machine instead of a layer height.
void apply_machine(const std::optional<std::string>& file, PlanOptions& plan, std::optional<AdaptiveOptions>& adaptive);

}  // namespace lamella::apps
