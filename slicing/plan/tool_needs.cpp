#include "slicing/plan/tool_needs.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <string>

#include "core/error.h"
#include "core/xml.h"
#include "slicing/plan/matching.h"

namespace lamella {

namespace {

std::string joined(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

/// mm to a nanometre: further digits come of the difference.
std::string height_text(const LayerStatistics& layer) {
  return format_double(std::round((layer.z_top - layer.z_bottom) * 1e6) / 1e6);
}

class NeedFinder {
 public:
  NeedFinder(const IdVector<MaterialId, Material>& materials, const std::vector<LayerStatistics>& layers,
             const Machine& machine)
      : materials_(materials), layers_(layers), machine_(machine) {
    problem_.tools = machine.tools.size();
    problem_.may_reload = machine.allows_reloading;
  }

  [[nodiscard]] LoadProblem run() {
    state_needs();
    refuse(judge_loads(problem_));
    return std::move(problem_);
  }

 private:
  [[nodiscard]] std::string range_text(ToolId tool) const {
    const Interval range = machine_.layers_of(tool);
    return "'" + machine_.tools[tool].name + "' lays " + format_double(range.lo) + " to " + format_double(range.hi) +
           " mm";
  }

  /// Bit t says that tool t can hold the material, whatever the layers.
  [[nodiscard]] std::uint32_t holders_of(MaterialId material) const {
    std::uint32_t tools = 0;
    for (const ToolId tool : machine_.tools.ids()) {
      if (machine_.can_hold(tool, materials_[material].name)) tools |= 1U << tool.value();
    }
    return tools;
  }

  /// Bit t says that tool t can hold the material and lay the layer.
  [[nodiscard]] std::uint32_t tools_for(MaterialId material, const LayerStatistics& layer) const {
    const std::string& name = materials_[material].name;
    const double height = layer.z_top - layer.z_bottom;
    std::uint32_t tools = 0;
    std::string ranges;
    for (const ToolId tool : machine_.tools.ids()) {
      if (!machine_.can_hold(tool, name)) continue;
      const Interval range = machine_.layers_of(tool);
      if (takes_height(range, height)) tools |= 1U << tool.value();
      ranges += (ranges.empty() ? "" : ", ") + range_text(tool);
    }
    if (tools != 0) return tools;
    if (ranges.empty()) {
      throw InputError("no tool can hold the material '" + name + "'", machine_.source,
                       "add <holds material=\"...\"/> to a tool, or choose another machine");
    }
    throw InputError("layer " + std::to_string(layer.index) + " of " + height_text(layer) + " mm has the material '" +
                         name + "', which no tool lays so: " + ranges,
                     machine_.source, "slice again with --adaptive and --machine or with another --layer-height");
  }

  /// Fills in layers, holders and names.
  void state_needs() {
    std::vector<std::vector<std::uint32_t>> groups(materials_.size());
    std::vector<std::vector<std::size_t>> group_of;  // per layer, beside its materials
    for (const LayerStatistics& layer : layers_) {
      group_of.emplace_back();
      for (const MaterialStatistics& one : layer.materials) {
        const std::uint32_t tools = tools_for(one.material, layer);
        std::vector<std::uint32_t>& own = groups[one.material.value()];
        auto group = std::find_if(own.begin(), own.end(), [&](std::uint32_t other) { return (other & tools) != 0; });
        if (group == own.end()) group = own.insert(group, tools);
        *group &= tools;
        group_of.back().push_back(static_cast<std::size_t>(group - own.begin()));
      }
    }
    std::vector<std::uint32_t> first;
    for (const MaterialId material : materials_.ids()) {
      first.push_back(static_cast<std::uint32_t>(names_.size()));
      for (const std::uint32_t tools : groups[material.value()]) {
        names_.push_back(materials_[material].name);
        material_of_.push_back(material);
        problem_.holders.push_back(tools);
      }
    }
    for (std::size_t k = 0; k < layers_.size(); ++k) {
      problem_.layers.emplace_back();
      for (std::size_t i = 0; i < group_of[k].size(); ++i) {
        const std::size_t material = layers_[k].materials[i].material.value();
        problem_.layers.back().push_back(first[material] + static_cast<std::uint32_t>(group_of[k][i]));
      }
    }
  }

  /// What of these needs has too few tools, where that isn't all of them.
  [[nodiscard]] std::string crowd_of(const std::vector<std::uint32_t>& needs) const {
    const auto crowd = find_crowd(needs, problem_.holders);
    if (!crowd || static_cast<std::size_t>(std::popcount(crowd->tools)) == problem_.tools) return "";
    std::vector<std::string> tools;
    for (const ToolId tool : machine_.tools.ids()) {
      if ((crowd->tools >> tool.value() & 1U) != 0) tools.push_back(machine_.tools[tool].name);
    }
    return ": " + joined(names_of(crowd->materials)) + " have but " + std::to_string(tools.size()) + " between them (" +
           joined(tools) + ") for layers of that height";
  }

  /// The tools that would do but for the thickness of layers, where these needs' materials would fit with them; empty
  /// where they wouldn't. The layer's own thickness needn't be what bars a tool: another with the material may be.
  [[nodiscard]] std::string barred_by_thickness(const std::vector<std::uint32_t>& needs) const {
    std::vector<std::uint32_t> materials;
    std::vector<std::uint32_t> holders;
    for (const MaterialId material : materials_.ids()) holders.push_back(holders_of(material));
    std::uint32_t barred = 0;
    for (const std::uint32_t need : needs) {
      const auto material = static_cast<std::uint32_t>(material_of_[need].value());
      if (std::find(materials.begin(), materials.end(), material) == materials.end()) materials.push_back(material);
      barred |= holders[material] & ~problem_.holders[need];
    }
    if (barred == 0 || !match_tools(materials, holders)) return "";
    std::string text;
    for (const ToolId tool : machine_.tools.ids()) {
      if ((barred >> tool.value() & 1U) != 0) text += (text.empty() ? "" : ", ") + range_text(tool);
    }
    return text;
  }

  [[nodiscard]] std::vector<std::string> names_of(const std::vector<std::uint32_t>& needs) const {
    std::vector<std::string> names;
    names.reserve(needs.size());
    for (const std::uint32_t need : needs) names.push_back(names_[need]);
    return names;
  }

  [[nodiscard]] std::vector<std::uint32_t> all_needs() const {
    std::vector<std::uint32_t> needs(problem_.holders.size());
    std::iota(needs.begin(), needs.end(), 0U);
    return needs;
  }

  /// Throws where the thickness of layers is why these needs don't fit.
  void refuse_thickness(const std::vector<std::uint32_t>& needs, const std::string& what) const {
    const std::string barred = barred_by_thickness(needs);
    if (barred.empty()) return;
    throw InputError(what + ", and thickness alone bars tools: " + barred, machine_.source,
                     "slice again with --adaptive and --machine or with another --layer-height");
  }

  void refuse(const LoadVerdict& verdict) const {
    switch (verdict.fault) {
      case LoadFault::none:
        return;
      case LoadFault::material_fits_no_tool:
        throw InputError("no tool can hold the material '" + names_[verdict.which] + "'", machine_.source,
                         "add <holds material=\"...\"/> to a tool, or choose another machine");
      case LoadFault::layer_needs_too_much: {
        const std::vector<std::uint32_t>& needs = problem_.layers[verdict.which];
        const LayerStatistics& layer = layers_[verdict.which];
        const std::string what = "layer " + std::to_string(layer.index) + " needs " + std::to_string(needs.size()) +
                                 " materials at once (" + joined(names_of(needs)) + "), which don't fit the " +
                                 std::to_string(problem_.tools) + " tools together" + crowd_of(needs);
        refuse_thickness(needs, what + "; the layer is " + height_text(layer) + " mm thick");
        throw InputError(what, machine_.source, "choose a machine with more tools, fewer materials, or turn the part");
      }
      case LoadFault::needs_reloading:
        refuse_thickness(all_needs(), "the machine isn't reloaded, and its " + std::to_string(problem_.tools) +
                                          " tools can't lay all the build's layers");
        throw InputError("the build needs " + std::to_string(verdict.which) + " materials, the machine has " +
                             std::to_string(problem_.tools) + " tools and isn't reloaded",
                         machine_.source, "set reload=\"between-layers\" where an operator can do it");
    }
  }

  const IdVector<MaterialId, Material>& materials_;
  const std::vector<LayerStatistics>& layers_;
  const Machine& machine_;
  LoadProblem problem_;
  std::vector<std::string> names_;       ///< of the needs' materials
  std::vector<MaterialId> material_of_;  ///< by need
};

}  // namespace

LoadProblem state_needs(const IdVector<MaterialId, Material>& materials, const std::vector<LayerStatistics>& layers,
                        const Machine& machine) {
  return NeedFinder(materials, layers, machine).run();
}

}  // namespace lamella
