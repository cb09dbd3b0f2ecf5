#include "slicing/plan/load_search.h"

#include <algorithm>
#include <limits>

#include "slicing/plan/matching.h"

namespace lamella {

namespace {

constexpr std::uint32_t kEmpty = UINT32_MAX;
constexpr std::size_t kNever = std::numeric_limits<std::size_t>::max();

/// At which step a material is needed next, asked in ascending steps.
class NextUse {
 public:
  NextUse(const ToolRows& needs, std::size_t materials) : steps_(materials), at_(materials) {
    for (std::size_t k = 0; k < needs.size(); ++k) {
      for (const std::uint32_t material : needs[k]) steps_[material].push_back(k);
    }
  }
  /// The first step from `step` on that needs the material.
  std::size_t from(std::size_t step, std::uint32_t material) {
    const std::vector<std::size_t>& steps = steps_[material];
    std::size_t& at = at_[material];
    while (at < steps.size() && steps[at] < step) ++at;
    return at < steps.size() ? steps[at] : kNever;
  }

 private:
  std::vector<std::vector<std::size_t>> steps_;
  std::vector<std::size_t> at_;
};

std::uint32_t tool_with(const std::vector<std::uint32_t>& loaded, std::uint32_t material) {
  return static_cast<std::uint32_t>(std::find(loaded.begin(), loaded.end(), material) - loaded.begin());
}

/// Of the tools that can take the material and hold nothing that this step needs: an empty one, else the one whose
/// material is needed again last.
std::uint32_t choose_tool(const std::vector<std::uint32_t>& loaded, std::uint32_t holders, std::size_t step,
                          NextUse& next_use) {
  std::uint32_t best = kEmpty;
  std::size_t furthest = 0;
  for (std::uint32_t tool = 0; tool < loaded.size(); ++tool) {
    if ((holders >> tool & 1U) == 0) continue;
    if (loaded[tool] == kEmpty) return tool;
    const std::size_t next = next_use.from(step, loaded[tool]);
    if (next > step && (best == kEmpty || next > furthest)) {
      best = tool;
      furthest = next;
    }
  }
  return best;
}

/// Every way to load the tools, numbered; digit t of a number is what tool t holds.
class Loads {
 public:
  static constexpr std::size_t kMost = 20'000'000;  ///< numbers times steps, two bytes each

  Loads(const std::vector<std::uint32_t>& used, const std::vector<std::uint32_t>& holders, std::size_t tools) {
    for (std::uint32_t tool = 0; tool < tools; ++tool) {
      options_.emplace_back();
      for (const std::uint32_t material : used) {
        if ((holders[material] >> tool & 1U) != 0) options_.back().push_back(material);
      }
      if (options_.back().empty()) options_.back().push_back(kEmpty);
      stride_.push_back(count_);
      count_ = std::min(count_ * options_.back().size(), kMost + 1);
    }
  }

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] std::size_t tools() const { return options_.size(); }
  [[nodiscard]] std::size_t options(std::size_t tool) const { return options_[tool].size(); }
  [[nodiscard]] std::size_t stride(std::size_t tool) const { return stride_[tool]; }
  [[nodiscard]] std::size_t digit(std::size_t load, std::size_t tool) const {
    return load / stride_[tool] % options_[tool].size();
  }
  [[nodiscard]] std::vector<std::uint32_t> unpack(std::size_t load) const {
    std::vector<std::uint32_t> loaded;
    for (std::size_t tool = 0; tool < tools(); ++tool) loaded.push_back(options_[tool][digit(load, tool)]);
    return loaded;
  }
  /// Bit i says that used material i is loaded, of every load.
  [[nodiscard]] std::vector<std::uint64_t> contents(const std::vector<std::uint32_t>& used) const {
    std::vector<std::uint64_t> held(count_);
    for (std::size_t tool = 0; tool < tools(); ++tool) {
      for (std::size_t load = 0; load < count_; ++load) {
        const auto found = std::lower_bound(used.begin(), used.end(), options_[tool][digit(load, tool)]);
        if (found != used.end()) held[load] |= 1ULL << static_cast<unsigned>(found - used.begin());
      }
    }
    return held;
  }

 private:
  std::vector<std::vector<std::uint32_t>> options_;
  std::vector<std::size_t> stride_;
  std::size_t count_ = 1;
};

using Costs = std::vector<std::uint16_t>;
constexpr std::uint16_t kImpossible = UINT16_MAX;

/// Lets one tool be reloaded: cost(load) = min(cost(load), 1 + least cost over what the tool held before). Over all
/// tools in turn this is the least cost plus the number of tools that differ.
void relax_tool(Costs& costs, const Loads& loads, std::size_t tool) {
  const std::size_t stride = loads.stride(tool);
  const std::size_t block = stride * loads.options(tool);
  for (std::size_t base = 0; base < costs.size(); base += block) {
    for (std::size_t low = base; low < base + stride; ++low) {
      std::uint16_t least = kImpossible;
      for (std::size_t load = low; load < base + block; load += stride) least = std::min(least, costs[load]);
      if (least == kImpossible) continue;
      for (std::size_t load = low; load < base + block; load += stride) {
        costs[load] = std::min<std::uint16_t>(costs[load], least + 1);
      }
    }
  }
}

/// The load before the step that leads to `load` at least cost. Ties go to the load that reloads nothing, then the
/// lowest number.
std::size_t find_previous(const Costs& before, const Loads& loads, std::size_t load) {
  std::vector<Costs> stages{before};
  for (std::size_t tool = 0; tool < loads.tools(); ++tool) {
    stages.push_back(stages.back());
    relax_tool(stages.back(), loads, tool);
  }
  for (std::size_t tool = loads.tools(); tool-- > 0;) {
    if (stages[tool][load] == stages[tool + 1][load]) continue;
    const std::size_t low = load - loads.digit(load, tool) * loads.stride(tool);
    for (std::size_t option = 0; option < loads.options(tool); ++option) {
      const std::size_t other = low + option * loads.stride(tool);
      if (stages[tool][other] + 1 != stages[tool + 1][load]) continue;
      load = other;
      break;
    }
  }
  return load;
}

/// Costs of every load after every step.
std::vector<Costs> sweep(const ToolRows& needs, const Loads& loads, const std::vector<std::uint32_t>& used) {
  const std::vector<std::uint64_t> held = loads.contents(used);
  std::vector<Costs> after;
  Costs costs(loads.count(), 0);
  for (const auto& step : needs) {
    for (std::size_t tool = 0; tool < loads.tools() && !after.empty(); ++tool) relax_tool(costs, loads, tool);
    std::uint64_t needed = 0;
    for (const std::uint32_t material : step) {
      needed |= 1ULL << static_cast<unsigned>(std::lower_bound(used.begin(), used.end(), material) - used.begin());
    }
    for (std::size_t load = 0; load < costs.size(); ++load) {
      if ((held[load] & needed) != needed) costs[load] = kImpossible;
    }
    after.push_back(costs);
  }
  return after;
}

}  // namespace

ToolRows load_by_next_use(const ToolRows& needs, const std::vector<std::uint32_t>& holders, std::size_t tools) {
  NextUse next_use(needs, holders.size());
  std::vector<std::uint32_t> loaded(tools, kEmpty);
  ToolRows tool_of;
  for (std::size_t k = 0; k < needs.size(); ++k) {
    tool_of.emplace_back();
    for (const std::uint32_t material : needs[k]) {
      std::uint32_t tool = tool_with(loaded, material);
      if (tool == tools) tool = choose_tool(loaded, holders[material], k, next_use);
      loaded[tool] = material;
      tool_of.back().push_back(tool);
    }
  }
  return tool_of;
}

std::optional<ToolRows> load_by_search(const ToolRows& needs, const std::vector<std::uint32_t>& holders,
                                       std::size_t tools) {
  std::vector<std::uint32_t> used;
  for (const auto& step : needs) used.insert(used.end(), step.begin(), step.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  if (used.size() > 64 || needs.empty()) return std::nullopt;
  const Loads loads(used, holders, tools);
  // A step reloads each tool once at most, which keeps the costs within their type.
  if (loads.count() * needs.size() > Loads::kMost || needs.size() * tools >= kImpossible) return std::nullopt;

  const std::vector<Costs> after = sweep(needs, loads, used);
  const Costs& last = after.back();
  std::size_t load = static_cast<std::size_t>(std::min_element(last.begin(), last.end()) - last.begin());
  ToolRows tool_of(needs.size());
  for (std::size_t k = needs.size(); k-- > 0;) {
    const std::vector<std::uint32_t> loaded = loads.unpack(load);
    for (const std::uint32_t material : needs[k]) tool_of[k].push_back(tool_with(loaded, material));
    if (k > 0) load = find_previous(after[k - 1], loads, load);
  }
  return tool_of;
}

ToolRows load_by_matching(const ToolRows& needs, const std::vector<std::uint32_t>& holders, std::size_t tools) {
  constexpr double kReload = 1e3;  // more than all preferences of a step together
  constexpr double kImpossibleCost = 1e9;
  NextUse next_use(needs, holders.size());
  std::vector<std::uint32_t> loaded(tools, kEmpty);
  ToolRows tool_of;
  for (std::size_t k = 0; k < needs.size(); ++k) {
    std::vector<std::vector<double>> cost(needs[k].size(), std::vector<double>(tools, kImpossibleCost));
    for (std::size_t i = 0; i < needs[k].size(); ++i) {
      for (std::uint32_t tool = 0; tool < tools; ++tool) {
        if ((holders[needs[k][i]] >> tool & 1U) == 0) continue;
        if (loaded[tool] == needs[k][i]) {
          cost[i][tool] = 0.0;
        } else if (loaded[tool] == kEmpty) {
          cost[i][tool] = 1.0;
        } else {
          const std::size_t next = next_use.from(k, loaded[tool]);
          cost[i][tool] = kReload + (next == kNever ? 0.0 : 1.0 / static_cast<double>(next - k + 1));
        }
      }
    }
    tool_of.push_back(match_cheapest(cost));
    for (std::size_t i = 0; i < needs[k].size(); ++i) loaded[tool_of.back()[i]] = needs[k][i];
  }
  return tool_of;
}

}  // namespace lamella
