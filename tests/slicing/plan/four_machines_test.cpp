/// Every shipped data set on every shipped machine: a plan, or a refusal that says what is to blame.

#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <numeric>
#include <set>

#include "materials/material_rules.h"
#include "model/measure.h"
#include "slicing/plan/build_plan.h"
#include "slicing/plan/statistics_sink.h"
#include "slicing/slicer.h"
#include "tests/support/step_scenes.h"

namespace lamella {
namespace {

using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;

const std::vector<std::string> kMachines{"material_jetting", "multi_vat", "multi_nozzle", "multi_powder"};

enum class Outcome { built, reloaded, too_large, crowded };

/// What isn't built without an operator (docs/methods/build-plan.md, "One part, four machines").
const std::map<std::pair<std::string, std::string>, Outcome> kExceptions{
    {{"gradient_lens", "multi_nozzle"}, Outcome::crowded},   {{"gradient_lens", "multi_powder"}, Outcome::crowded},
    {{"housing_102", "multi_powder"}, Outcome::crowded},     {{"impeller_135", "multi_vat"}, Outcome::too_large},
    {{"impeller_135", "multi_nozzle"}, Outcome::reloaded},   {{"impeller_135", "multi_powder"}, Outcome::crowded},
    {{"mould_insert", "multi_powder"}, Outcome::crowded},    {{"nested_spheres", "multi_powder"}, Outcome::crowded},
    {{"overmoulded_grip", "multi_vat"}, Outcome::too_large}, {{"overmoulded_grip", "multi_powder"}, Outcome::crowded},
    {{"pcb_stack", "multi_nozzle"}, Outcome::reloaded},      {{"pcb_stack", "multi_powder"}, Outcome::reloaded},
    {{"touching_boxes", "multi_powder"}, Outcome::reloaded}};

std::vector<std::string> data_sets() {
  std::vector<std::string> names;
  for (const auto& file : test::dataset_files()) names.push_back(file.stem().string());
  return names;
}

/// A data set, read once for all machines.
struct DataSet {
  Scene scene;
  MaterialTable table;
  IdVector<SolidId, SolidMeasure> measures;

  explicit DataSet(const std::string& name) {
    const auto folder = test::datasets_dir() / name;
    scene = test::read_scene(folder / (name + ".step"));
    table = assign_materials(scene, read_material_rules(folder / "materials.xml"));
    measures = measure_solids(scene);
  }

  /// On the machine's own layers, by coarse rows.
  SliceReport slice_into(LayerSink& sink, const Machine& machine) const {
    Box3 bounds;
    for (const SolidMeasure& one : measures) bounds.extend(one.bounds);
    PlanOptions options;
    options.pitch = Vec2(0.4, 0.4);
    options.layer_height = machine.layer_default;
    return slice(scene, table, measures, plan_layers(bounds, options), {}, sink);
  }
};

/// By trying every way: whether each material of a layer can have a tool of its own.
bool has_room(const LayerStatistics& layer, const Machine& machine, const IdVector<MaterialId, Material>& materials) {
  std::vector<std::size_t> tools(machine.tools.size());
  std::iota(tools.begin(), tools.end(), std::size_t{0});
  if (layer.materials.size() > tools.size()) return false;
  const double height = layer.z_top - layer.z_bottom;
  do {
    bool fits = true;
    for (std::size_t i = 0; fits && i < layer.materials.size(); ++i) {
      const ToolId tool{tools[i]};
      fits = machine.can_hold(tool, materials[layer.materials[i].material].name) &&
             takes_height(machine.layers_of(tool), height);
    }
    if (fits) return true;
  } while (std::next_permutation(tools.begin(), tools.end()));
  return false;
}

/// Steps use tools that can do it, each once a layer, for all that was sliced.
void expect_sound(const BuildPlan& plan, const Machine& machine, const StatisticsSink& sliced,
                  const SliceReport& report) {
  ASSERT_EQ(plan.layers.size(), sliced.layers().size());
  EXPECT_GT(plan.time, 0.0);
  EXPECT_TRUE(plan.is_optimal());
  for (std::size_t k = 0; k < plan.layers.size(); ++k) {
    const PlanLayer& layer = plan.layers[k];
    ASSERT_EQ(layer.steps.size(), sliced.layers()[k].materials.size());
    std::set<ToolId> tools;
    for (const PlanStep& step : layer.steps) {
      EXPECT_TRUE(tools.insert(step.tool).second);
      EXPECT_TRUE(machine.can_hold(step.tool, plan.materials[step.material.value()].name));
      EXPECT_TRUE(takes_height(machine.layers_of(step.tool), layer.z_top - layer.z_bottom));
    }
  }
  for (std::size_t m = 0; m < plan.materials.size(); ++m) {
    const double volume = report.materials[MaterialId{m}].volume;
    EXPECT_NEAR(plan.materials[m].volume, volume, 1e-9 * (1.0 + volume)) << plan.materials[m].name;
  }
}

/// The layer that the message names has no room, and its materials are named.
void expect_true_refusal(const InputError& error, const Machine& machine, const StatisticsSink& sliced) {
  const std::string what = error.what();
  EXPECT_NE(error.hint(), "");
  ASSERT_THAT(what, HasSubstr("layer "));
  const std::size_t index = std::stoul(what.substr(what.find("layer ") + 6));
  const LayerStatistics& layer = sliced.layers().at(index);
  EXPECT_FALSE(has_room(layer, machine, sliced.info().materials)) << what;
  for (const MaterialStatistics& one : layer.materials) {
    EXPECT_THAT(what, HasSubstr(sliced.info().materials[one.material].name));
  }
  EXPECT_THAT(what, HasSubstr(std::to_string(layer.materials.size()) + " materials at once"));
}

Outcome judge(const DataSet& data_set, const std::string& name) {
  const Machine machine = read_machine(test::datasets_dir() / "machines" / (name + ".xml"));
  StatisticsSink sliced(machine);
  const SliceReport report = data_set.slice_into(sliced, machine);
  try {
    const BuildPlan plan = make_plan(sliced.info(), sliced.layers(), machine);
    expect_sound(plan, machine, sliced, report);
    if (!plan.fits) {
      EXPECT_TRUE((plan.size.array() > machine.volume.array()).any());
      EXPECT_THAT(plan.findings, Contains(Field(&PlanFinding::what, HasSubstr("the machine has "))));
      return Outcome::too_large;
    }
    return plan.reloads > 0 ? Outcome::reloaded : Outcome::built;
  } catch (const InputError& error) {
    expect_true_refusal(error, machine, sliced);
    return Outcome::crowded;
  }
}

class OnFourMachines : public ::testing::TestWithParam<std::string> {};

TEST_P(OnFourMachines, IsPlannedOrRefusedForAReasonThatIsNamed) {
  const DataSet data_set(GetParam());
  for (const std::string& machine : kMachines) {
    const auto exception = kExceptions.find({GetParam(), machine});
    const Outcome expected = exception == kExceptions.end() ? Outcome::built : exception->second;
    EXPECT_EQ(judge(data_set, machine), expected) << GetParam() << " on " << machine;
  }
}

INSTANTIATE_TEST_SUITE_P(DataSets, OnFourMachines, ::testing::ValuesIn(data_sets()),
                         [](const auto& one) { return one.param; });

}  // namespace
}  // namespace lamella
