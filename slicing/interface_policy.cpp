#include "slicing/interface_policy.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace lamella {

namespace {

/// A run of one material at one priority: the union of overlapping or abutting spans.
struct Run {
  int priority = 0;
  MaterialId material;
  double begin = 0.0;
  double end = 0.0;
  int best_rank = 0;
  std::size_t first_span = 0;  ///< its spans in the sorted array
  std::size_t last_span = 0;
  double keep_from = -std::numeric_limits<double>::infinity();
  double keep_to = std::numeric_limits<double>::infinity();
};

const Assignment& assignment(const CombineRules& rules, SolidId solid) { return rules.table->assignments[solid]; }

std::vector<Run> unite_materials(std::vector<Span>& spans, const CombineRules& rules) {
  const auto key = [&](const Span& span) {
    const Assignment& who = assignment(rules, span.solid);
    return std::tuple(who.priority, who.material, span.begin, span.end, rules.rank[span.solid]);
  };
  std::sort(spans.begin(), spans.end(), [&](const Span& a, const Span& b) { return key(a) < key(b); });
  std::vector<Run> runs;
  for (std::size_t i = 0; i < spans.size(); ++i) {
    const Assignment& who = assignment(rules, spans[i].solid);
    const int rank = rules.rank[spans[i].solid];
    if (!runs.empty() && runs.back().priority == who.priority && runs.back().material == who.material &&
        spans[i].begin <= runs.back().end) {
      runs.back().end = std::max(runs.back().end, spans[i].end);
      runs.back().best_rank = std::max(runs.back().best_rank, rank);
      runs.back().last_span = i + 1;
    } else {
      Run run;
      run.priority = who.priority;
      run.material = who.material;
      run.begin = spans[i].begin;
      run.end = spans[i].end;
      run.best_rank = rank;
      run.first_span = i;
      run.last_span = i + 1;
      runs.push_back(run);
    }
  }
  return runs;
}

double interface_of(OverlapPolicy policy, double first, double last) {
  if (policy == OverlapPolicy::entry) return first;
  if (policy == OverlapPolicy::exit) return last;
  return first + 0.5 * (last - first);
}

void place_interfaces(std::vector<Run>& runs, OverlapPolicy policy) {
  visit_shared_overlaps(runs, [policy](Run& left, Run& right) {
    left.keep_to = right.keep_from = interface_of(policy, right.begin, left.end);
  });
}

}  // namespace

bool has_interfaces(OverlapPolicy policy) {
  return policy != OverlapPolicy::priority && policy != OverlapPolicy::error;
}

void apply_interface_policy(std::vector<Span>& spans, const CombineRules& rules) {
  const OverlapPolicy policy = rules.table->policy;
  if (!has_interfaces(policy)) return;
  std::vector<Run> runs = unite_materials(spans, rules);
  place_interfaces(runs, policy);
  for (const Run& run : runs) {
    for (std::size_t i = run.first_span; i < run.last_span; ++i) {
      spans[i].begin = std::max(spans[i].begin, run.keep_from);
      spans[i].end = std::min(spans[i].end, run.keep_to);
    }
  }
}

}  // namespace lamella
