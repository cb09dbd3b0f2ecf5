#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "slicing/plan/tool_paths.h"

namespace lamella {

/// Which tool is to hold what for the whole build, by what that costs. A need is a material, or the part of its layers
/// that only some tools lay.
struct MatchingProblem {
  std::vector<std::uint32_t> holders;                  ///< per need: bit t says that tool t can hold it
  std::vector<std::vector<std::uint32_t>> layers;      ///< per layer: its needs, ascending
  std::vector<std::vector<std::int64_t>> laying_time;  ///< per need and tool, on all layers, in ChangeCost::time's unit
};

/// A tool for every need, each its own.
struct WeighedMatching {
  std::vector<std::uint32_t> tool_of;  ///< per need; 0 of those that no layer has
  ChangeCost cost;                     ///< of all changes in the best order, and the time of laying all down
  ChangeCost lower_bound;              ///< no matching costs less; equal where this one is proved to be the best
  std::uint64_t weighed = 0;           ///< matchings whose cost was found; of alike tools one stands for all

  [[nodiscard]] bool is_proved() const { return cost == lower_bound; }
};

/// How many steps may be spent on weighing; a step takes a few nanoseconds.
inline constexpr std::uint64_t kWeighingSteps = 40'000'000;

/// The matching of all needs to tools of least cost: number of changes first, then purge, then time, each the best
/// order of every layer included (order_tools()). All matchings are weighed, tools that are alike in everything
/// standing for one another, if `steps` suffice; else the needs' tools are moved and swapped one by one while that
/// gains anything, and again from beside the best while steps are left. Of equal ones the first found is taken, the one
/// of match_tools() before all; the same problem gives the same. Nothing where there is no matching. `paths` says what
/// changes between tools cost, {} on the diagonal, and keeps what was found of their orders.
[[nodiscard]] std::optional<WeighedMatching> weigh_matchings(const MatchingProblem& problem, PathCache& paths,
                                                             std::uint64_t steps = kWeighingSteps);

}  // namespace lamella
