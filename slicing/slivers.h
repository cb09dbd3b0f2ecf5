#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "slicing/combine.h"

namespace lamella {

/// Gives slivers to their neighbours: where two solids share a surface within the gap tolerance, a third one (or one of
/// them) may show for less than that beside or between them, by rounding.
///
/// A sliver is a segment of `segments` from `row_begin` on that meets another, is no longer than the gap tolerance of
/// the faces at its ends, and shows less than the whole of its solid's span or is no longer than tolerance::kMinGap. It
/// goes to the neighbour that it meets, of two to that of higher rank. A body that is thinner than the tolerance and
/// lies open stays. `spans` are the row's, as combined.
void join_slivers(std::span<const Span> spans, const CombineRules& rules, std::size_t row_begin,
                  std::vector<Segment>& segments);

}  // namespace lamella
