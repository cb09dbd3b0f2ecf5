#pragma once

#include <memory>
#include <vector>

#include "materials/expression_field.h"
#include "materials/position_field.h"
#include "slicing/slicer.h"
#include "tests/support/solids.h"

namespace lamella::test {

/// Fractions of two components from all of the first at 0 to all of the second at `end` mm.
inline Stops ramp(double end) {
  Stops stops(2);
  stops.add(0.0, std::vector<double>{1.0, 0.0}, "");
  stops.add(end, std::vector<double>{0.0, 1.0}, "");
  return stops;
}

/// A box [0, 8]^3 graded along z, a torus beside it graded by its depth, a sphere by a formula with a jump in it, and a
/// plain box. Materials: A, B, then the three graded ones.
struct GradedScene {
  Scene scene;
  MaterialTable table;
  IdVector<SolidId, SolidMeasure> measures;
  LayerPlan plan;

  explicit GradedScene(double pitch = 0.25, bool hatch = true) {
    add_box(scene, Vec3(0, 0, 0), Vec3(8, 8, 8), {{}, "box", "", {}});
    add_torus(scene, 5.0, 2.0, {Placement::at(Vec3(18, 4, 4)), "torus", "", {}});
    add_sphere(scene, 3.0, {Placement::at(Vec3(4, 16, 4)), "sphere", "", {}});
    add_box(scene, Vec3(12, 14, 1), Vec3(16, 18, 7), {{}, "plain", "", {}});
    table.materials.push_back({"A", 1.0, {0.9, 0.2, 0.1}});
    table.materials.push_back({"B", 3.0, {0.1, 0.3, 0.9}});
    add_graded("along z", make_axis_field(Vec3::Zero(), Vec3::UnitZ(), ramp(8.0)));
    add_graded("skin", make_distance_field(std::nullopt, ramp(1.5), "here"));
    add_graded("formula", make_expression_field({{"x > 4 ? 0.8 : 0.5 + 0.3 * sin(y)", "here"}}, 2, 0.0));
    for (const std::size_t material : {2, 3, 4, 1}) table.assignments.push_back({MaterialId{material}, 0, ""});
    measures = measure_solids(scene);
    Box3 bounds;
    for (const SolidMeasure& measure : measures) bounds.extend(measure.bounds);
    PlanOptions options;
    options.pitch = Vec2(pitch, pitch);
    options.layer_height = pitch;
    if (hatch) options.hatch = HatchLattice{0.7, 0.3, 0.4};
    plan = plan_layers(bounds, options);
  }

  SliceReport slice_into(LayerSink& sink, int threads = 1) const {
    SliceOptions options;
    options.threads = threads;
    return slice(scene, table, measures, plan, options, sink);
  }

 private:
  void add_graded(const char* name, std::shared_ptr<const FieldSource> field) {
    table.materials.push_back({name, {}, {0.5, 0.5, 0.5}, {MaterialId{0}, MaterialId{1}}, std::move(field)});
  }
};

}  // namespace lamella::test
