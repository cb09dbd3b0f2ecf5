#pragma once

#include <vector>

#include "slicing/slab.h"
#include "slicing/span/span_engine.h"

namespace lamella::test {

/// What the eight neighbours of every row have in common with it, and what any of them has: bounds for the same rows
/// found in another way, which hold at tangencies and ties as well.
class NeighborRows {
 public:
  /// Neighbours lie `reach` mm aside, across the rows and in z.
  NeighborRows(const SpanEngine& engine, const std::vector<LayerRequest>& requests, double reach);

  /// By how much `spans`, those of `solid` on a row, go beyond the bounds grown by the reach at every end: the longest
  /// span that is invented or lost, mm.
  [[nodiscard]] double excess(std::size_t layer, std::size_t lattice, std::size_t row, SolidId solid,
                              const std::vector<Interval>& spans) const;

  /// The row's own spans.
  [[nodiscard]] std::vector<Interval> spans(std::size_t layer, std::size_t lattice, std::size_t row,
                                            SolidId solid) const;

 private:
  std::vector<std::vector<LayerSpans>> cuts_;
  double reach_;
};

}  // namespace lamella::test
