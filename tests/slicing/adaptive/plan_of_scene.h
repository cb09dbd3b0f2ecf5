#pragma once

#include "materials/material_table.h"
#include "model/measure.h"
#include "slicing/adaptive/adaptive_plan.h"

namespace lamella::test {

/// Plans layers of the only material of a scene of one solid from its lowest point.
inline AdaptivePlan plan_of_scene(const Scene& scene, double deviation, double least, double most, double step) {
  MaterialTable table;
  table.materials.push_back({"Resin", std::nullopt});
  table.assignments.push_back({MaterialId{0}, 0, "test"});
  const auto measures = measure_solids(scene);
  AdaptiveOptions options;
  options.deviation = deviation;
  options.range = Interval{least, most};
  options.step = step;
  return plan_adaptive_layers(scene, table, measures, {{SolidId{0}}}, measures[SolidId{0}].bounds.min().z(), options);
}

}  // namespace lamella::test
