#include "slicing/plan/build_plan.h"

#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>
#include <set>

#include "core/xml.h"
#include "materials/material_rules.h"
#include "model/measure.h"
#include "slicing/plan/statistics_sink.h"
#include "slicing/slicer.h"
#include "tests/support/graded_scene.h"
#include "tests/support/layers.h"
#include "tests/support/step_scenes.h"

namespace lamella {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::Not;

Machine shipped(const std::string& name) { return read_machine(test::datasets_dir() / "machines" / (name + ".xml")); }

/// A build of blocks: material m is on layers where `holds[m][k]`, a square of 10 x 10 mm each, side by side.
struct Blocks {
  BuildInfo info;
  std::vector<Layer> layers;

  explicit Blocks(const std::vector<std::string>& holds, const std::vector<std::string>& names, double height = 0.2) {
    Grid grid;
    grid.pitch = Vec3(0.1, 0.2, height);
    grid.size = {100 * static_cast<std::int64_t>(names.size()), 50, static_cast<std::int64_t>(holds[0].size())};
    info = test::make_build(grid, names);
    for (std::int64_t k = 0; k < grid.size[2]; ++k) {
      layers.push_back(test::layer_of_labels(info, k, [&](std::int64_t i, std::int64_t, std::int64_t) {
        const auto m = static_cast<std::size_t>(i / 100);
        return holds[m][static_cast<std::size_t>(k)] == '#' ? static_cast<int>(m) : -1;
      }));
    }
  }

  [[nodiscard]] BuildPlan plan(const Machine& machine) const {
    StatisticsSink sink(machine);
    test::feed(sink, info, layers);
    return make_plan(sink.info(), sink.layers(), machine);
  }
};

/// Two heads for anything; times and prices that are easy to reckon with.
Machine plain_machine() {
  Machine machine;
  machine.name = "plain";
  machine.volume = Vec3(200, 200, 200);
  machine.pitch = Vec2(0.1, 0.2);
  machine.layer_min = 0.1;
  machine.layer_max = 0.3;
  machine.layer_default = 0.2;
  machine.layer_overhead = 1.0;
  machine.width = 0.4;
  machine.change_time = 10.0;
  machine.change_cost = 0.5;
  machine.allows_reloading = true;
  machine.reload_time = 100.0;
  machine.reload_cost = 3.0;
  machine.reload_purge = 7.0;
  machine.cost_per_hour = 36.0;
  for (const char* name : {"left", "right"}) machine.tools.push_back({name, {}, 50.0, 200.0, 5.0});
  machine.settings.push_back({});
  machine.settings.back().price = 20.0;
  machine.settings.back().per = PriceUnit::litre;
  return machine;
}

TEST(BuildPlan, AddsUpVolumesTimesPurgesAndCosts) {
  const Blocks blocks({"##", "##"}, {"a", "b"});
  const BuildPlan plan = blocks.plan(plain_machine());
  ASSERT_EQ(plan.layers.size(), 2U);
  // a b | b a: one change within each layer, none between.
  EXPECT_EQ(plan.tool_changes, 2U);
  EXPECT_EQ(plan.reloads, 0U);
  EXPECT_TRUE(plan.is_optimal());
  EXPECT_NEAR(plan.materials[0].volume, 40.0, 1e-9);
  EXPECT_NEAR(*plan.materials[0].mass, 40.0e-3 * *plan.materials[0].density, 1e-12);
  EXPECT_NEAR(plan.materials[0].length, 2 * 50 * 10.0, 1e-9);
  EXPECT_DOUBLE_EQ(plan.materials[0].purge + plan.materials[1].purge, 10.0);
  // 100 mm^2 by tracks of 0.4 mm: 250 mm at 50 mm/s; 49 steps of 0.2 mm between rows, half of them tracks, at 200 mm/s.
  const double laying = 250.0 / 50.0 + 49 * 0.2 * 0.5 / 200.0;
  EXPECT_NEAR(plan.materials[0].time, 2 * laying, 1e-9);
  EXPECT_NEAR(plan.time, 2 * (1.0 + 2 * laying) + 2 * 10.0, 1e-9);
  EXPECT_NEAR(plan.machine_cost, plan.time / 3600 * 36.0, 1e-9);
  EXPECT_NEAR(plan.cost, plan.machine_cost + 2 * 0.5 + 20e-6 * (80.0 + 10.0), 1e-9);
}

TEST(BuildPlan, AcceleratesEachTrackFromRestToRest) {
  const Blocks blocks({"#"}, {"a"});
  Machine machine = plain_machine();
  machine.acceleration = 500.0;
  // Tracks of 10 mm reach 50 mm/s within 5 mm and lose 0.1 s each; ways of 0.2 mm never reach 200 mm/s.
  const double laying = 0.5 * (50 * (10.0 / 50.0 + 0.1) + 49 * 2.0 * std::sqrt(0.2 / 500.0));
  EXPECT_NEAR(blocks.plan(machine).materials[0].time, laying, 1e-9);
  machine.travel_acceleration = 2000.0;
  const double faster = 0.5 * (50 * (10.0 / 50.0 + 0.1) + 49 * 2.0 * std::sqrt(0.2 / 2000.0));
  EXPECT_NEAR(blocks.plan(machine).materials[0].time, faster, 1e-9);
  machine.technology = Technology::powder_bed;
  EXPECT_NEAR(blocks.plan(machine).materials[0].time, faster, 1e-9);
}

TEST(BuildPlan, SweepsGainTheirSpeedBesideTheBox) {
  const Blocks blocks({"#"}, {"a"});
  Machine machine = plain_machine();
  machine.technology = Technology::material_jetting;
  machine.swath = 4.0;
  machine.turn = 0.25;
  // The box is 10 x 10 mm: three sweeps.
  EXPECT_NEAR(blocks.plan(machine).materials[0].time, 3 * (10.0 / 50.0 + 0.25), 1e-9);
  machine.acceleration = 400.0;
  EXPECT_NEAR(blocks.plan(machine).materials[0].time, 3 * (10.0 / 50.0 + 0.25 + 2 * 0.125), 1e-9);
}

TEST(BuildPlan, GivesAMaterialTheToolInWhichItCostsLeast) {
  // b a | a | a b | a: two changes to a, one to b, and a lays twice as much.
  const Blocks blocks({"####", "#.#."}, {"a", "b"});
  const std::vector<ToolId> left{ToolId{0}};
  const std::vector<ToolId> right{ToolId{1}};
  Machine machine = plain_machine();
  const BuildPlan alike = blocks.plan(machine);
  EXPECT_EQ(alike.materials[0].tools, left);
  EXPECT_EQ(alike.tool_changes, 3U);
  ASSERT_TRUE(alike.matching);
  EXPECT_TRUE(alike.matching->is_proved);

  machine.tools[ToolId{0}].purge = 50.0;
  const BuildPlan by_purge = blocks.plan(machine);
  EXPECT_EQ(by_purge.materials[0].tools, right);
  EXPECT_DOUBLE_EQ(by_purge.materials[0].purge + by_purge.materials[1].purge, 2 * 5.0 + 50.0);
  EXPECT_TRUE(by_purge.matching->is_proved);

  machine.tools[ToolId{0}].purge = 5.0;
  machine.tools[ToolId{0}].speed = 20.0;
  EXPECT_EQ(blocks.plan(machine).materials[0].tools, right);
  // Purge goes before time.
  machine.tools[ToolId{0}].purge = 4.0;
  EXPECT_EQ(blocks.plan(machine).materials[0].tools, left);
}

TEST(BuildPlan, SaysThatAnotherToolMightCostLess) {
  // Nine materials and nine tools of which no two are alike: 362 880 ways.
  std::mt19937 random(3);
  std::vector<std::string> holds(9, std::string(40, '.'));
  std::vector<std::string> names;
  Machine machine = plain_machine();
  machine.tools = {};
  machine.changes.clear();
  for (std::size_t m = 0; m < holds.size(); ++m) {
    names.emplace_back(1, static_cast<char>('a' + m));
    for (char& mark : holds[m]) mark = random() % 2 == 0 ? '#' : '.';
    machine.tools.push_back({"tool " + names.back(), {}, 40.0 + static_cast<double>(m), 200.0, 5.0});
  }
  for (const ToolId from : machine.tools.ids()) {
    for (const ToolId to : machine.tools.ids()) {
      const double purge = 1.0 + static_cast<double>(random() % 50);
      if (from != to) machine.changes.push_back({from, to, 1.0, purge});
    }
  }
  const BuildPlan plan = Blocks(holds, names).plan(machine);
  ASSERT_TRUE(plan.matching);
  EXPECT_FALSE(plan.matching->is_proved);
  EXPECT_GT(plan.matching->weighed, 50U);
  EXPECT_TRUE(plan.is_optimal());  // as to the number of changes, which is the same for all
  double purge = 0.0;
  for (const PlanMaterial& material : plan.materials) purge += material.purge;
  const auto note = std::find_if(plan.findings.begin(), plan.findings.end(), [](const PlanFinding& one) {
    return one.what.find("not proved to be the cheapest of all") != std::string::npos;
  });
  ASSERT_NE(note, plan.findings.end());
  EXPECT_EQ(note->severity, Severity::note);
  EXPECT_THAT(note->what, HasSubstr(std::to_string(plan.tool_changes) + " changes, " + format_double(purge) + " mm^3"));
}

TEST(BuildPlan, SaysThatToolsMustBeReloadedInsteadOfWeighingThem) {
  EXPECT_FALSE(Blocks({"##..", "####", "..##"}, {"a", "b", "c"}).plan(plain_machine()).matching);
}

TEST(BuildPlan, AddsUpHugeTimesAndPurgesWithoutOverflow) {
  Machine machine = plain_machine();
  machine.change_time = 1e9;
  for (MachineTool& tool : machine.tools) tool.purge = 1e9;
  machine.tools[ToolId{0}].speed = 1e-6;
  machine.tools[ToolId{1}].speed = 2e-6;
  const BuildPlan plan = Blocks({std::string(3000, '#'), std::string(3000, '#')}, {"a", "b"}).plan(machine);
  EXPECT_EQ(plan.tool_changes, 3000U);
  EXPECT_TRUE(plan.is_optimal());
  EXPECT_NEAR(plan.materials[0].purge + plan.materials[1].purge, 3e12, 1.0);
}

TEST(BuildPlan, ReloadsATool) {
  const Blocks blocks({"##..", "####", "..##"}, {"a", "b", "c"});
  const BuildPlan plan = blocks.plan(plain_machine());
  EXPECT_EQ(plan.reloads, 1U);
  EXPECT_EQ(plan.reloads_bound, 1U);
  EXPECT_EQ(plan.materials[0].tools, plan.materials[2].tools);
  EXPECT_DOUBLE_EQ(plan.reload_time, 100.0);
  std::vector<std::uint32_t> layers;
  for (const PlanLayer& layer : plan.layers) {
    for (const PlanStep& step : layer.steps) {
      if (step.is_reload) layers.push_back(layer.index);
    }
  }
  EXPECT_EQ(layers, std::vector<std::uint32_t>{2});
  EXPECT_GE(plan.materials[2].purge, 7.0);
}

TEST(BuildPlan, UsesToolsThatLayTheLayersOfAMaterial) {
  Machine machine = plain_machine();
  machine.tools[ToolId{0}].layer_max = 0.15;
  const BuildPlan thick = Blocks({"##"}, {"a"}, 0.2).plan(machine);
  EXPECT_EQ(thick.materials[0].tools, std::vector<ToolId>{ToolId{1}});
  EXPECT_EQ(Blocks({"##"}, {"a"}, 0.15).plan(machine).materials[0].tools, std::vector<ToolId>{ToolId{0}});
  const auto refusal = [&](const Blocks& blocks) -> std::string {
    try {
      (void)blocks.plan(machine);
      return "";
    } catch (const InputError& error) {
      EXPECT_NE(error.hint(), "");
      return error.what();
    }
  };
  EXPECT_THAT(refusal(Blocks({"#", "#"}, {"a", "b"}, 0.2)), HasSubstr("layer 0 needs 2 materials at once (a, b)"));
  machine.tools[ToolId{1}].layer_min = 0.25;
  EXPECT_THAT(refusal(Blocks({"#"}, {"a"}, 0.2)),
              HasSubstr("layer 0 of 0.2 mm has the material 'a', which no tool lays so: 'left' lays 0.1 to 0.15 mm, "
                        "'right' lays 0.25 to 0.3 mm"));
}

/// The blocks' layers with thicknesses of their own.
BuildPlan plan_of_thicknesses(Blocks blocks, const std::vector<double>& thicknesses, const Machine& machine) {
  double z = 0.0;
  for (std::size_t k = 0; k < thicknesses.size(); ++k) {
    const LayerSpan span{z, z + 0.5 * thicknesses[k], z + thicknesses[k]};
    blocks.info.plan.layers[k] = span;
    blocks.layers[k].z_bottom = span.z_bottom;
    blocks.layers[k].z_sample = span.z_sample;
    blocks.layers[k].z_top = span.z_top;
    z = span.z_top;
  }
  return blocks.plan(machine);
}

TEST(BuildPlan, LaysThinAndThickLayersOfAMaterialWithTwoToolsIfItMust) {
  Machine machine = plain_machine();
  machine.tools[ToolId{0}].layer_max = 0.15;
  machine.tools[ToolId{1}].layer_min = 0.15;
  const BuildPlan two = plan_of_thicknesses(Blocks({"###"}, {"a"}), {0.3, 0.1, 0.3}, machine);
  EXPECT_EQ(two.materials[0].tools, (std::vector<ToolId>{ToolId{1}, ToolId{0}}));
  EXPECT_EQ(two.reloads, 0U);
  EXPECT_EQ(two.tool_changes, 2U);
  // One that both lay doesn't change a thing; one tool that lays all is enough.
  const BuildPlan one = plan_of_thicknesses(Blocks({"##"}, {"a"}), {0.15, 0.3}, machine);
  EXPECT_EQ(one.materials[0].tools, std::vector<ToolId>{ToolId{1}});
  EXPECT_EQ(one.tool_changes, 0U);
}

TEST(BuildPlan, RefusesWhatTheMachineCannotDo) {
  const auto message = [](const Blocks& blocks, const Machine& machine) -> std::string {
    try {
      (void)blocks.plan(machine);
      return "";
    } catch (const InputError& error) {
      EXPECT_NE(error.hint(), "");
      return error.what();
    }
  };
  const Blocks three({"##.", "###", ".##"}, {"a", "b", "c"});
  EXPECT_THAT(message(three, plain_machine()), HasSubstr("layer 1 needs 3 materials at once (a, b, c)"));
  Machine fixed = plain_machine();
  fixed.allows_reloading = false;
  EXPECT_THAT(message(Blocks({"#..", ".#.", "..#"}, {"a", "b", "c"}), fixed), HasSubstr("isn't reloaded"));
  Machine picky = plain_machine();
  for (MachineTool& tool : picky.tools) tool.holds = {"a*"};
  EXPECT_THAT(message(Blocks({"#", "#"}, {"a", "b"}), picky), HasSubstr("no tool can hold the material 'b'"));
  EXPECT_THAT(message(Blocks({"#"}, {"a"}, 0.5), plain_machine()), HasSubstr("0.1 to 0.3 mm"));
  Machine dark = shipped("multi_vat");
  dark.settings = {};
  EXPECT_THAT(message(Blocks({"#"}, {"a"}, 0.1), dark), HasSubstr("exposure"));
}

TEST(BuildPlan, NamesTheToolsThatLayersAreTooThickFor) {
  const auto failure = [](const Blocks& blocks, const Machine& machine) -> std::string {
    try {
      (void)blocks.plan(machine);
      return "";
    } catch (const InputError& error) {
      return error.what() + ("; " + error.hint());
    }
  };
  Machine machine = plain_machine();
  const std::string soft = "'" + machine.tools[ToolId{0}].name + "' lays 0.1 to 0.15 mm";
  machine.tools[ToolId{0}].layer_max = 0.15;
  const Blocks both({"#", "#"}, {"a", "b"}, 0.3);
  EXPECT_THAT(failure(both, machine),
              AllOf(HasSubstr("the layer is 0.3 mm thick"), HasSubstr("thickness alone bars tools: " + soft),
                    HasSubstr("--layer-height"), Not(HasSubstr("more tools"))));
  machine.allows_reloading = false;
  const Blocks one_by_one({"#.", ".#"}, {"a", "b"}, 0.3);
  EXPECT_THAT(failure(one_by_one, machine),
              AllOf(HasSubstr("thickness alone bars tools: " + soft), HasSubstr("--layer-height")));
  // Where no thickness would do it is the number of tools.
  const Blocks three({"#", "#", "#"}, {"a", "b", "c"}, 0.3);
  EXPECT_THAT(failure(three, machine), AllOf(HasSubstr("more tools"), Not(HasSubstr(soft))));
  machine.tools[ToolId{0}].layer_max.reset();
  EXPECT_EQ(failure(both, machine), "");
}

TEST(BuildPlan, SaysWhatDoesNotFit) {
  Machine small = plain_machine();
  small.volume = Vec3(15, 200, 200);
  const BuildPlan plan = Blocks({"#", "#"}, {"a", "b"}).plan(small);
  EXPECT_FALSE(plan.fits);
  EXPECT_THAT(plan.findings, Contains(Field(&PlanFinding::what, HasSubstr("the machine has 15 x 200 x 200 mm"))));
  Machine shrinking = plain_machine();
  shrinking.volume = Vec3(20.1, 200, 200);
  EXPECT_TRUE(Blocks({"#", "#"}, {"a", "b"}).plan(shrinking).fits);
  shrinking.shrink = Vec3(0.01, 0, 0);
  EXPECT_FALSE(Blocks({"#", "#"}, {"a", "b"}).plan(shrinking).fits);
  Machine fine = plain_machine();
  fine.pitch = Vec2(0.05, 0.2);
  EXPECT_THAT(Blocks({"#"}, {"a"}).plan(fine).findings,
              Contains(Field(&PlanFinding::what, HasSubstr("pitch along x is 0.1 mm"))));
}

TEST(BuildPlan, FillsTheBoxWithSupportWhereTheMachineDoes) {
  Machine machine = plain_machine();
  machine.support = MachineSupport{"gel", SupportFill::box, 10.0, PriceUnit::litre, std::nullopt};
  const BuildPlan plan = Blocks({"#.", "##"}, {"a", "b"}).plan(machine);
  ASSERT_TRUE(plan.support);
  EXPECT_NEAR(plan.support->volume, 100 * 0.2, 1e-9);
  EXPECT_NEAR(*plan.support->cost, 20.0 * 10e-6, 1e-12);
}

TEST(BuildPlan, OfNothingIsEmpty) {
  const BuildPlan plan = Blocks({"..."}, {"a"}).plan(plain_machine());
  EXPECT_EQ(plan.layers.size(), 3U);
  EXPECT_DOUBLE_EQ(plan.time, 3.0);
  EXPECT_EQ(plan.tool_changes, 0U);
  EXPECT_TRUE(plan.fits);
}

/// A data set sliced as a machine asks.
struct Sliced {
  Scene scene;
  MaterialTable table;
  IdVector<SolidId, SolidMeasure> measures;
  SliceReport report;
  BuildInfo info;
  std::vector<LayerStatistics> layers;

  Sliced(const std::string& name, const Machine& machine, double coarser) {
    const auto folder = test::datasets_dir() / name;
    scene = test::read_scene(folder / (name + ".step"));
    table = assign_materials(scene, read_material_rules(folder / "materials.xml"));
    measures = measure_solids(scene);
    Box3 bounds;
    for (const SolidMeasure& one : measures) bounds.extend(one.bounds);
    PlanOptions options;
    options.pitch = Vec2(machine.pitch * coarser);
    options.layer_height = machine.layer_max;
    StatisticsSink sink(machine);
    report = slice(scene, table, measures, plan_layers(bounds, options), {}, sink);
    info = sink.info();
    layers = sink.layers();
  }
};

class PlannedDataset : public ::testing::TestWithParam<std::string> {};

// Volumes are the slice report's, and each solid's, summed up, is its exact volume within the bound of command.md.
TEST_P(PlannedDataset, VolumesAndMassesAreThoseOfTheReportAndOfTheExactSolids) {
  const Machine machine = shipped("multi_nozzle");
  Machine anything = machine;
  anything.tools = {};
  for (int t = 0; t < 8; ++t) anything.tools.push_back({"tool " + std::to_string(t), {}, 50.0, 200.0, 5.0});
  anything.changes.clear();
  const Sliced sliced(GetParam(), anything, 2.0);
  const BuildPlan plan = make_plan(sliced.info, sliced.layers, anything);
  ASSERT_EQ(plan.materials.size(), sliced.table.materials.size());
  double area_bound = 0.0;
  double exact = 0.0;
  double planned = 0.0;
  for (const SolidReport& solid : sliced.report.solids) {
    area_bound += solid.quadrature_bound;
    exact += solid.volume_exact;
  }
  for (const PairReport& pair : sliced.report.overlaps) exact -= pair.volume;
  for (std::size_t m = 0; m < plan.materials.size(); ++m) {
    const MaterialReport& reported = sliced.report.materials[MaterialId{m}];
    EXPECT_NEAR(plan.materials[m].volume, reported.volume, 1e-9 * (1.0 + reported.volume));
    EXPECT_NEAR(*plan.materials[m].mass, reported.mass, 1e-9 * (1.0 + reported.mass));
    planned += plan.materials[m].volume;
  }
  EXPECT_NEAR(planned, exact, area_bound);
  EXPECT_GT(planned, 0.0);
}

/// A material none of whose solids overlaps another one is exactly as large as its solids.
TEST_P(PlannedDataset, AMaterialThatOverlapsNothingHasTheExactVolumeOfItsSolids) {
  Machine machine = shipped("multi_nozzle");
  machine.tools = {};
  for (int t = 0; t < 8; ++t) machine.tools.push_back({"tool " + std::to_string(t), {}, 50.0, 200.0, 5.0});
  machine.changes.clear();
  const Sliced sliced(GetParam(), machine, 2.0);
  const BuildPlan plan = make_plan(sliced.info, sliced.layers, machine);
  std::set<MaterialId> overlapping;
  for (const PairReport& pair : sliced.report.overlaps) {
    overlapping.insert(sliced.info.solids[pair.first].material);
    overlapping.insert(sliced.info.solids[pair.second].material);
  }
  for (std::size_t m = 0; m < plan.materials.size(); ++m) {
    if (overlapping.contains(MaterialId{m})) continue;
    double exact = 0.0;
    double bound = 0.0;
    for (const SolidId s : sliced.info.solids.ids()) {
      if (sliced.info.solids[s].material != MaterialId{m}) continue;
      exact += sliced.report.solids[s].volume_exact;
      bound += sliced.report.solids[s].quadrature_bound;
    }
    EXPECT_NEAR(plan.materials[m].volume, exact, bound) << plan.materials[m].name;
    EXPECT_NEAR(*plan.materials[m].mass, exact * *plan.materials[m].density * 1e-3,
                bound * *plan.materials[m].density * 1e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(Datasets, PlannedDataset,
                         ::testing::Values("overmoulded_grip", "connector", "nested_spheres", "pcb_stack",
                                           "interpenetrating_bodies", "bone_screw", "mould_insert"));

TEST(BuildPlan, FourMachinesPlanTheConnectorDifferently) {
  std::set<double> times;
  std::set<std::uint64_t> changes;
  for (const std::string name : {"material_jetting", "multi_vat", "multi_nozzle", "multi_powder"}) {
    const Machine machine = shipped(name);
    const Sliced sliced("connector", machine, 1.0);
    const BuildPlan plan = make_plan(sliced.info, sliced.layers, machine);
    EXPECT_TRUE(plan.fits);
    EXPECT_TRUE(plan.is_optimal());
    EXPECT_EQ(plan.tool_changes == 0, name == "material_jetting");
    EXPECT_EQ(plan.support.has_value(), name == "material_jetting");
    times.insert(plan.time);
    changes.insert(plan.tool_changes);
  }
  EXPECT_EQ(times.size(), 4U);
  EXPECT_EQ(changes.size(), 4U);
}

TEST(BuildPlan, CreditsTheComponentsOfGradedMaterials) {
  const test::GradedScene graded(0.25, false);
  Machine machine = shipped("material_jetting");
  machine.layer_min = machine.layer_default = 0.25;
  machine.layer_max = 1.0;
  machine.layer_step = 0.0;
  StatisticsSink statistics(machine);
  const SliceReport report = graded.slice_into(statistics);
  const BuildPlan plan = make_plan(statistics.info(), statistics.layers(), machine);
  for (std::size_t m = 0; m < plan.materials.size(); ++m) {
    const double expected = report.materials[MaterialId{m}].volume;
    EXPECT_NEAR(plan.materials[m].volume, expected, 1e-9 * (1.0 + expected)) << plan.materials[m].name;
    EXPECT_EQ(plan.materials[m].tools.empty(), graded.table.materials[MaterialId{m}].is_graded());
  }
  EXPECT_GT(plan.materials[0].volume, 100.0);
}

TEST(BuildPlan, RefusesAMixtureWhereOneMaterialIsLaidDownAtATime) {
  const test::GradedScene graded(0.2, false);
  const Machine machine = shipped("multi_nozzle");
  StatisticsSink statistics(machine);
  (void)graded.slice_into(statistics);
  try {
    (void)make_plan(statistics.info(), statistics.layers(), machine);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("'along z'"));
    EXPECT_THAT(error.what(), HasSubstr("extrusion"));
    EXPECT_THAT(error.hint(), HasSubstr("material jetting"));
  }
}

}  // namespace
}  // namespace lamella
