#pragma once

#include <compare>
#include <cstdint>
#include <vector>

namespace lamella {

/// What changes cost, in whole numbers so that sums are exact: their count first, then the purged volume, then time.
/// Units are the caller's; sums must stay below 2^50.
struct ChangeCost {
  std::int64_t changes = 0;
  std::int64_t purge = 0;
  std::int64_t time = 0;

  auto operator<=>(const ChangeCost&) const = default;
  ChangeCost operator+(const ChangeCost& other) const {
    return {changes + other.changes, purge + other.purge, time + other.time};
  }
};

/// Which tools each layer needs (bits), and what each change costs: cost[from][to], {} on the diagonal.
struct OrderProblem {
  std::vector<std::vector<ChangeCost>> cost;
  std::vector<std::uint32_t> layers;
};

struct ToolOrder {
  std::vector<std::vector<std::uint8_t>> tools;  ///< per layer, in their order
  ChangeCost cost;                               ///< of all changes, within layers and between them
  ChangeCost lower_bound;                        ///< no order costs less; equal where this one is proved to be best
};

/// Most tools in one layer whose order is found exactly when changes differ in cost.
inline constexpr int kMaxExactTools = 10;

/// The order of tools in every layer at least cost over the whole build: dynamic programming over the layers, whose
/// state is the last tool of a layer; within a layer the shortest path from its first to its last tool by dynamic
/// programming over sets (Held and Karp 1962). Paths of over kMaxExactTools tools, where changes differ, go to the
/// nearest next tool, and the bound then takes the cheapest change into each tool. Ties go to the lower tool.
[[nodiscard]] ToolOrder order_tools(const OrderProblem& problem);

class PathCache;
/// The same, with paths by problem.cost that may be known already.
[[nodiscard]] ToolOrder order_tools(const OrderProblem& problem, PathCache& paths);

}  // namespace lamella
