#include "slicing/plan/weigh_matchings.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <random>
#include <set>

#include "slicing/plan/change_totals.h"
#include "slicing/plan/matching.h"

namespace lamella {

namespace {

constexpr std::uint32_t kFree = UINT32_MAX;

/// Layers of the same needs in a row.
struct NeedRun {
  std::vector<std::uint32_t> needs;
  std::size_t layers = 0;
};

/// The problem without needs that no layer has, which are numbered anew.
struct Compact {
  std::vector<std::uint32_t> used;     ///< the problem's numbers, ascending
  std::vector<std::uint32_t> holders;  ///< per used need
  std::vector<NeedRun> runs;
};

Compact compact(const MatchingProblem& problem) {
  Compact out;
  for (const auto& layer : problem.layers) out.used.insert(out.used.end(), layer.begin(), layer.end());
  std::sort(out.used.begin(), out.used.end());
  out.used.erase(std::unique(out.used.begin(), out.used.end()), out.used.end());
  for (const std::uint32_t need : out.used) out.holders.push_back(problem.holders[need]);
  for (const auto& layer : problem.layers) {
    if (layer.empty()) continue;
    std::vector<std::uint32_t> needs;
    for (const std::uint32_t need : layer) {
      const auto place = std::lower_bound(out.used.begin(), out.used.end(), need);
      needs.push_back(static_cast<std::uint32_t>(place - out.used.begin()));
    }
    if (out.runs.empty() || out.runs.back().needs != needs) out.runs.push_back({std::move(needs), 0});
    ++out.runs.back().layers;
  }
  return out;
}

/// Tools that may be exchanged without changing any cost: for each the lowest of its kind.
std::vector<std::uint32_t> find_alike(const MatchingProblem& problem, const Compact& needs,
                                      const std::vector<std::vector<ChangeCost>>& change) {
  const auto are_alike = [&](std::uint32_t a, std::uint32_t b) {
    if (change[a][b] != change[b][a]) return false;
    for (std::uint32_t other = 0; other < change.size(); ++other) {
      if (other == a || other == b) continue;
      if (change[a][other] != change[b][other] || change[other][a] != change[other][b]) return false;
    }
    for (std::size_t n = 0; n < needs.used.size(); ++n) {
      if ((needs.holders[n] >> a & 1U) != (needs.holders[n] >> b & 1U)) return false;
      const auto& time = problem.laying_time[needs.used[n]];
      if ((needs.holders[n] >> a & 1U) != 0 && time[a] != time[b]) return false;
    }
    return true;
  };
  std::vector<std::uint32_t> kind(change.size());
  for (std::uint32_t tool = 0; tool < kind.size(); ++tool) {
    kind[tool] = tool;
    for (std::uint32_t lower = 0; lower < tool; ++lower) {
      if (kind[lower] != lower || !are_alike(lower, tool)) continue;
      kind[tool] = lower;
      break;
    }
  }
  return kind;
}

class Weigher {
 public:
  Weigher(const MatchingProblem& problem, PathCache& paths, std::uint64_t steps)
      : problem_(problem),
        change_(paths.cost()),
        steps_(steps),
        needs_(compact(problem)),
        kind_(find_alike(problem, needs_, change_)),
        totals_(paths, ChangeTotals::Figure::cost) {}

  std::optional<WeighedMatching> run() {
    std::vector<std::uint32_t> all(needs_.used.size());
    std::iota(all.begin(), all.end(), 0U);
    const auto first = match_tools(all, needs_.holders);
    if (!first) return std::nullopt;
    bound_ = lower_bound();
    weigh(*first);
    if (best_cost_ != bound_ && can_weigh_within(steps_)) weigh(fastest_matching());
    bool is_complete = best_cost_ == bound_;
    if (!is_complete && may_enumerate()) {
      std::vector<std::uint32_t> tool_of;
      is_complete = enumerate(tool_of, 0);
    }
    if (!is_complete) improve();
    WeighedMatching out;
    out.tool_of.assign(problem_.holders.size(), 0);
    for (std::size_t n = 0; n < best_.size(); ++n) out.tool_of[needs_.used[n]] = best_[n];
    out.cost = best_cost_;
    out.lower_bound = is_complete && totals_.is_exact() ? best_cost_ : bound_;
    out.weighed = weighed_;
    return out;
  }

 private:
  [[nodiscard]] std::int64_t laying_time(std::size_t need, std::uint32_t tool) const {
    return problem_.laying_time[needs_.used[need]][tool];
  }

  [[nodiscard]] std::uint64_t work() const { return totals_.work() + nodes_; }
  /// Whether what may be the most that a matching takes is left.
  [[nodiscard]] bool can_weigh_within(std::uint64_t steps) const { return work() + most_work_ <= steps; }

  /// Finds the cost of a matching, and keeps the best.
  ChangeCost weigh(const std::vector<std::uint32_t>& tool_of) {
    const std::uint64_t before = work();
    std::vector<ChangeTotals::Run> runs;
    for (const NeedRun& run : needs_.runs) {
      std::uint32_t tools = 0;
      for (const std::uint32_t need : run.needs) tools |= 1U << tool_of[need];
      runs.push_back({tools, run.layers});
    }
    ChangeCost cost = totals_.least(runs);
    for (std::size_t n = 0; n < tool_of.size(); ++n) cost.time += laying_time(n, tool_of[n]);
    nodes_ += needs_.runs.size();
    ++weighed_;
    most_work_ = std::max(most_work_, work() - before);
    if (best_.empty() || cost < best_cost_) {
      best_ = tool_of;
      best_cost_ = cost;
    }
    return cost;
  }

  /// Changing tools costs no less than if each change were between the best two tools for its needs, and laying down
  /// takes no less than in the fastest matching.
  [[nodiscard]] ChangeCost lower_bound() const {
    std::vector<ChangeTotals::Run> runs;
    for (const NeedRun& run : needs_.runs) {
      std::uint32_t set = 0;
      for (const std::uint32_t need : run.needs) set |= 1U << need;
      runs.push_back({set, run.layers});
    }
    ChangeCost bound = least_changes(runs);
    const std::vector<std::uint32_t> fastest = fastest_matching();
    for (std::size_t n = 0; n < fastest.size(); ++n) bound.time += laying_time(n, fastest[n]);
    return bound;
  }

  /// `runs` are of needs instead of tools.
  [[nodiscard]] ChangeCost least_changes(const std::vector<ChangeTotals::Run>& runs) const {
    ChangeCost within;  // of the layers themselves, of which each needs one change less than tools
    std::uint64_t work = 0;
    const ChangeCost least = least_change(UINT32_MAX, UINT32_MAX);
    for (const ChangeTotals::Run& run : runs) {
      const auto size = static_cast<std::uint64_t>(std::popcount(run.tools));
      within.changes += least.changes * static_cast<std::int64_t>((size - 1) * run.layers);
      if (size > static_cast<std::uint64_t>(kMaxExactTools)) work += size * size * size * size;
    }
    if (work > steps_) return within;
    const std::size_t needs = needs_.used.size();
    std::vector<std::vector<ChangeCost>> change(needs, std::vector<ChangeCost>(needs));
    for (std::size_t a = 0; a < needs; ++a) {
      for (std::size_t b = 0; b < needs; ++b) {
        if (a != b) change[a][b] = least_change(needs_.holders[a], needs_.holders[b]);
      }
    }
    PathCache paths(change, most_exact_needs(runs));
    return ChangeTotals(paths, ChangeTotals::Figure::bound).least(runs);
  }

  /// So many needs on a layer that searching through their orders takes no more than a part of the steps.
  [[nodiscard]] int most_exact_needs(const std::vector<ChangeTotals::Run>& runs) const {
    std::set<std::uint32_t> sets;
    for (const ChangeTotals::Run& run : runs) sets.insert(run.tools);
    for (int most = kMaxExactTools; most > 1; --most) {
      std::uint64_t work = 0;
      for (const std::uint32_t set : sets) {
        const int size = std::popcount(set);
        if (size <= most) work += path_search_work(static_cast<std::size_t>(size));
      }
      if (work <= steps_ / 8) return most;
    }
    return 1;
  }

  [[nodiscard]] ChangeCost least_change(std::uint32_t from, std::uint32_t to) const {
    std::optional<ChangeCost> least;
    const std::size_t tools = change_.size();
    for (std::size_t a = 0; a < tools; ++a) {
      for (std::size_t b = 0; b < tools; ++b) {
        if (a == b || (from >> a & 1U) == 0 || (to >> b & 1U) == 0) continue;
        if (!least || change_[a][b] < *least) least = change_[a][b];
      }
    }
    return least.value_or(ChangeCost{});
  }

  /// The matching whose laying down takes the least time. Times are whole numbers that doubles hold.
  [[nodiscard]] std::vector<std::uint32_t> fastest_matching() const {
    double sum = 1.0;
    std::vector<std::vector<double>> cost(needs_.used.size(), std::vector<double>(change_.size()));
    for (std::size_t n = 0; n < cost.size(); ++n) {
      for (std::uint32_t tool = 0; tool < change_.size(); ++tool) {
        cost[n][tool] = static_cast<double>(laying_time(n, tool));
      }
      sum += *std::max_element(cost[n].begin(), cost[n].end());
    }
    for (std::size_t n = 0; n < cost.size(); ++n) {
      for (std::uint32_t tool = 0; tool < change_.size(); ++tool) {
        if ((needs_.holders[n] >> tool & 1U) == 0) cost[n][tool] = sum;
      }
    }
    return match_cheapest(cost);
  }

  /// Whether there are so few matchings that all can be weighed. Only the first of the free tools of a kind is tried.
  bool may_enumerate() {
    std::uint64_t each = 1;
    for (const NeedRun& run : needs_.runs) {
      const std::uint64_t pairs = run.needs.size() * run.needs.size();
      each += 1 + (2 + static_cast<std::uint64_t>(std::popcount(run.layers - 1))) * pairs;
    }
    return count_matchings(0, 0, steps_ / each) <= steps_ / each;
  }

  /// How many matchings there are where needs before `need` have the tools `taken`; stops at more than `most`.
  std::uint64_t count_matchings(std::size_t need, std::uint32_t taken, std::uint64_t most) {
    if (need == needs_.used.size()) return 1;
    if (++nodes_ > steps_) return most + 1;
    std::uint64_t count = 0;
    for (std::uint32_t tool = 0; tool < kind_.size() && count <= most; ++tool) {
      if (is_choice(need, tool, taken)) count += count_matchings(need + 1, taken | 1U << tool, most - count);
    }
    return count;
  }

  [[nodiscard]] bool is_choice(std::size_t need, std::uint32_t tool, std::uint32_t taken) const {
    if ((taken >> tool & 1U) != 0 || (needs_.holders[need] >> tool & 1U) == 0) return false;
    for (std::uint32_t lower = kind_[tool]; lower < tool; ++lower) {
      if (kind_[lower] == kind_[tool] && (taken >> lower & 1U) == 0) return false;
    }
    return true;
  }

  /// Weighs all matchings that begin with these tools; false if the steps don't suffice.
  bool enumerate(std::vector<std::uint32_t>& tool_of, std::uint32_t taken) {
    if (!can_weigh_within(steps_)) return false;
    ++nodes_;
    if (tool_of.size() == needs_.used.size()) {
      weigh(tool_of);
      return true;
    }
    for (std::uint32_t tool = 0; tool < kind_.size(); ++tool) {
      if (!is_choice(tool_of.size(), tool, taken)) continue;
      tool_of.push_back(tool);
      const bool is_done = enumerate(tool_of, taken | 1U << tool);
      tool_of.pop_back();
      if (!is_done) return false;
    }
    return true;
  }

  /// Goes down from the best matching to one that no exchange betters, then again and again from beside the best.
  void improve() {
    const std::uint64_t limit = std::max(work(), steps_ / 2) + steps_ / 2;
    std::mt19937 random;  // the same numbers every time
    descend(best_, best_cost_, limit);
    while (best_cost_ != bound_ && can_weigh_within(limit)) {
      const std::vector<std::uint32_t> beside = disturbed(best_, random);
      descend(beside, weigh(beside), limit);
    }
  }

  /// Exchanges tools as long as that gains anything, from a matching of this cost on.
  void descend(std::vector<std::uint32_t> at, ChangeCost cost, std::uint64_t limit) {
    for (bool is_better = true; is_better;) {
      is_better = false;
      for (std::size_t need = 0; need < at.size(); ++need) {
        for (std::uint32_t tool = 0; tool < kind_.size(); ++tool) {
          std::vector<std::uint32_t> next = at;
          if (!exchange(next, need, tool)) continue;
          if (best_cost_ == bound_ || !can_weigh_within(limit)) return;
          const ChangeCost reached = weigh(next);
          if (!(reached < cost)) continue;
          at = std::move(next);
          cost = reached;
          is_better = true;
        }
      }
    }
  }

  /// After three exchanges, whatever they cost.
  std::vector<std::uint32_t> disturbed(std::vector<std::uint32_t> tool_of, std::mt19937& random) const {
    constexpr int kExchanges = 3;
    constexpr int kTries = 100;
    for (int done = 0, tries = 0; done < kExchanges && tries < kTries; ++tries) {
      const std::size_t need = random() % tool_of.size();
      const auto tool = static_cast<std::uint32_t>(random() % kind_.size());
      if (exchange(tool_of, need, tool)) ++done;
    }
    return tool_of;
  }

  /// Moves a need to a free tool, or swaps it with the need that has the tool; false where that can't be or changes
  /// nothing.
  bool exchange(std::vector<std::uint32_t>& tool_of, std::size_t need, std::uint32_t tool) const {
    const std::uint32_t own = tool_of[need];
    if (kind_[tool] == kind_[own] || (needs_.holders[need] >> tool & 1U) == 0) return false;
    const auto other = std::find(tool_of.begin(), tool_of.end(), tool);
    if (other != tool_of.end()) {
      const auto place = static_cast<std::size_t>(other - tool_of.begin());
      if ((needs_.holders[place] >> own & 1U) == 0) return false;
      *other = own;
    }
    tool_of[need] = tool;
    return true;
  }

  const MatchingProblem& problem_;
  const std::vector<std::vector<ChangeCost>>& change_;
  std::uint64_t steps_;
  Compact needs_;
  std::vector<std::uint32_t> kind_;
  ChangeTotals totals_;
  std::vector<std::uint32_t> best_;
  ChangeCost best_cost_;
  ChangeCost bound_;
  std::uint64_t weighed_ = 0;
  std::uint64_t nodes_ = 0;
  std::uint64_t most_work_ = 0;
};

}  // namespace

std::optional<WeighedMatching> weigh_matchings(const MatchingProblem& problem, PathCache& paths, std::uint64_t steps) {
  return Weigher(problem, paths, steps).run();
}

}  // namespace lamella
