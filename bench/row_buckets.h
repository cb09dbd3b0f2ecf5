#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "bench/peer.h"

namespace lamella::bench {

/// One stretch of rows that a triangle covers on one layer: x = x0 + (m - y0) * slope for m in [first, last).
struct RowRun {
  std::int32_t first = 0;
  std::int32_t last = 0;
  float y0 = 0.0F;
  float x0 = 0.0F;
  float slope = 0.0F;
};

/// Crossings of one solid with the rows of a few layers. Slot s of all rows lies together, so that neighbouring rows
/// are filled and sorted by vector instructions; rows are numbered through all layers, each layer padded to whole
/// vectors.
class RowBuckets {
 public:
  RowBuckets(std::int32_t first_row, std::int32_t last_row, std::int32_t layers);

  void clear();

  /// Adds a run on layer `layer` of the slab; its rows are clipped to those of the solid.
  void add(std::int32_t layer, const RowRun& run);

  /// False when a row had more crossings than there are slots; there are more of them now, and the slab must be cast
  /// again.
  [[nodiscard]] bool grow_if_full();

  /// Sorts every row.
  void sort();

  void visit(std::size_t solid, std::int32_t first_layer, std::int32_t layers, const RowVisitor& visitor) const;

  [[nodiscard]] std::int32_t first_row() const { return first_row_; }
  [[nodiscard]] std::int32_t last_row() const { return last_row_; }

 private:
  std::int32_t first_row_;
  std::int32_t last_row_;
  std::int32_t layer_stride_;  ///< rows a layer, padded
  std::int32_t stride_;        ///< rows of all layers
  std::int32_t capacity_ = 8;  ///< slots a row
  std::vector<std::int32_t> counts_;
  std::vector<float> slots_;  ///< [slot][layer][row]
};

/// Sorts `slots[s * stride + i]`, s < counts[i], ascending in s for each of `rows` rows; `rows` is a whole number of
/// kRowBlock.
void sort_slots(float* slots, const std::int32_t* counts, std::int32_t stride, std::int32_t rows);

inline constexpr std::int32_t kRowBlock = 16;

inline void RowBuckets::add(std::int32_t layer, const RowRun& run) {
  const std::int32_t first = std::max(run.first, first_row_);
  const std::int32_t last = std::min(run.last, last_row_);
  const std::ptrdiff_t base = static_cast<std::ptrdiff_t>(layer) * layer_stride_ - first_row_;
  std::int32_t* counts = counts_.data() + base;
  float* slots = slots_.data() + base;
  for (std::int32_t m = first; m < last; ++m) {
    // A row that is full is counted on, so that grow_if_full() sees how many slots it takes.
    const std::int32_t slot = std::min(counts[m], capacity_ - 1);
    slots[static_cast<std::ptrdiff_t>(slot) * stride_ + m] = run.x0 + (static_cast<float>(m) - run.y0) * run.slope;
    ++counts[m];
  }
}

}  // namespace lamella::bench
