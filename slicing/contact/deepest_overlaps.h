#pragma once

#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "slicing/combine.h"
#include "slicing/contact/solid_distances.h"
#include "slicing/slab.h"

namespace lamella {

/// Remembers for every pair of solids on which rows of a layer they overlap, and measures how deep that is.
class DeepestOverlaps {
 public:
  /// Starts a layer.
  void clear() { rows_.clear(); }
  /// What two solids share on a row of the lattice, counted from 0.
  void add(const PairLength& overlap, std::size_t row);

  /// For every pair how far inside both solids the middle of their longest common stretch on its row lies, mm; one
  /// entry a pair, ids ascending.
  void measure(const SolidDistances& distances, double z, const RowLattice& lattice, const SpanRows& spans,
               std::vector<PairLength>& out) const;

 private:
  struct Rows {
    std::size_t first = 0;
    std::size_t last = 0;
    std::size_t longest = 0;
    double length = 0.0;  ///< mm, on the longest
  };
  std::map<std::pair<SolidId, SolidId>, Rows> rows_;
};

}  // namespace lamella
