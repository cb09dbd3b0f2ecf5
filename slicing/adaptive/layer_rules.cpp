#include "slicing/adaptive/layer_rules.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "core/xml.h"

namespace lamella {

namespace {

/// Thicknesses are typed as decimals; half a nanometre is their rounding.
constexpr double kRounding = 5e-7;   // mm
constexpr double kNanometre = 1e-6;  // mm
constexpr std::size_t kMaxThicknesses = 1000;
constexpr double kLargest = 1000.0;  // mm: no machine lays down thicker layers

bool is_length(double value) { return value > 0.0 && std::isfinite(value); }

std::string mm(double value) { return format_double(value) + " mm"; }
std::string range_text(const Interval& range) { return format_double(range.lo) + " to " + mm(range.hi); }

void check_options(const AdaptiveOptions& options) {
  if (!is_length(options.deviation)) {
    throw UsageError("the largest deviation must be positive and finite", "--adaptive", "give a length in mm");
  }
  if (options.step && !is_length(*options.step)) {
    throw UsageError("the thickness step must be positive and finite", "--adaptive-step", "give a length in mm");
  }
  if (!options.range) return;
  const Interval& range = *options.range;
  if (!is_length(range.lo) || !is_length(range.hi) || range.hi > kLargest) {
    throw UsageError("thicknesses must be positive and at most " + mm(kLargest), "--adaptive-range",
                     "give the least and the largest in mm, e.g. 0.05,0.3");
  }
  if (range.lo > range.hi) {
    throw UsageError("the least thickness, " + mm(range.lo) + ", is more than the largest, " + mm(range.hi),
                     "--adaptive-range", "swap them");
  }
}

/// The largest of 1, 2, 5 times powers of ten that is no more than `value`, to a millionth.
double floor_1_2_5(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {10.0, 5.0, 2.0}) {
    if (factor * decade <= value * (1.0 + 1e-6)) return factor * decade;
  }
  return decade;
}

/// Thicknesses are `least` plus multiples of `step` up to `most`; both are multiples of `quantum`.
struct Lattice {
  double quantum = 0.0;
  double least = 0.0;
  double step = 0.0;
  double most = 0.0;
};

/// A machine's heights are multiples of the largest measure of its least height and its step, in whole nanometres.
Lattice machine_lattice(const Machine& machine) {
  const auto least = static_cast<long long>(std::round(machine.layer_min / kNanometre));
  const auto step = static_cast<long long>(std::round(machine.layer_step / kNanometre));
  const double quantum = static_cast<double>(std::gcd(std::max(least, 1LL), std::max(step, 1LL))) * kNanometre;
  return {quantum, machine.layer_min, machine.layer_step, machine.layer_max};
}

/// Divides `length` evenly into parts of at most `most`, by a number that leaves round decimals.
double divided(double length, double most) {
  for (double decade = 1.0; decade < 1e6; decade *= 10.0) {
    for (const double parts : {1.0, 2.0, 4.0, 5.0, 8.0}) {
      if (length / (decade * parts) <= most * (1.0 + 1e-6)) return length / (decade * parts);
    }
  }
  return most;
}

Lattice choose_lattice(const AdaptiveOptions& options) {
  const bool has_steps = options.machine && options.machine->layer_step > 0.0;
  if (has_steps && !options.step) return machine_lattice(*options.machine);
  // Borders miss flat features by half a quantum: a quarter of what may deviate.
  const double fine = 0.5 * options.deviation;
  std::optional<Interval> range = options.range;
  if (!range && options.machine) range = Interval{options.machine->layer_min, options.machine->layer_max};
  const double step = options.step ? *options.step : range ? divided(range->lo, fine) : floor_1_2_5(fine);
  if (!range) range = Interval{2.0 * step, 20.0 * step};
  const double least = std::max(1.0, std::ceil(range->lo / step - 1e-6)) * step;
  return {step, least, step, range->hi};
}

/// What is left of `range` when `least` and `most` count too.
Interval narrowed(Interval range, std::optional<double> least, std::optional<double> most) {
  if (least) range.lo = std::max(range.lo, *least);
  if (most) range.hi = std::min(range.hi, *most);
  return range;
}

Interval common_range(const AdaptiveOptions& options, const Lattice& lattice) {
  Interval range{lattice.least, lattice.most};
  if (options.machine) range = narrowed(range, options.machine->layer_min, options.machine->layer_max);
  if (options.range) range = narrowed(range, options.range->lo, options.range->hi);
  return range;
}

std::vector<std::size_t> thicknesses_in(const Interval& range, const Lattice& lattice,
                                        const std::optional<Machine>& machine) {
  std::vector<std::size_t> out;
  const double first = std::max(0.0, std::ceil((range.lo - kRounding - lattice.least) / lattice.step));
  for (double k = first; lattice.least + k * lattice.step <= range.hi + kRounding; k += 1.0) {
    if (out.size() == kMaxThicknesses) {
      throw UsageError("over " + std::to_string(kMaxThicknesses) + " thicknesses of " + range_text(range),
                       "--adaptive-step", "give a coarser step or a narrower range");
    }
    const double height = lattice.least + k * lattice.step;
    if (machine && !layer_height_fault(*machine, height).empty()) continue;
    out.push_back(static_cast<std::size_t>(std::round(height / lattice.quantum)));
  }
  return out;
}

/// What one set of ranges and another have in common; both ascending and apart, and so is the result.
std::vector<Interval> shared(const std::vector<Interval>& a, const std::vector<Interval>& b) {
  std::vector<Interval> out;
  for (const Interval& one : a) {
    for (const Interval& other : b) {
      const Interval both{std::max(one.lo, other.lo), std::min(one.hi, other.hi)};
      if (both.lo <= both.hi + kRounding) out.push_back(both);
    }
  }
  return out;
}

/// All that is in some of the ranges: ascending, apart.
std::vector<Interval> united(std::vector<Interval> ranges) {
  std::sort(ranges.begin(), ranges.end(), [](const Interval& a, const Interval& b) { return a.lo < b.lo; });
  std::vector<Interval> out;
  for (const Interval& range : ranges) {
    if (out.empty() || range.lo > out.back().hi + kRounding) {
      out.push_back(range);
    } else {
      out.back().hi = std::max(out.back().hi, range.hi);
    }
  }
  return out;
}

/// The materials that tools have to hold for it.
std::vector<std::string> names_in_tools(const MaterialTable& table, const Material& material) {
  if (!material.is_graded()) return {material.name};
  std::vector<std::string> out;
  for (const MaterialId component : material.components) out.push_back(table.materials[component].name);
  return out;
}

/// Leaves what tools that can hold `name` lay, and notes their names if that takes something away.
void keep_to_tools(const Machine& machine, const std::string& name, MaterialLayers& layers) {
  std::vector<Interval> ranges;
  std::vector<std::string> tools;
  for (const ToolId tool : machine.tools.ids()) {
    if (!machine.can_hold(tool, name)) continue;
    ranges.push_back(machine.layers_of(tool));
    tools.push_back(machine.tools[tool].name);
  }
  ranges = united(std::move(ranges));
  const Interval& all = layers.ranges.front();
  const bool is_limit = layers.ranges.size() > 1 || ranges.size() != 1 || ranges.front().lo > all.lo + kRounding ||
                        ranges.front().hi < all.hi - kRounding;
  if (!is_limit) return;
  layers.ranges = shared(layers.ranges, ranges);
  for (const std::string& tool : tools) {
    if (std::find(layers.tools.begin(), layers.tools.end(), tool) == layers.tools.end()) layers.tools.push_back(tool);
  }
}

MaterialLayers layers_of(const MaterialTable& table, const Material& material, const AdaptiveOptions& options,
                         const Interval& common) {
  Interval range = narrowed(common, material.layers.least, material.layers.most);
  MaterialLayers out{material.layers.deviation.value_or(options.deviation), {}, {}};
  if (!options.machine) {
    out.ranges = {range};
    return out;
  }
  const MaterialSettings settings = options.machine->settings_of(material.name);
  out.ranges = {narrowed(range, settings.layer_min, settings.layer_max)};
  for (const std::string& name : names_in_tools(table, material)) {
    if (!out.ranges.empty()) keep_to_tools(*options.machine, name, out);
  }
  return out;
}

/// Throws InputError for a material that some solid has and none of the tools can hold.
void require_tool(const Machine& machine, const std::string& name) {
  for (const ToolId tool : machine.tools.ids()) {
    if (machine.can_hold(tool, name)) return;
  }
  throw InputError("no tool can hold the material '" + name + "'", machine.source,
                   "add <holds material=\"...\"/> to a tool, or choose another machine");
}

/// Throws InputError when none of the thicknesses is left for a material.
void require_thickness(const LayerRules& rules, const Material& material, const MaterialLayers& layers) {
  const auto fits = [&](std::size_t thickness) { return layers.takes(static_cast<double>(thickness) * rules.quantum); };
  if (std::any_of(rules.thicknesses.begin(), rules.thicknesses.end(), fits)) return;
  throw InputError("no layer suits the material '" + material.name + "'", "material '" + material.name + "'",
                   "its thicknesses would be " + thickness_text(layers) +
                       "; see its layer_min and layer_max, the machine and --adaptive-range");
}

}  // namespace

bool MaterialLayers::takes(double height) const {
  return std::any_of(ranges.begin(), ranges.end(), [&](const Interval& range) { return takes_height(range, height); });
}

std::string thickness_text(const MaterialLayers& layers) {
  const auto number = [](double value) { return format_double(std::round(value * 1e6) / 1e6); };
  std::string text;
  for (const Interval& range : layers.ranges) {
    text += (text.empty() ? "" : " or ") + number(range.lo) + " to " + number(range.hi);
  }
  text += text.empty() ? "none" : " mm";
  if (layers.tools.empty()) return text;
  text += layers.tools.size() == 1 ? " (tool " : " (tools ";
  for (std::size_t i = 0; i < layers.tools.size(); ++i) text += (i == 0 ? "'" : ", '") + layers.tools[i] + "'";
  return text + ")";
}

LayerRules layer_rules(const MaterialTable& table, const AdaptiveOptions& options) {
  check_options(options);
  const Lattice lattice = choose_lattice(options);
  const Interval common = common_range(options, lattice);
  LayerRules rules{lattice.quantum, thicknesses_in(common, lattice, options.machine), {}};
  if (rules.thicknesses.empty()) {
    const std::string steps = "multiples of " + mm(lattice.step) + " from " + mm(lattice.least) + " on";
    throw UsageError("no thickness is left between " + format_double(common.lo) + " and " + mm(common.hi),
                     "--adaptive-range", "thicknesses are " + steps + (options.machine ? ", by the machine" : ""));
  }
  std::vector<bool> is_used(table.materials.size(), false);
  for (const Assignment& assignment : table.assignments) is_used[assignment.material.value()] = true;
  for (const MaterialId id : table.materials.ids()) {
    const Material& material = table.materials[id];
    if (!is_used[id.value()]) {
      rules.materials.push_back({options.deviation, {common}, {}});
      continue;
    }
    if (options.machine) {
      for (const std::string& name : names_in_tools(table, material)) require_tool(*options.machine, name);
    }
    rules.materials.push_back(layers_of(table, material, options, common));
    require_thickness(rules, material, rules.materials[id]);
  }
  return rules;
}

}  // namespace lamella
