#include "export/build_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/error.h"

namespace lamella {

namespace {

void require(bool holds, const char* what, const std::string& where) {
  if (!holds) throw ExportError(what, where);
}

void check_rows(const SegmentRows& rows, const BuildInfo& info, const std::string& where) {
  require(!rows.row_start.empty() && rows.row_start.front() == 0, "row offsets do not start at 0", where);
  require(std::is_sorted(rows.row_start.begin(), rows.row_start.end()), "row offsets are out of order", where);
  require(rows.row_start.back() == rows.segments.size(), "row offsets and segments disagree", where);
  for (const Segment& segment : rows.segments) {
    require(segment.material.value() < info.materials.size(), "a segment has an unknown material", where);
    require(segment.solid.value() < info.solids.size(), "a segment has an unknown solid", where);
  }
}

}  // namespace

void check_build(const BuildInfo& info) {
  const Grid& grid = info.plan.grid;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string where = std::string("grid axis ") + "xyz"[axis];
    require(std::isfinite(grid.origin[axis]), "the origin is not finite", where);
    require(std::isfinite(grid.pitch[axis]) && grid.pitch[axis] > 0.0, "the pitch is not positive", where);
    require(grid.size[axis] >= 1 && grid.size[axis] <= std::numeric_limits<std::int32_t>::max(),
            "the number of voxels is not within 1 and 2^31 - 1", where);
  }
}

void check_layer(const Layer& layer, const BuildInfo& info) {
  const std::string where = "layer " + std::to_string(layer.index);
  check_rows(layer.raster, info, where);
  require(static_cast<std::int64_t>(layer.raster.rows()) == info.plan.grid.size[1],
          "the number of raster rows is not that of the grid", where);
  if (layer.hatch) check_rows(layer.hatch->rows, info, where + ", hatch");
}

}  // namespace lamella
