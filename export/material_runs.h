#pragma once

#include <cstdint>
#include <vector>

#include "export/raster_row.h"
#include "slicing/layer_sink.h"

namespace lamella {

/// Pictures show the part from above: the top row is the one with the largest y (command.md, Images).
[[nodiscard]] inline std::int64_t picture_row(const Grid& grid, std::size_t row) {
  return grid.size[1] - 1 - static_cast<std::int64_t>(row);
}

/// One row's run of one material.
struct RowRun {
  std::int64_t picture_row;
  LabelRun pixels;
};

/// The runs of each material of a layer, by its id, rows from the first to the last: one pass over the rows for all.
[[nodiscard]] std::vector<std::vector<RowRun>> runs_by_material(const Layer& layer, const BuildInfo& info);

}  // namespace lamella
