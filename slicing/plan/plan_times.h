#pragma once

#include "slicing/plan/build_plan.h"

namespace lamella {

/// Fills the times of the steps of `layer` (docs/methods/build-plan.md, Time), `box` being that of its segments. The
/// layer's overhead isn't among them.
void fill_times(PlanLayer& layer, const Box2& box, bool by_hatch, double pitch_y, const Machine& machine,
                const std::vector<MaterialSettings>& settings);

/// Price of a volume in mm^3; nothing when the price, or a density that it needs, is unknown.
[[nodiscard]] std::optional<double> price_of(double volume, const std::optional<double>& price, PriceUnit per,
                                             const std::optional<double>& density);

}  // namespace lamella
