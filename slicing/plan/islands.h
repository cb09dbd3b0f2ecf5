#pragma once

#include "slicing/plan/layer_statistics.h"

namespace lamella {

/// Fills islands, specks, smallest, shortest and thin of `by_material` (one entry per material id) from raster rows.
void measure_islands(const SegmentRows& raster, double pitch, double width,
                     std::vector<MaterialStatistics>& by_material);

}  // namespace lamella
