#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "core/geometry.h"
#include "materials/machine.h"
#include "materials/material_table.h"
#include "slicing/layer.h"
#include "slicing/layer_plan.h"
#include "slicing/plan/paces.h"

namespace lamella {

/// One material on one layer. A run is what touching segments of one material make together on a row.
struct MaterialStatistics {
  MaterialId material;
  std::uint64_t segments = 0;  ///< of the hatch rows where the build has them, else of the raster rows
  double length = 0.0;         ///< mm, of those segments
  double travel = 0.0;         ///< mm between them, rows in their order, every second one backwards unless one-way
  double area = 0.0;           ///< mm^2, by the raster rows, like all that follows
  double shortest = 0.0;       ///< mm, the shortest run
  double thin = 0.0;           ///< mm^2 in runs shorter than the machine's width
  std::uint32_t islands = 0;   ///< pieces; runs of neighbouring rows that overlap are one piece
  std::uint32_t specks = 0;    ///< islands that are within the machine's width along x or along y
  double smallest = 0.0;       ///< mm^2, the smallest island
  double unsupported = 0.0;    ///< mm^2 over no material of the layer below grown by the self-support distance
  std::vector<double> times =
      {};  ///< s that laying it down takes at each pace of StatisticsOptions::paces, travel included
};

struct LayerStatistics {
  std::uint32_t index = 0;
  double z_bottom = 0.0;
  double z_top = 0.0;
  Box2 box;                                   ///< of the raster segments, rows with their pitch; may be empty
  std::vector<MaterialStatistics> materials;  ///< that the layer holds, ascending
};

/// What is measured against.
struct StatisticsOptions {
  double width = 0.0;                  ///< mm, Machine::width
  std::optional<double> self_support;  ///< mm; absent: nothing counts as unsupported
  bool serpentine = true;
  bool use_hatch = false;                     ///< of segments, length and travel
  std::vector<std::vector<Pace>> paces = {};  ///< by material; empty: no times are asked for
};

/// Where a layer has material of any kind: per raster row disjoint intervals, ascending.
struct Cover {
  std::vector<std::uint64_t> row_start{0};
  std::vector<Interval> runs;

  [[nodiscard]] std::size_t rows() const { return row_start.size() - 1; }
  [[nodiscard]] std::span<const Interval> row(std::size_t r) const {
    return {runs.data() + row_start[r], runs.data() + row_start[r + 1]};
  }
};

[[nodiscard]] Cover cover_of(const SegmentRows& raster);

/// Measures a layer of a build with this grid. `below` is the cover of the layer below, null for what stands on the
/// plate.
[[nodiscard]] LayerStatistics measure_layer(const Layer& layer, const Grid& grid, std::size_t materials,
                                            const StatisticsOptions& options, const Cover* below);

/// Puts the components of graded materials in their place: of what they take only the area is known.
void credit_components(const Layer& layer, const Grid& grid, const IdVector<MaterialId, Material>& materials,
                       LayerStatistics& statistics);

}  // namespace lamella
