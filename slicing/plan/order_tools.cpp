#include "slicing/plan/order_tools.h"

#include <algorithm>

#include "slicing/plan/tool_paths.h"

namespace lamella {

namespace {

/// How the best order that ends a layer at one place got there.
struct Step {
  std::uint8_t first = 0;          ///< place of the layer's first tool
  std::uint8_t previous_last = 0;  ///< place of the last tool of the layer before
};

/// A layer that needs tools, and for each of its places what the best order that ends there costs.
struct Stage {
  std::size_t layer = 0;
  const ToolPaths* paths = nullptr;
  std::vector<ChangeCost> cost;
  std::vector<Step> step;
};

using PathCost = const ChangeCost& (ToolPaths::*)(std::size_t, std::size_t) const;

class Orderer {
 public:
  Orderer(const OrderProblem& problem, PathCache& paths) : problem_(problem), paths_(paths) {}

  [[nodiscard]] ToolOrder run() {
    ToolOrder order;
    order.tools.resize(problem_.layers.size());
    order.lower_bound = sweep(&ToolPaths::bound);
    order.cost = sweep(&ToolPaths::cost);
    if (stages_.empty()) return order;
    const auto& ends = stages_.back().cost;
    std::size_t last = static_cast<std::size_t>(std::min_element(ends.begin(), ends.end()) - ends.begin());
    for (std::size_t k = stages_.size(); k-- > 0;) {
      const Step step = stages_[k].step[last];
      order.tools[stages_[k].layer] = stages_[k].paths->path(step.first, last);
      last = step.previous_last;
    }
    return order;
  }

 private:
  /// Fills the stages by the costs or by the bounds of the paths; the result is the least of the last stage.
  ChangeCost sweep(PathCost path_cost) {
    stages_.clear();
    for (std::size_t k = 0; k < problem_.layers.size(); ++k) {
      if (problem_.layers[k] == 0) continue;
      Stage stage{k, &paths_.of(problem_.layers[k]), {}, {}};
      extend(stage, path_cost);
      stages_.push_back(std::move(stage));
    }
    if (stages_.empty()) return {};
    return *std::min_element(stages_.back().cost.begin(), stages_.back().cost.end());
  }

  void extend(Stage& stage, PathCost path_cost) const {
    const ToolPaths& paths = *stage.paths;
    std::vector<ChangeCost> entry(paths.size());
    std::vector<std::uint8_t> entered_from(paths.size());
    for (std::size_t first = 0; first < paths.size() && !stages_.empty(); ++first) {
      enter(paths.tool(first), entry[first], entered_from[first]);
    }
    for (std::size_t last = 0; last < paths.size(); ++last) {
      bool is_reached = false;
      for (std::size_t first = 0; first < paths.size(); ++first) {
        if (!paths.allows(first, last)) continue;
        const ChangeCost cost = entry[first] + (paths.*path_cost)(first, last);
        if (!is_reached) {
          stage.cost.push_back(cost);
          stage.step.push_back({static_cast<std::uint8_t>(first), entered_from[first]});
        } else if (cost < stage.cost.back()) {
          stage.cost.back() = cost;
          stage.step.back() = {static_cast<std::uint8_t>(first), entered_from[first]};
        }
        is_reached = true;
      }
    }
  }

  /// The cheapest way from the stage before to a tool.
  void enter(std::uint8_t tool, ChangeCost& cost, std::uint8_t& from) const {
    const Stage& before = stages_.back();
    for (std::size_t last = 0; last < before.cost.size(); ++last) {
      const ChangeCost candidate = before.cost[last] + problem_.cost[before.paths->tool(last)][tool];
      if (last > 0 && !(candidate < cost)) continue;
      cost = candidate;
      from = static_cast<std::uint8_t>(last);
    }
  }

  const OrderProblem& problem_;
  PathCache& paths_;
  std::vector<Stage> stages_;
};

}  // namespace

ToolOrder order_tools(const OrderProblem& problem) {
  PathCache paths(problem.cost);
  return order_tools(problem, paths);
}

ToolOrder order_tools(const OrderProblem& problem, PathCache& paths) { return Orderer(problem, paths).run(); }

}  // namespace lamella
