#pragma once

#include <optional>
#include <span>
#include <string>

#include "apps/assembly.h"
#include "slicing/accuracy/choose_lattice.h"
#include "slicing/adaptive/layer_rules.h"
#include "slicing/layer_plan.h"

namespace lamella::apps {

/// Takes pitch and layer height from the machine file, if any, where `plan` leaves them open. Throws InputError on a
/// file that can't be read, UsageError when the layer height asked for doesn't suit the machine. Adaptive layers, if
/// any, get the machine instead of a layer height.
void apply_machine(const std::optional<std::string>& file, PlanOptions& plan, AdaptiveOptions* adaptive = nullptr);

/// Gives `plan` the pitch and layer height for an accuracy in mm, on the machine if there is one, and warns when the
/// STEP file itself is less accurate. Throws as choose_lattice() and read_machine() do.
accuracy::LatticeChoice apply_accuracy(const Session& session, const Assembly& assembly,
                                       std::span<const SolidId> solids, double accuracy,
                                       const std::optional<std::string>& machine, PlanOptions& plan);
/// What adaptive layers with the pitch and the deviation that an accuracy in mm left them guarantee. `deviation` is
/// their largest, in mm. Warns when the STEP file, or what the library allows a material, is less accurate.
accuracy::LatticeChoice adaptive_accuracy(const Session& session, const Assembly& assembly,
                                          std::span<const SolidId> solids, double accuracy, const LayerPlan& plan,
                                          double deviation);
/// One line for people.
[[nodiscard]] std::string accuracy_line(const accuracy::LatticeChoice& choice);
/// Adds "accuracy":{"wanted","surface_bound","offset_bound","file_tolerance"} if there is a choice.
[[nodiscard]] Json with_accuracy(Json object, const std::optional<accuracy::LatticeChoice>& choice);

}  // namespace lamella::apps
