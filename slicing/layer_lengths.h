#pragma once

#include <span>
#include <vector>

#include "slicing/combine.h"
#include "slicing/compensated_sum.h"

namespace lamella {

/// Lengths along the raster rows of one layer, mm.
struct LayerLengths {
  std::vector<double> solids;        ///< by solid id, before priorities
  std::vector<double> materials;     ///< by material id, after priorities
  std::vector<PairLength> overlaps;  ///< one a pair, ids ascending
  std::vector<PairLength> gaps;      ///< one a pair, ids ascending
};

/// Adds up the lengths of one layer, row by row in order.
class LengthSums {
 public:
  /// Starts a layer.
  void clear(std::size_t solids, std::size_t materials);
  void add(std::span<const Span> spans, const CombinedRow& row);
  void write(LayerLengths& out) const;

 private:
  std::vector<CompensatedSum> solids_;
  std::vector<CompensatedSum> materials_;
  std::vector<PairLength> overlaps_;
  std::vector<PairLength> gaps_;
};

}  // namespace lamella
