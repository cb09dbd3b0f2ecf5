#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "model/measure.h"
#include "slicing/adaptive/adaptive_plan.h"
#include "tests/support/paths.h"
#include "tests/support/solids.h"

namespace lamella::test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Layers of 0.05 to 0.5 mm in steps of 0.05 mm; a fine tool for soft materials, a coarse one for hard ones.
Machine two_tools() {
  Machine machine;
  machine.layer_min = 0.05;
  machine.layer_max = 0.5;
  machine.layer_step = 0.05;
  machine.source = "m.xml";
  machine.tools.push_back({"fine", {"Soft*"}, 50.0, 200.0, 5.0, std::nullopt, 0.15});
  machine.tools.push_back({"coarse", {"Hard*"}, 50.0, 200.0, 5.0, 0.3, std::nullopt});
  return machine;
}

/// Two boxes of 10 x 10 mm, one material each: the lower or left one from z = 0 to 3.
struct Boxes {
  Scene scene;
  MaterialTable table;

  Boxes(const char* first, const char* second, const Vec3& of_second) {
    add_box(scene, Vec3::Zero(), Vec3(10, 10, 3));
    add_box(scene, of_second, of_second + Vec3(10, 10, 3));
    for (const char* name : {first, second}) {
      table.assignments.push_back({MaterialId{table.materials.size()}, 0, "test"});
      table.materials.push_back({name, std::nullopt});
    }
  }

  [[nodiscard]] AdaptivePlan plan(const Machine& machine, std::optional<Interval> range = std::nullopt) const {
    AdaptiveOptions options;
    options.deviation = 0.1;
    options.range = range;
    options.machine = machine;
    const std::vector<SolidId> solids{SolidId{0}, SolidId{1}};
    return plan_adaptive_layers(scene, table, measure_solids(scene), solids, 0.0, options);
  }

  /// "what | where | hint" of what the planner refuses.
  [[nodiscard]] std::string refusal(const Machine& machine, std::optional<Interval> range = std::nullopt) const {
    try {
      (void)plan(machine, range);
      return "";
    } catch (const InputError& error) {
      return std::string(error.what()) + " | " + error.where() + " | " + error.hint();
    }
  }
};

const Vec3 kAbove(0, 0, 3);
const Vec3 kBeside(20, 0, 0);

/// Least and largest thickness of the layers between two heights.
Interval thicknesses(const AdaptivePlan& plan, double low, double high) {
  Interval out{1e9, 0.0};
  for (const LayerSpan& layer : plan.layers) {
    if (layer.z_bottom < low - 1e-9 || layer.z_top > high + 1e-9) continue;
    out.lo = std::min(out.lo, layer.z_top - layer.z_bottom);
    out.hi = std::max(out.hi, layer.z_top - layer.z_bottom);
  }
  return out;
}

TEST(MachineLayers, ToolsLimitLayersOnlyWhereTheirMaterialIs) {
  const AdaptivePlan plan = Boxes("Soft", "Hard", kAbove).plan(two_tools());
  EXPECT_NEAR(thicknesses(plan, 0.0, 3.0).hi, 0.15, 1e-9);
  EXPECT_NEAR(thicknesses(plan, 3.0, 6.0).lo, 0.5, 1e-9);
  EXPECT_EQ(plan.layers.size(), 20U + 6U);
  const MaterialLayers& soft = plan.materials[MaterialId{0}].asked;
  EXPECT_NEAR(soft.thickness().lo, 0.05, 1e-9);
  EXPECT_NEAR(soft.thickness().hi, 0.15, 1e-9);
  EXPECT_THAT(soft.tools, ElementsAre("fine"));
}

TEST(MachineLayers, AgreeWhereToolsHaveThicknessesInCommon) {
  Machine machine = two_tools();
  machine.tools[ToolId{0}].layer_max = 0.35;
  const AdaptivePlan plan = Boxes("Soft", "Hard", kBeside).plan(machine);
  EXPECT_NEAR(thicknesses(plan, 0.0, 3.0).lo, 0.3, 1e-9);
  EXPECT_NEAR(thicknesses(plan, 0.0, 3.0).hi, 0.35, 1e-9);
}

TEST(MachineLayers, ClashesNameBothMaterialsTheirRangesAndTools) {
  EXPECT_THAT(Boxes("Soft", "Hard", kBeside).refusal(two_tools()),
              AllOf(HasSubstr("no layer suits the materials 'Soft' and 'Hard' from z = 0 mm on"),
                    HasSubstr("'Soft' takes 0.05 to 0.15 mm (tool 'fine')"),
                    HasSubstr("'Hard' takes 0.3 to 0.5 mm (tool 'coarse')"), HasSubstr("| z = 0 mm to 0.5 mm |"),
                    HasSubstr("| give them a thickness in common")));
}

TEST(MachineLayers, ClashOnlyFromWhereBothArePresent) {
  EXPECT_THAT(Boxes("Soft", "Hard", Vec3(20, 0, 1.5)).refusal(two_tools()), HasSubstr("from z = 1.5 mm on"));
}

TEST(MachineLayers, TheRangeOfTheCommandCountsToo) {
  EXPECT_NEAR(thicknesses(Boxes("Soft", "Hard", kAbove).plan(two_tools(), Interval{0.1, 0.4}), 3.0, 6.0).hi, 0.4, 1e-9);
  EXPECT_THAT(Boxes("Soft", "Hard", kAbove).refusal(two_tools(), Interval{0.2, 0.4}),
              AllOf(HasSubstr("no layer suits the material 'Soft'"), HasSubstr("thicknesses would be none")));
}

TEST(MachineLayers, AreThoseOfAnyToolThatCanHoldTheMaterial) {
  Machine machine = two_tools();
  machine.tools.push_back({"any", {}, 50.0, 200.0, 5.0});
  const AdaptivePlan plan = Boxes("Soft", "Hard", kBeside).plan(machine);
  EXPECT_EQ(plan.layers.size(), 6U);
  EXPECT_TRUE(plan.materials[MaterialId{0}].asked.tools.empty());
}

TEST(MachineLayers, MayLeaveAGapBetweenTools) {
  Machine machine = two_tools();
  for (MachineTool& tool : machine.tools) tool.holds = {};
  const Boxes boxes("Soft", "Soft", kAbove);
  const AdaptivePlan plan = boxes.plan(machine);
  ASSERT_EQ(plan.materials[MaterialId{0}].asked.ranges.size(), 2U);
  EXPECT_FALSE(plan.materials[MaterialId{0}].asked.takes(0.2));
  EXPECT_EQ(thickness_text(plan.materials[MaterialId{0}].asked),
            "0.05 to 0.15 or 0.3 to 0.5 mm (tools 'fine', 'coarse')");
  EXPECT_THAT(boxes.refusal(machine, Interval{0.2, 0.25}), HasSubstr("no layer suits the material 'Soft'"));
}

TEST(MachineLayers, OfAGradedMaterialAreThoseOfItsComponents) {
  Boxes boxes("Soft", "Hard", kAbove);
  Material mixed{"Mixed", std::nullopt};
  mixed.components = {MaterialId{0}, MaterialId{1}};
  boxes.table.materials.push_back(mixed);
  boxes.table.assignments[SolidId{1}].material = MaterialId{2};
  EXPECT_THAT(boxes.refusal(two_tools()), HasSubstr("no layer suits the material 'Mixed'"));
  Machine agreeing = two_tools();
  agreeing.tools[ToolId{0}].layer_max = 0.3;
  EXPECT_NEAR(thicknesses(boxes.plan(agreeing), 3.0, 6.0).hi, 0.3, 1e-9);
}

TEST(MachineLayers, NeedAToolThatCanHoldTheMaterial) {
  EXPECT_THAT(Boxes("Soft", "Cork", kAbove).refusal(two_tools()),
              AllOf(HasSubstr("no tool can hold the material 'Cork' | m.xml"), HasSubstr("add <holds")));
}

}  // namespace
}  // namespace lamella::test
