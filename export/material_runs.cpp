#include "export/material_runs.h"

namespace lamella {

std::vector<std::vector<RowRun>> runs_by_material(const Layer& layer, const BuildInfo& info) {
  std::vector<std::vector<RowRun>> by_material(info.materials.size());
  const RowRaster raster(info.plan.grid);
  std::vector<LabelRun> runs;
  for (std::size_t row = 0; row < layer.raster.rows(); ++row) {
    runs.clear();
    raster.append_runs(layer.raster.row(row), runs);
    for (const LabelRun& run : runs) by_material[run.label - 1].push_back({picture_row(info.plan.grid, row), run});
  }
  return by_material;
}

}  // namespace lamella
