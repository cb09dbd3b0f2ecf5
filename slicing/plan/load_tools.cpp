#include "slicing/plan/load_tools.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>

#include "slicing/plan/load_search.h"
#include "slicing/plan/matching.h"

namespace lamella {

namespace {

/// Materials that some layer needs, ascending.
std::vector<std::uint32_t> used_materials(const LoadProblem& problem) {
  std::vector<bool> is_used(problem.holders.size());
  for (const auto& layer : problem.layers) {
    for (const std::uint32_t material : layer) is_used[material] = true;
  }
  std::vector<std::uint32_t> used;
  for (std::uint32_t m = 0; m < is_used.size(); ++m) {
    if (is_used[m]) used.push_back(m);
  }
  return used;
}

/// Layers of the same needs in a row are one step: nothing is gained by reloading between them.
struct Runs {
  std::vector<std::vector<std::uint32_t>> needs;
  std::vector<std::size_t> of_layer;
};

Runs find_runs(const LoadProblem& problem) {
  Runs runs;
  for (const auto& layer : problem.layers) {
    if (runs.needs.empty() || runs.needs.back() != layer) runs.needs.push_back(layer);
    runs.of_layer.push_back(runs.needs.size() - 1);
  }
  return runs;
}

/// Each tool holds either the same used materials as another or shares none with it.
bool tools_fall_into_classes(const LoadProblem& problem, const std::vector<std::uint32_t>& used) {
  for (const std::uint32_t a : used) {
    for (const std::uint32_t b : used) {
      if (problem.holders[a] != problem.holders[b] && (problem.holders[a] & problem.holders[b]) != 0) return false;
    }
  }
  return true;
}

std::uint64_t count_reloads(const std::vector<std::vector<std::uint32_t>>& needs,
                            const std::vector<std::vector<std::uint32_t>>& tool_of, std::size_t tools) {
  std::vector<std::optional<std::uint32_t>> loaded(tools);
  std::uint64_t reloads = 0;
  for (std::size_t k = 0; k < needs.size(); ++k) {
    for (std::size_t i = 0; i < needs[k].size(); ++i) {
      auto& holds = loaded[tool_of[k][i]];
      if (holds && *holds != needs[k][i]) ++reloads;
      holds = needs[k][i];
    }
  }
  return reloads;
}

/// No fewer reloads than if every tool could hold everything.
std::uint64_t relaxed_bound(const Runs& runs, const LoadProblem& problem) {
  const std::uint32_t all = problem.tools >= 32 ? UINT32_MAX : (1U << problem.tools) - 1U;
  const std::vector<std::uint32_t> holders(problem.holders.size(), all);
  return count_reloads(runs.needs, load_by_next_use(runs.needs, holders, problem.tools), problem.tools);
}

}  // namespace

LoadVerdict judge_loads(const LoadProblem& problem) {
  const std::vector<std::uint32_t> used = used_materials(problem);
  for (const std::uint32_t material : used) {
    if (problem.holders[material] == 0) return {LoadFault::material_fits_no_tool, material};
  }
  std::map<std::vector<std::uint32_t>, bool> fits;
  for (std::size_t k = 0; k < problem.layers.size(); ++k) {
    const auto [found, is_new] = fits.try_emplace(problem.layers[k], false);
    if (is_new) found->second = match_tools(problem.layers[k], problem.holders).has_value();
    if (!found->second) return {LoadFault::layer_needs_too_much, k};
  }
  if (problem.may_reload || match_tools(used, problem.holders)) return {};
  return {LoadFault::needs_reloading, used.size()};
}

LoadSchedule hold_loads(const LoadProblem& problem, const std::vector<std::uint32_t>& tool_of) {
  LoadSchedule schedule;
  for (const auto& layer : problem.layers) {
    schedule.tool_of.emplace_back();
    for (const std::uint32_t material : layer) schedule.tool_of.back().push_back(tool_of[material]);
  }
  return schedule;
}

LoadSchedule schedule_loads(const LoadProblem& problem) {
  const std::vector<std::uint32_t> used = used_materials(problem);
  if (const auto fixed = match_tools(used, problem.holders)) {
    std::vector<std::uint32_t> tool_of(problem.holders.size());
    for (std::size_t i = 0; i < used.size(); ++i) tool_of[used[i]] = (*fixed)[i];
    return hold_loads(problem, tool_of);
  }
  const Runs runs = find_runs(problem);
  LoadSchedule schedule;
  std::vector<std::vector<std::uint32_t>> by_run;
  bool is_proved = true;
  if (tools_fall_into_classes(problem, used)) {
    by_run = load_by_next_use(runs.needs, problem.holders, problem.tools);
  } else if (auto exact = load_by_search(runs.needs, problem.holders, problem.tools)) {
    by_run = std::move(*exact);
  } else {
    by_run = load_by_matching(runs.needs, problem.holders, problem.tools);
    is_proved = false;
  }
  schedule.reloads = count_reloads(runs.needs, by_run, problem.tools);
  schedule.lower_bound = is_proved ? schedule.reloads : relaxed_bound(runs, problem);
  for (const std::size_t run : runs.of_layer) schedule.tool_of.push_back(by_run[run]);
  return schedule;
}

}  // namespace lamella
