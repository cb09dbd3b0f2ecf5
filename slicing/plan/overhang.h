#pragma once

#include "slicing/plan/layer_statistics.h"

namespace lamella {

/// Adds to each material (by its id) the length in mm of its raster segments that is over nothing of `below` grown by
/// discs of radius `reach`, cut at the rows: row j' reaches sqrt(reach^2 - (j - j')^2 pitch^2) beyond its runs.
void add_overhang(const SegmentRows& raster, const Cover& below, double reach, double pitch,
                  std::vector<double>& length);

}  // namespace lamella
