#pragma once

#include <cstdint>
#include <vector>

namespace lamella {

/// Which material is in which tool when: every layer needs all its materials loaded at once, each in a tool of its own
/// that can hold it. Before the build every tool may be loaded; later loads are manual, and are to be few.
struct LoadProblem {
  std::size_t tools = 0;                           ///< at most 32
  std::vector<std::uint32_t> holders;              ///< per material: bit t says that tool t can hold it
  std::vector<std::vector<std::uint32_t>> layers;  ///< per layer: its materials, ascending
  bool may_reload = true;
};

struct LoadSchedule {
  std::vector<std::vector<std::uint32_t>> tool_of;  ///< per layer, beside its materials
  std::uint64_t reloads = 0;
  std::uint64_t lower_bound = 0;  ///< no schedule needs fewer reloads; equal where this one is proved to be best
};

/// Why there is no schedule.
enum class LoadFault { none, material_fits_no_tool, layer_needs_too_much, needs_reloading };
struct LoadVerdict {
  LoadFault fault = LoadFault::none;
  std::size_t which = 0;  ///< material or layer
};

[[nodiscard]] LoadVerdict judge_loads(const LoadProblem& problem);

/// The schedule with the fewest reloads: none when a matching of all materials exists; by furthest next use (Belady
/// 1966), which is exact, where the tools fall into classes that share no material; by dynamic programming over all
/// loads where their number times that of the layers is at most 2e7; else layer by layer, with a lower bound.
/// Ties go to the lower tool. Requires judge_loads() to find no fault.
[[nodiscard]] LoadSchedule schedule_loads(const LoadProblem& problem);

/// The schedule in which material m stays in tool tool_of[m] from beginning to end.
[[nodiscard]] LoadSchedule hold_loads(const LoadProblem& problem, const std::vector<std::uint32_t>& tool_of);

}  // namespace lamella
