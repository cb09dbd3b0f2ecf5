#pragma once

#include <algorithm>
#include <tuple>
#include <vector>

#include "slicing/combine.h"

namespace lamella {

/// Whether the policy places interfaces in overlaps: `entry`, `exit` and `average`.
[[nodiscard]] bool has_interfaces(OverlapPolicy policy);

/// Clips `spans` so that solids of equal priority and different material share an overlap by the table's policy: the
/// interface lies at the overlap's first point (`entry`), last point (`exit`) or midpoint (`average`) along the row.
///
/// Per priority, spans of one material are united first. Only a staggered overlap has an interface; of a run that lies
/// wholly inside another nothing is clipped, so that the rank decides. Does nothing under the other policies.
void apply_interface_policy(std::vector<Span>& spans, const CombineRules& rules);

/// Calls share(left, right) for every two runs, of one priority but different material, whose overlap a policy shares
/// out. Runs that no other run of their priority contains have ascending begins *and* ends, so their interfaces ascend
/// too and each keeps one interval; the others share nothing. Sorts the runs, which have priority, begin, end and
/// best_rank; those of one priority and material don't touch each other.
template <class Run, class Share>
void visit_shared_overlaps(std::vector<Run>& runs, const Share& share) {
  std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) {
    return std::tuple(a.priority, a.begin, -a.end, -a.best_rank) <
           std::tuple(b.priority, b.begin, -b.end, -b.best_rank);
  });
  Run* previous = nullptr;
  for (Run& run : runs) {
    if (previous != nullptr && previous->priority != run.priority) previous = nullptr;
    if (previous != nullptr && run.end <= previous->end) continue;
    if (previous != nullptr && run.begin < previous->end) share(*previous, run);
    previous = &run;
  }
}

}  // namespace lamella
