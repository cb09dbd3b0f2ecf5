#include "slicing/adaptive/choose_layers.h"

#include <algorithm>
#include <tuple>

namespace lamella {

namespace {

/// What has been spent up to a border, in the order in which it counts.
struct Cost {
  std::uint64_t missed = 0;
  std::size_t layers = 0;
  double deviation = 0.0;

  bool operator<(const Cost& other) const {
    return std::tie(missed, layers, deviation) < std::tie(other.missed, other.layers, other.deviation);
  }
};

struct State {
  Cost cost;
  std::size_t from = 0;  ///< border below
  bool is_reached = false;
};

/// Running sums: what stands at [i] is the sum of costs [0, i).
std::vector<std::uint64_t> sums_of(const std::vector<std::uint64_t>& costs, std::size_t size) {
  std::vector<std::uint64_t> sums(size + 1, 0);
  for (std::size_t i = 0; i < size; ++i) sums[i + 1] = sums[i] + (i < costs.size() ? costs[i] : 0);
  return sums;
}

/// The costs of the borders inside a layer, as differences of sums.
class Borders {
 public:
  explicit Borders(const LayerProblem& problem)
      : size_(problem.height + 1), one_(sums_of(problem.missing, size_)), two_(sums_of(problem.missing_both, size_)) {}
  /// Of the borders between `from` and `to`, both left out.
  [[nodiscard]] std::uint64_t inside(std::size_t from, std::size_t to) const {
    const std::uint64_t alone = one_[std::min(to, size_)] - one_[from + 1];
    if (to < from + 3) return alone;  // no two borders lie inside
    return alone + two_[std::min(to - 1, size_)] - two_[from + 1];
  }

 private:
  std::size_t size_;
  std::vector<std::uint64_t> one_;
  std::vector<std::uint64_t> two_;
};

double deviation_of(const LayerProblem& problem, std::size_t border, std::size_t t) {
  return problem.deviations[border * problem.thicknesses.size() + t];
}

LayerChoice trace(const LayerProblem& problem, const std::vector<State>& states, std::size_t end) {
  LayerChoice choice;
  choice.missed = states[end].cost.missed;
  choice.deviation_sum = states[end].cost.deviation;
  for (std::size_t i = end; i > 0; i = states[i].from) choice.borders.push_back(i);
  choice.borders.push_back(0);
  std::reverse(choice.borders.begin(), choice.borders.end());
  for (std::size_t k = 0; k + 1 < choice.borders.size(); ++k) {
    const std::size_t thickness = choice.borders[k + 1] - choice.borders[k];
    const auto found = std::lower_bound(problem.thicknesses.begin(), problem.thicknesses.end(), thickness);
    const auto t = static_cast<std::size_t>(found - problem.thicknesses.begin());
    choice.largest = std::max(choice.largest, deviation_of(problem, choice.borders[k], t));
  }
  return choice;
}

/// The last states that count as an end, and which borders were reached.
LayerSearch conclude(const LayerProblem& problem, const std::vector<State>& states) {
  LayerSearch search;
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (!states[i].is_reached) continue;
    if (i < problem.height) {
      search.reached.push_back(i);
    } else if (!best || states[i].cost < states[*best].cost) {
      best = i;
    }
  }
  if (best) search.choice = trace(problem, states, *best);
  return search;
}

std::vector<State> start(const LayerProblem& problem) {
  const std::size_t thickest = problem.thicknesses.empty() ? 0 : problem.thicknesses.back();
  std::vector<State> states(problem.height + thickest + 1);
  states[0].is_reached = true;
  return states;
}

Cost with_layer(const LayerProblem& problem, const Borders& borders, const Cost& cost, std::size_t i, std::size_t t) {
  const std::size_t thickness = problem.thicknesses[t];
  return {cost.missed + borders.inside(i, i + thickness), cost.layers + 1,
          cost.deviation + deviation_of(problem, i, t) * static_cast<double>(thickness)};
}

}  // namespace

LayerSearch choose_best(const LayerProblem& problem) {
  const Borders borders(problem);
  std::vector<State> states = start(problem);
  for (std::size_t i = 0; i < problem.height; ++i) {
    if (!states[i].is_reached) continue;
    for (std::size_t t = 0; t < problem.thicknesses.size(); ++t) {
      if (deviation_of(problem, i, t) == LayerProblem::kRefused) continue;
      const Cost cost = with_layer(problem, borders, states[i].cost, i, t);
      State& next = states[i + problem.thicknesses[t]];
      if (!next.is_reached || cost < next.cost) next = {cost, i, true};
    }
  }
  return conclude(problem, states);
}

LayerSearch choose_greedily(const LayerProblem& problem) {
  const Borders borders(problem);
  std::vector<State> states = start(problem);
  std::size_t i = 0;
  while (i < problem.height) {
    std::optional<std::size_t> chosen;
    std::optional<std::size_t> careful;
    for (std::size_t t = 0; t < problem.thicknesses.size(); ++t) {
      if (deviation_of(problem, i, t) == LayerProblem::kRefused) continue;
      chosen = t;
      if (borders.inside(i, i + problem.thicknesses[t]) == 0) careful = t;
    }
    if (!chosen) break;
    const std::size_t t = careful.value_or(*chosen);
    const std::size_t next = i + problem.thicknesses[t];
    states[next] = {with_layer(problem, borders, states[i].cost, i, t), i, true};
    i = next;
  }
  return conclude(problem, states);
}

}  // namespace lamella
