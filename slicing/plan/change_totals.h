#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "slicing/plan/tool_paths.h"

namespace lamella {

/// What the changes of a whole build cost at least, asked for again and again for tools that are named anew. Layers of
/// the same needs in a row are one run, whose length enters by powers of two.
class ChangeTotals {
 public:
  /// Which figure of the paths through a layer's tools counts.
  enum class Figure { cost, bound };

  /// The cache has the paths, and what changes cost; it must outlive this.
  ChangeTotals(PathCache& paths, Figure figure) : paths_(paths), change_(paths.cost()), figure_(figure) {}

  /// The least cost where run r needs the tools runs[r].tools (bits, not 0) on runs[r].layers layers. Equal to that of
  /// order_tools().
  struct Run {
    std::uint32_t tools = 0;
    std::size_t layers = 0;
  };
  [[nodiscard]] ChangeCost least(const std::vector<Run>& runs);

  /// Steps of the computation so far, those of the cache included; a few nanoseconds each.
  [[nodiscard]] std::uint64_t work() const { return work_ + paths_.work(); }
  /// Whether every path that was asked for is proved to be the best.
  [[nodiscard]] bool is_exact() const { return is_exact_; }

 private:
  /// One set of tools: its paths, and what 1, 2, 4 ... more layers of it cost from every last tool to every last tool.
  struct Stay {
    const ToolPaths& paths;
    std::vector<std::vector<ChangeCost>> powers;
  };

  Stay& stay_of(std::uint32_t tools);
  void add_power(Stay& stay);
  void enter(const Stay* before, const Stay& stay, std::vector<ChangeCost>& costs);
  void repeat(Stay& stay, std::size_t layers, std::vector<ChangeCost>& costs);
  [[nodiscard]] const ChangeCost& path_cost(const ToolPaths& paths, std::size_t first, std::size_t last) const {
    return figure_ == Figure::cost ? paths.cost(first, last) : paths.bound(first, last);
  }

  PathCache& paths_;
  const std::vector<std::vector<ChangeCost>>& change_;
  Figure figure_;
  std::map<std::uint32_t, Stay> stays_;
  std::vector<ChangeCost> scratch_;
  std::uint64_t work_ = 0;
  bool is_exact_ = true;
};

}  // namespace lamella
