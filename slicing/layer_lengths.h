#pragma once

#include <cstdint>
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
  std::vector<PairLength> depths;    ///< mm inside both solids of an overlap; one a pair, ids ascending
};

/// Sums of lengths by pair of solids: an open-addressed table that keeps its memory.
class PairSums {
 public:
  void clear();
  void add(const PairLength& length);
  /// One entry a pair, ids ascending.
  void write(std::vector<PairLength>& out) const;

 private:
  struct Slot {
    SolidId first;  ///< not valid: free
    SolidId second;
    CompensatedSum sum;
  };
  [[nodiscard]] std::size_t find(SolidId first, SolidId second) const;
  void grow();

  std::vector<Slot> slots_;          ///< a power of two of them, at most half taken
  std::vector<std::uint32_t> used_;  ///< the slots that are taken
};

/// Adds up the lengths of one layer, row by row in order.
class LengthSums {
 public:
  /// Starts a layer.
  void clear(std::size_t solids, std::size_t materials);
  /// Adds one row: what the engine gave and what became of it.
  void add(std::span<const Span> spans, std::span<const Segment> segments, const RowCombiner& row);
  /// Adds a gap that was filled before the row was combined.
  void add_gap(const PairLength& gap) { gaps_.add(gap); }
  void write(LayerLengths& out) const;

 private:
  std::vector<CompensatedSum> solids_;
  std::vector<CompensatedSum> materials_;
  PairSums overlaps_;
  PairSums gaps_;
};

}  // namespace lamella
