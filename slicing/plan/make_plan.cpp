#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/xml.h"
#include "slicing/compensated_sum.h"
#include "slicing/plan/build_plan.h"
#include "slicing/plan/load_tools.h"
#include "slicing/plan/order_tools.h"
#include "slicing/plan/plan_times.h"
#include "slicing/plan/tool_needs.h"
#include "slicing/plan/weigh_matchings.h"

namespace lamella {

namespace {

/// Whole numbers of a unit, of which no sum that is asked for reaches 2^50: a millionth, or more where sums are huge.
class WholeNumbers {
 public:
  explicit WholeNumbers(double largest_sum)
      : per_one_(std::min(1e6, std::ldexp(1.0, 49) / std::max(largest_sum, 1.0))) {}
  [[nodiscard]] std::int64_t of(double value) const { return std::llround(value * per_one_); }
  [[nodiscard]] double value(std::int64_t number) const { return static_cast<double>(number) / per_one_; }

 private:
  double per_one_;
};

class Planner {
 public:
  Planner(const BuildInfo& info, const std::vector<LayerStatistics>& layers, const Machine& machine)
      : info_(info), layers_(layers), machine_(machine), times_(machine, info.materials) {
    plan_.machine = machine.name;
    plan_.technology = machine.technology;
    plan_.currency = machine.currency;
    plan_.by_hatch = info.plan.hatch.has_value();
    plan_.width = machine.width;
    plan_.turn = info.turn;
    for (const MachineTool& tool : machine.tools) plan_.tools.push_back(tool.name);
    for (const Material& material : info.materials) {
      PlanMaterial& planned = plan_.materials.emplace_back();
      planned.name = material.name;
      planned.color = material.color;
      planned.density = material.density;
    }
  }

  [[nodiscard]] BuildPlan run() {
    check_heights();
    check_graded();
    const LoadSchedule loads = load();
    const ToolOrder order = order_steps(loads);
    lay_out(loads, order);
    check_exposures();
    add_times();
    add_materials();
    add_support();
    add_costs();
    measure_size();
    plan_.findings = find_misfits(plan_, info_, machine_);
    if (weighing_) plan_.findings.push_back(*weighing_);
    return std::move(plan_);
  }

 private:
  /// The heads of material jetting lay all materials down in one sweep: there is nothing to change.
  [[nodiscard]] bool all_at_once() const { return machine_.technology == Technology::material_jetting; }

  void check_heights() const {
    for (const LayerSpan& span : info_.plan.layers) {
      const std::string fault = layer_height_fault(machine_, span.z_top - span.z_bottom);
      if (fault.empty()) continue;
      // Without the rounding of both borders.
      const double thickness = std::round(1e6 * (span.z_top - span.z_bottom)) / 1e6;
      throw InputError("the build's layers of " + format_double(thickness) + " mm don't suit the machine: " + fault,
                       machine_.source, "slice again with --machine");
    }
  }

  /// A mixture needs its components side by side, which only heads of a sweep lay down together.
  void check_graded() const {
    if (all_at_once()) return;
    for (const BuildSolid& solid : info_.solids) {
      const Material& material = info_.materials[solid.material];
      if (!material.is_graded()) continue;
      throw InputError("the material '" + material.name + "' of '" + solid.path + "' is graded, and " +
                           name_of(machine_.technology) + " lays one material down at a time",
                       machine_.source, "plan for material jetting, or give the solid a plain material");
    }
  }

  /// Material of each tool on each layer. Throws what can't be.
  LoadSchedule load() {
    const LoadProblem problem = state_needs(info_.materials, layers_, machine_);
    const auto laying = laying_times(problem);
    state_changes(problem, laying);
    if (const auto weighed = weigh(problem, laying)) return hold_loads(problem, *weighed);
    LoadSchedule schedule = schedule_loads(problem);
    plan_.reloads = schedule.reloads;
    plan_.reloads_bound = schedule.lower_bound;
    return schedule;
  }

  /// s by need and tool that can hold it, of all layers.
  [[nodiscard]] std::vector<std::vector<double>> laying_times(const LoadProblem& problem) const {
    std::vector<std::vector<double>> times(problem.holders.size(), std::vector<double>(problem.tools));
    for (std::size_t k = 0; k < layers_.size(); ++k) {
      for (std::size_t i = 0; i < problem.layers[k].size(); ++i) {
        const std::uint32_t need = problem.layers[k][i];
        for (const ToolId tool : machine_.tools.ids()) {
          if ((problem.holders[need] >> tool.value() & 1U) == 0) continue;
          times[need][tool.value()] += times_.seconds(layers_[k], layers_[k].materials[i], tool);
        }
      }
    }
    return times;
  }

  /// What changes cost, in units in which all of the build can be added up.
  void state_changes(const LoadProblem& problem, const std::vector<std::vector<double>>& laying) {
    double steps = 0.0;
    for (const auto& layer : problem.layers) steps += static_cast<double>(layer.size());
    double purge = 0.0;
    double time = 0.0;
    for (const ToolId from : machine_.tools.ids()) {
      for (const ToolId to : machine_.tools.ids()) {
        purge = std::max(purge, steps * machine_.change(from, to).purge);
        time = std::max(time, steps * machine_.change(from, to).time);
      }
    }
    for (const auto& times : laying) time += *std::max_element(times.begin(), times.end());
    purge_unit_ = WholeNumbers(purge);
    time_unit_ = WholeNumbers(time);
    for (const ToolId from : machine_.tools.ids()) {
      change_costs_.emplace_back();
      for (const ToolId to : machine_.tools.ids()) {
        const ToolChange change = machine_.change(from, to);
        change_costs_.back().push_back(from == to || all_at_once()
                                           ? ChangeCost{}
                                           : ChangeCost{1, purge_unit_.of(change.purge), time_unit_.of(change.time)});
      }
    }
  }

  /// The tool of each need where all can stay loaded.
  std::optional<std::vector<std::uint32_t>> weigh(const LoadProblem& problem,
                                                  const std::vector<std::vector<double>>& laying) {
    MatchingProblem matching{problem.holders, problem.layers, {}};
    for (const auto& times : laying) {
      matching.laying_time.emplace_back();
      for (const double time : times) matching.laying_time.back().push_back(time_unit_.of(time));
    }
    const auto weighed = weigh_matchings(matching, paths_);
    if (!weighed) return std::nullopt;
    plan_.matching = PlanMatching{weighed->weighed, weighed->is_proved()};
    if (!weighed->is_proved()) weighing_ = note_of(*weighed);
    return weighed->tool_of;
  }

  [[nodiscard]] PlanFinding note_of(const WeighedMatching& weighed) const {
    const auto figures = [&](const ChangeCost& cost) {
      return std::to_string(cost.changes) + " changes, " + format_double(purge_unit_.value(cost.purge)) +
             " mm^3 of purge and " + format_double(time_unit_.value(cost.time)) + " s of changing and laying down";
    };
    return {Severity::note, std::nullopt, "",
            "which tool holds what is the cheapest of " + std::to_string(weighed.weighed) +
                " ways that were weighed, not proved to be the cheapest of all: " + figures(weighed.cost) +
                "; none takes less than " + figures(weighed.lower_bound),
            "give tools <holds>, and there are fewer ways"};
  }

  ToolOrder order_steps(const LoadSchedule& loads) {
    OrderProblem problem;
    problem.cost = change_costs_;
    for (const auto& tools : loads.tool_of) {
      std::uint32_t set = 0;
      for (const std::uint32_t tool : tools) set |= 1U << tool;
      problem.layers.push_back(set);
    }
    ToolOrder order = order_tools(problem, paths_);
    plan_.tool_changes = static_cast<std::uint64_t>(order.cost.changes);
    plan_.tool_changes_bound = static_cast<std::uint64_t>(order.lower_bound.changes);
    return order;
  }

  void lay_out(const LoadSchedule& loads, const ToolOrder& order) {
    std::vector<std::optional<MaterialId>> loaded(machine_.tools.size());
    std::optional<ToolId> active;
    for (std::size_t k = 0; k < layers_.size(); ++k) {
      plan_.layers.push_back({layers_[k].index, layers_[k].z_bottom, layers_[k].z_top, 0.0, {}});
      for (const std::uint8_t tool : order.tools[k]) {
        const auto& tools = loads.tool_of[k];
        const auto place = static_cast<std::size_t>(std::find(tools.begin(), tools.end(), tool) - tools.begin());
        plan_.layers.back().steps.push_back(make_step(ToolId{tool}, layers_[k].materials[place], loaded, active));
      }
    }
  }

  PlanStep make_step(ToolId tool, const MaterialStatistics& statistics, std::vector<std::optional<MaterialId>>& loaded,
                     std::optional<ToolId>& active) const {
    PlanStep step;
    step.material = statistics.material;
    step.tool = tool;
    step.statistics = statistics;
    auto& holds = loaded[tool.value()];
    step.is_reload = holds && *holds != step.material;
    if (step.is_reload) step.purge += machine_.reload_purge;
    holds = step.material;
    step.is_change = active && *active != tool && !all_at_once();
    if (step.is_change) {
      const ToolChange change = machine_.change(*active, tool);
      step.change_time = change.time;
      step.purge += change.purge;
    }
    active = tool;
    return step;
  }

  void check_exposures() const {
    if (machine_.technology != Technology::vat) return;
    for (const PlanLayer& layer : plan_.layers) {
      for (const PlanStep& step : layer.steps) {
        if (times_.settings(step.material).exposure > 0.0) continue;
        throw InputError("no exposure is given for '" + info_.materials[step.material].name + "'", machine_.source,
                         "add a <material match=\"...\" exposure=\"...\"/>");
      }
    }
  }

  void add_times() {
    CompensatedSum time;
    CompensatedSum changes;
    for (std::size_t k = 0; k < plan_.layers.size(); ++k) {
      PlanLayer& layer = plan_.layers[k];
      layer.time = machine_.layer_overhead;
      for (PlanStep& step : layer.steps) {
        step.time = times_.seconds(layers_[k], step.statistics, step.tool);
        step.volume = step.statistics.area * (layer.z_top - layer.z_bottom);
        layer.time += step.time + step.change_time + (step.is_reload ? machine_.reload_time : 0.0);
        changes.add(step.change_time);
      }
      time.add(layer.time);
    }
    plan_.time = time.value();
    plan_.change_time = changes.value();
    plan_.reload_time = static_cast<double>(plan_.reloads) * machine_.reload_time;
  }

  void add_materials() {
    std::vector<CompensatedSum> volume(plan_.materials.size());
    std::vector<CompensatedSum> length(plan_.materials.size());
    for (const PlanLayer& layer : plan_.layers) {
      for (const PlanStep& step : layer.steps) {
        PlanMaterial& material = plan_.materials[step.material.value()];
        if (std::find(material.tools.begin(), material.tools.end(), step.tool) == material.tools.end()) {
          material.tools.push_back(step.tool);
        }
        volume[step.material.value()].add(step.volume);
        length[step.material.value()].add(step.statistics.length);
        material.time += step.time;
        material.purge += step.purge;
        material.unsupported += step.statistics.unsupported;
      }
    }
    for (std::size_t m = 0; m < plan_.materials.size(); ++m) {
      PlanMaterial& material = plan_.materials[m];
      material.volume = volume[m].value();
      material.length = length[m].value();
      if (material.density) material.mass = material.volume * *material.density * 1e-3;  // mm^3 g/cm^3 = mg
      const MaterialSettings& settings = times_.settings(MaterialId{m});
      material.cost = price_of(material.volume + material.purge, settings.price, settings.per, material.density);
    }
  }

  /// Support in all of the box that the materials leave, up to the last layer that holds any.
  void add_support() {
    if (!machine_.support || machine_.support->fill != SupportFill::box) return;
    Box2 box;
    std::size_t top = 0;
    for (std::size_t k = 0; k < layers_.size(); ++k) {
      box.extend(layers_[k].box);
      if (!layers_[k].materials.empty()) top = k + 1;
    }
    PlanSupport support{machine_.support->material, 0.0, std::nullopt};
    for (std::size_t k = 0; k < top; ++k) {
      double volume = box.volume() * (layers_[k].z_top - layers_[k].z_bottom);
      for (const PlanStep& step : plan_.layers[k].steps) volume -= step.volume;
      support.volume += volume;
    }
    support.cost = price_of(support.volume, machine_.support->price, machine_.support->per, machine_.support->density);
    plan_.support = support;
  }

  void add_costs() {
    plan_.machine_cost = plan_.time / 3600.0 * machine_.cost_per_hour;
    plan_.change_cost = static_cast<double>(plan_.tool_changes) * machine_.change_cost +
                        static_cast<double>(plan_.reloads) * machine_.reload_cost;
    plan_.cost = plan_.machine_cost + plan_.change_cost;
    for (const PlanMaterial& material : plan_.materials) plan_.cost += material.cost.value_or(0.0);
    if (plan_.support) plan_.cost += plan_.support->cost.value_or(0.0);
  }

  void measure_size() {
    Box3 box;
    for (const LayerStatistics& layer : layers_) {
      if (layer.materials.empty()) continue;
      box.extend(Vec3(layer.box.min().x(), layer.box.min().y(), layer.z_bottom));
      box.extend(Vec3(layer.box.max().x(), layer.box.max().y(), layer.z_top));
    }
    if (box.isEmpty()) return;
    plan_.size = box.sizes().cwiseProduct(machine_.scale());
    plan_.fits = (plan_.size.array() <= machine_.volume.array() * (1.0 + 1e-12)).all();
  }

  const BuildInfo& info_;
  const std::vector<LayerStatistics>& layers_;
  const Machine& machine_;
  LayingTimes times_;
  WholeNumbers purge_unit_{0.0};
  WholeNumbers time_unit_{0.0};
  std::vector<std::vector<ChangeCost>> change_costs_;  ///< from, to
  PathCache paths_{change_costs_};
  std::optional<PlanFinding> weighing_;
  BuildPlan plan_;
};

}  // namespace

BuildPlan make_plan(const BuildInfo& info, const std::vector<LayerStatistics>& layers, const Machine& machine) {
  return Planner(info, layers, machine).run();
}

}  // namespace lamella
