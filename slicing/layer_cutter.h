#pragma once

#include <cstdint>
#include <vector>

#include "slicing/combine.h"
#include "slicing/layer.h"
#include "slicing/layer_plan.h"
#include "slicing/slicer.h"

namespace lamella {

/// Some consecutive rows of one layer's raster or hatch lattice: the unit of parallel work.
struct RowTask {
  std::size_t layer = 0;
  bool is_hatch = false;
  std::int64_t first_row = 0;
  std::int64_t last_row = 0;  ///< one past
};

/// What cutting a RowTask gave. Lengths in mm, summed along the rows in order.
struct RowBlock {
  SegmentRows rows;
  CastCounters cast;
  std::vector<double> solid_length;     ///< per solid id, before priorities
  std::vector<double> material_length;  ///< per material id, after priorities
  std::vector<PairLength> overlaps;
  std::vector<PairLength> gaps;
};

/// Cuts rows: casts each row against the solids whose box it meets and combines the spans.
class LayerCutter {
 public:
  /// `solids` are those to cut, all with finite bounds; everything referred to must outlive the cutter.
  LayerCutter(const CastFunction& cast, const Scene& scene, const MaterialTable& table,
              const IdVector<SolidId, SolidMeasure>& measures, const LayerPlan& plan, std::vector<SolidId> solids);

  /// The work of one layer, in the order in which the blocks follow one another: raster rows, then hatch rows.
  [[nodiscard]] std::vector<RowTask> tasks_of(std::size_t layer) const;

  /// Cuts one task. Safe to call from several threads at once; the result depends on the task alone.
  [[nodiscard]] RowBlock cut(const RowTask& task) const;

  /// Joins the blocks of one layer's tasks.
  [[nodiscard]] Layer assemble(const std::vector<RowTask>& tasks, const std::vector<RowBlock>& blocks,
                               std::size_t layer) const;

 private:
  [[nodiscard]] std::vector<SolidId> solids_at(double z) const;

  const CastFunction& cast_;
  const IdVector<SolidId, SolidMeasure>& measures_;
  const LayerPlan& plan_;
  std::vector<SolidId> solids_;
  CombineRules rules_;
  std::size_t material_count_ = 0;
};

}  // namespace lamella
