#pragma once

#include <string>
#include <vector>

#include "slicing/slicer.h"
#include "tests/slicing/known_scene.h"
#include "tests/support/solids.h"

/// Scenes of hand-built solids, each of a material of its own, sliced by the span engine.
namespace lamella::test {

struct SlicedScene {
  std::vector<Layer> layers;
  SliceReport report;
};

/// Materials "m0", "m1", ... for the solids in order, priorities as given, 0 for the rest.
inline MaterialTable one_material_each(const Scene& scene, const std::vector<int>& priorities = {}) {
  MaterialTable table;
  for (std::size_t i = 0; i < scene.solids.size(); ++i) {
    const MaterialId id = table.materials.push_back({"m" + std::to_string(i), 1.0, {}});
    table.assignments.push_back({id, i < priorities.size() ? priorities[i] : 0, "test"});
  }
  return table;
}

inline SlicedScene slice_scene(const Scene& scene, const MaterialTable& table, const PlanOptions& plan_options,
                               const SliceOptions& options) {
  const auto measures = measure_solids(scene);
  Box3 bounds;
  for (const SolidMeasure& measure : measures) bounds.extend(measure.bounds);
  const LayerPlan plan = plan_layers(bounds, plan_options);
  Recorder recorder;
  SlicedScene out;
  out.report = slice(scene, table, measures, plan, options, recorder);
  out.layers = recorder.layers;
  return out;
}

}  // namespace lamella::test
