#pragma once

#include <span>
#include <vector>

#include "core/ids.h"
#include "core/tolerances.h"
#include "materials/material_table.h"
#include "model/measure.h"
#include "slicing/hit.h"
#include "slicing/layer.h"

namespace lamella {

/// The total order of command.md in which solids win where they overlap: priority, then smaller exact volume (to seven
/// digits, so that integration noise does not decide), then the bytewise smaller path, then bounds. rank[s] is larger
/// for the winner; ranks are 0, 1, 2, ...
[[nodiscard]] IdVector<SolidId, int> rank_solids(const Scene& scene, const MaterialTable& table,
                                                 const IdVector<SolidId, SolidMeasure>& measures);

/// Length along one row that two solids share, or of a gap between them.
struct PairLength {
  SolidId first;  ///< the lower id
  SolidId second;
  double length = 0.0;  ///< mm, positive

  bool operator==(const PairLength&) const = default;
};

/// Leaves one entry a pair, ids ascending, with the sum of its lengths in the order in which they came.
void collect_pairs(std::vector<PairLength>& pairs);

/// How one row's spans become segments (docs/methods/layers.md).
struct CombineRules {
  const MaterialTable* table = nullptr;       ///< not owned; material, priority and overlap policy
  IdVector<SolidId, int> rank;                ///< of rank_solids()
  double gap_tolerance = tolerance::kMinGap;  ///< mm along the row; gaps up to it go to the higher rank
  IdVector<FaceId, double> face_tolerance;    ///< mm, may be empty; widens the gap tolerance at the faces it knows
};

struct CombinedRow {
  std::vector<Segment> segments;  ///< disjoint, ascending, neighbours of equal material and solid merged
  std::vector<PairLength>
      overlaps;  ///< pairs of different material, ids ascending; one within the gap tolerance only touches
  std::vector<PairLength> gaps;  ///< filled gaps between different solids, ids ascending
};

/// Combines all solids' spans of one row (any order; each solid's own disjoint) into labelled half-open segments.
///
/// Each segment carries the solid of highest rank there. The result does not depend on the order of `spans`, and
/// permuting solid ids permutes the ids in it and changes nothing else. Spans that are empty, reversed or not finite
/// are ignored. `out` is overwritten; its memory is reused. One sort, then work linear in the spans times how many
/// solids lie over one another.
void combine_row(std::span<const Span> spans, const CombineRules& rules, CombinedRow& out);

}  // namespace lamella
