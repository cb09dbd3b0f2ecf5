#pragma once

#include "model/scene.h"
#include "slicing/slab.h"
#include "slicing/span/row_columns.h"
#include "slicing/span/row_sweep.h"
#include "slicing/span/section.h"

namespace lamella::span {

/// Scan conversion of the sections of one layer: from arcs to the spans of every row.
///
/// Each stretch of an arc over which y runs one way covers the rows between its two heights, half open; neighbours
/// share their heights bit for bit, and so do the arcs that meet in a node. So on every row the crossings up and down
/// cancel in integers, however inaccurate the arcs are. Memory is reused from layer to layer.
class RowCast {
 public:
  explicit RowCast(const Scene& scene) : scene_(&scene), sweep_(scene) {}

  /// `section` holds the arcs of all solids on the layer. Writes the spans of lattice number `number` of the layer, and
  /// adds to its counters and failed checks.
  void cast(const Section& section, const RowLattice& lattice, std::size_t number, LayerSpans& out);

 private:
  void count_hits(const Section& section, const RowLattice& lattice, LayerSpans& out) const;

  const Scene* scene_;
  RowColumns columns_;
  RowSweep sweep_;
};

}  // namespace lamella::span
