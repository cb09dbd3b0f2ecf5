// How long a plan of 5 000 layers takes once its layers are measured: the tools' loads and the order of the layers.

#include <benchmark/benchmark.h>
#include <random>

#include "slicing/plan/build_plan.h"
#include "slicing/plan/load_tools.h"
#include "slicing/plan/order_tools.h"
#include "slicing/plan/paces.h"

namespace lamella {
namespace {

constexpr std::size_t kLayers = 5000;

/// Materials come and go slowly, as in a part: each is there with some chance and changes with another.
std::vector<std::vector<std::uint32_t>> random_layers(std::size_t materials, std::size_t most, std::mt19937& random) {
  std::vector<bool> is_there(materials);
  std::vector<std::vector<std::uint32_t>> layers;
  for (std::size_t k = 0; k < kLayers; ++k) {
    layers.emplace_back();
    for (std::size_t m = 0; m < materials; ++m) {
      if (random() % 10 == 0) is_there[m] = !is_there[m];
      if (is_there[m] && layers.back().size() < most) layers.back().push_back(static_cast<std::uint32_t>(m));
    }
  }
  return layers;
}

/// Tools of `kinds` kinds, which differ in changes and speeds.
Machine machine_of(std::size_t tools, std::int64_t kinds) {
  Machine machine;
  machine.name = "bench";
  machine.volume = Vec3::Constant(1000.0);
  machine.pitch = Vec2::Constant(0.1);
  machine.layer_min = machine.layer_max = machine.layer_default = 0.1;
  machine.width = 0.4;
  machine.allows_reloading = true;
  for (std::size_t t = 0; t < tools; ++t) {
    const double speed = 50.0 + static_cast<double>(t % static_cast<std::size_t>(kinds));
    machine.tools.push_back({"tool " + std::to_string(t), {}, speed, 200.0, 5.0});
  }
  const auto kind_of = [&](ToolId tool) { return tool.value() % static_cast<std::size_t>(kinds); };
  for (const ToolId from : machine.tools.ids()) {
    for (const ToolId to : machine.tools.ids()) {
      const double time = 1.0 + static_cast<double>((7 * kind_of(from) + 3 * kind_of(to)) % 5);
      if (from != to) machine.changes.push_back({from, to, time, time});
    }
  }
  return machine;
}

/// A material on a layer, in s by pace.
std::vector<double> times_of(std::uint32_t material, const Machine& machine) {
  std::vector<double> times;
  for (const Pace& pace : paces_of(machine, "material " + std::to_string(material)).all) {
    times.push_back((100.0 + material) / pace.depositing.speed);
  }
  return times;
}

/// A whole plan: materials, tools, kinds of tools; at most 8 materials on a layer.
void plan_build(benchmark::State& state) {
  const auto materials = static_cast<std::size_t>(state.range(0));
  const Machine machine = machine_of(static_cast<std::size_t>(state.range(1)), state.range(2));
  std::mt19937 random(1);
  BuildInfo info;
  info.plan.grid.pitch = Vec3::Constant(0.1);
  for (std::size_t m = 0; m < materials; ++m) info.materials.push_back({"material " + std::to_string(m), 1.0, {}});
  std::vector<LayerStatistics> layers;
  for (const auto& needs : random_layers(materials, std::min<std::size_t>(8, machine.tools.size()), random)) {
    const double z = 0.1 * static_cast<double>(layers.size());
    info.plan.layers.push_back({z, z + 0.05, z + 0.1});
    LayerStatistics& layer = layers.emplace_back();
    layer.index = static_cast<std::uint32_t>(layers.size() - 1);
    layer.z_bottom = z;
    layer.z_top = z + 0.1;
    for (const std::uint32_t material : needs) {
      MaterialStatistics one;
      one.material = MaterialId{material};
      one.area = one.length = 1.0;
      one.segments = 1;
      one.times = times_of(material, machine);
      layer.box.extend(Vec2(1.0, 1.0));
      layer.materials.push_back(one);
    }
  }
  BuildPlan plan;
  for (auto _ : state) {
    plan = make_plan(info, layers, machine);
    benchmark::DoNotOptimize(plan.time);
  }
  state.counters["tool_changes"] = static_cast<double>(plan.tool_changes);
  state.counters["reloads"] = static_cast<double>(plan.reloads);
  state.counters["proved"] = plan.is_optimal() ? 1.0 : 0.0;
  if (!plan.matching) return;
  state.counters["ways"] = static_cast<double>(plan.matching->weighed);
  state.counters["ways_proved"] = plan.matching->is_proved ? 1.0 : 0.0;
}
BENCHMARK(plan_build)
    ->Args({8, 8, 8})
    ->Args({12, 8, 8})
    ->Args({6, 6, 1})
    ->Args({6, 6, 3})
    ->Args({5, 5, 5})
    ->Args({8, 16, 16})
    ->Args({14, 14, 14})
    ->Unit(benchmark::kMillisecond);

/// Loads by dynamic programming: 4 tools, of which each can't hold one of 6 materials.
void search_loads(benchmark::State& state) {
  std::mt19937 random(1);
  LoadProblem problem;
  problem.tools = 4;
  for (std::uint32_t m = 0; m < 6; ++m) problem.holders.push_back(m < 4 ? 0xFU & ~(1U << m) : 0xFU);
  problem.layers = random_layers(6, 3, random);
  LoadSchedule schedule;
  for (auto _ : state) schedule = schedule_loads(problem);
  state.counters["reloads"] = static_cast<double>(schedule.reloads);
  state.counters["proved"] = schedule.reloads == schedule.lower_bound ? 1.0 : 0.0;
}
BENCHMARK(search_loads)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lamella
