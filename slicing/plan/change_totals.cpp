#include "slicing/plan/change_totals.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace lamella {

namespace {

/// More than any sum of costs, and safe to add to.
constexpr ChangeCost kImpossible{std::numeric_limits<std::int64_t>::max() / 4, 0, 0};

}  // namespace

ChangeCost ChangeTotals::least(const std::vector<Run>& runs) {
  const Stay* before = nullptr;
  std::vector<ChangeCost> costs;  // by the last tool's place
  for (const Run& run : runs) {
    Stay& stay = stay_of(run.tools);
    enter(before, stay, costs);
    repeat(stay, run.layers - 1, costs);
    before = &stay;
  }
  return costs.empty() ? ChangeCost{} : *std::min_element(costs.begin(), costs.end());
}

ChangeTotals::Stay& ChangeTotals::stay_of(std::uint32_t tools) {
  const auto found = stays_.find(tools);
  if (found != stays_.end()) return found->second;
  Stay& stay = stays_.emplace(tools, Stay{paths_.of(tools), {}}).first->second;
  is_exact_ = is_exact_ && stay.paths.is_exact();
  return stay;
}

/// The run's first layer.
void ChangeTotals::enter(const Stay* before, const Stay& stay, std::vector<ChangeCost>& costs) {
  const ToolPaths& paths = stay.paths;
  scratch_.assign(paths.size(), kImpossible);
  for (std::size_t first = 0; first < paths.size(); ++first) {
    ChangeCost entry = before == nullptr ? ChangeCost{} : kImpossible;
    for (std::size_t last = 0; before != nullptr && last < costs.size(); ++last) {
      entry = std::min(entry, costs[last] + change_[before->paths.tool(last)][paths.tool(first)]);
    }
    for (std::size_t last = 0; last < paths.size(); ++last) {
      if (paths.allows(first, last)) scratch_[last] = std::min(scratch_[last], entry + path_cost(paths, first, last));
    }
  }
  work_ += paths.size() * (paths.size() + costs.size());
  std::swap(costs, scratch_);
}

/// As many more layers of the same tools.
void ChangeTotals::repeat(Stay& stay, std::size_t layers, std::vector<ChangeCost>& costs) {
  const std::size_t size = stay.paths.size();
  if (size == 1) return;  // the tool stays
  for (std::size_t bit = 0; layers >> bit != 0; ++bit) {
    if (stay.powers.size() <= bit) add_power(stay);
    if ((layers >> bit & 1U) == 0) continue;
    scratch_.assign(size, kImpossible);
    for (std::size_t from = 0; from < size; ++from) {
      for (std::size_t to = 0; to < size; ++to) {
        scratch_[to] = std::min(scratch_[to], costs[from] + stay.powers[bit][from * size + to]);
      }
    }
    work_ += size * size;
    std::swap(costs, scratch_);
  }
}

void ChangeTotals::add_power(Stay& stay) {
  const std::size_t size = stay.paths.size();
  std::vector<ChangeCost> power(size * size, kImpossible);
  const bool is_first = stay.powers.empty();
  for (std::size_t from = 0; from < size; ++from) {
    for (std::size_t middle = 0; middle < size; ++middle) {
      const ChangeCost half =
          is_first ? change_[stay.paths.tool(from)][stay.paths.tool(middle)] : stay.powers.back()[from * size + middle];
      for (std::size_t to = 0; to < size; ++to) {
        if (is_first && !stay.paths.allows(middle, to)) continue;
        const ChangeCost rest = is_first ? path_cost(stay.paths, middle, to) : stay.powers.back()[middle * size + to];
        power[from * size + to] = std::min(power[from * size + to], half + rest);
      }
    }
  }
  work_ += size * size * size;
  stay.powers.push_back(std::move(power));
}

}  // namespace lamella
