#pragma once

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

}  // namespace lamella
