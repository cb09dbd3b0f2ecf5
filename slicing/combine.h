#pragma once

#include <span>
#include <vector>

#include "core/ids.h"
#include "materials/material_table.h"
#include "model/measure.h"
#include "slicing/hit.h"
#include "slicing/layer.h"

namespace lamella {

/// The total order of command.md in which solids win where they overlap: priority, then smaller exact volume, then the
/// bytewise smaller path, then bounds. rank[s] is larger for the winner.
[[nodiscard]] IdVector<SolidId, int> rank_solids(const Scene& scene, const MaterialTable& table,
                                                 const IdVector<SolidId, SolidMeasure>& measures);

/// Length along one row that two solids share, or of a gap between them.
struct PairLength {
  SolidId first;   ///< the lower id
  SolidId second;
  double length = 0.0;
};

/// How one row's spans become segments.
struct CombineRules {
  const MaterialTable* table = nullptr;
  IdVector<SolidId, int> rank;
  double gap_tolerance = 0.0;  ///< mm along the row; gaps up to it go to the higher rank
};

struct CombinedRow {
  std::vector<Segment> segments;      ///< disjoint, ascending, neighbours of equal material and solid merged
  std::vector<PairLength> overlaps;   ///< pairs of different material
  std::vector<PairLength> gaps;
};

/// Combines all solids' spans of one row (any order; each solid's own disjoint and ascending) into labelled segments.
/// Work is linear in the spans but for one sort.
void combine_row(std::span<const Span> spans, const CombineRules& rules, CombinedRow& out);

}  // namespace lamella
