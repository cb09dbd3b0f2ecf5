#include "export/build_check.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "slicing/layer_check.h"

namespace lamella {

namespace {

/// Comparisons are written so that NaN fails.
std::string find_row_fault(std::span<const Segment> row, const BuildInfo& info) {
  double end = -std::numeric_limits<double>::max();
  for (const Segment& segment : row) {
    if (!(segment.x_begin >= end)) return "segments of a row are out of order, overlap or are not finite";
    if (!(segment.x_end >= segment.x_begin)) return "a segment ends before it begins";
    end = segment.x_end;
    if (segment.material.value() >= info.materials.size()) return "a segment has an unknown material";
    if (segment.solid.value() >= info.solids.size()) return "a segment has an unknown solid";
  }
  return end <= std::numeric_limits<double>::max() ? "" : "a segment is not finite";
}

std::string find_rows_fault(const SegmentRows& rows, const BuildInfo& info) {
  if (rows.row_start.empty() || rows.row_start.front() != 0 || rows.row_start.back() != rows.segments.size() ||
      !std::is_sorted(rows.row_start.begin(), rows.row_start.end())) {
    return "row offsets and segments disagree";
  }
  for (std::size_t r = 0; r < rows.rows(); ++r) {
    if (std::string fault = find_row_fault(rows.row(r), info); !fault.empty()) {
      return fault + " (row " + std::to_string(r) + ")";
    }
  }
  const auto limits = make_layer_limits(info.plan.grid.size[1], info.materials, info.solids.size());
  return find_mixtures_fault(rows, limits).value_or("");
}

std::string find_grid_fault(const Grid& grid) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(grid.origin[axis])) return "the grid's origin is not finite";
    if (!std::isfinite(grid.pitch[axis]) || !(grid.pitch[axis] > 0.0)) return "the grid's pitch is not positive";
    if (grid.size[axis] < 1 || grid.size[axis] > std::numeric_limits<std::int32_t>::max()) {
      return "the grid does not have 1 to 2^31 - 1 voxels along each axis";
    }
  }
  return {};
}

}  // namespace

std::string find_build_fault(const BuildInfo& info) {
  for (const LayerSpan& span : info.plan.layers) {
    if (!std::isfinite(span.z_bottom) || !std::isfinite(span.z_sample) || !std::isfinite(span.z_top)) {
      return "a planned layer's height is not finite";
    }
  }
  for (const Material& material : info.materials) {
    for (const MaterialId component : material.components) {
      const bool is_plain = component.value() < info.materials.size() && !info.materials[component].is_graded();
      if (!is_plain) return "material " + material.name + " is mixed of something that is no plain material";
    }
  }
  for (const BuildSolid& solid : info.solids) {
    if (solid.material.value() >= info.materials.size()) return "solid " + solid.path + " has an unknown material";
  }
  return find_grid_fault(info.plan.grid);
}

std::string find_layer_fault(const Layer& layer, const BuildInfo& info) {
  if (layer.index >= info.plan.layers.size()) return "the plan has no such layer";
  const LayerSpan& span = info.plan.layers[layer.index];
  if (layer.z_bottom != span.z_bottom || layer.z_sample != span.z_sample || layer.z_top != span.z_top) {
    return "the heights are not those of the plan";
  }
  if (std::string fault = find_rows_fault(layer.raster, info); !fault.empty()) return fault;
  if (static_cast<std::int64_t>(layer.raster.rows()) != info.plan.grid.size[1]) {
    return "the number of raster rows is not that of the grid";
  }
  if (layer.contours.has_value() != info.plan.chord_error.has_value()) return "its contours are not those of the plan";
  if (!layer.hatch) return {};
  if (!std::isfinite(layer.hatch->angle) || !std::isfinite(layer.hatch->spacing)) return "the hatch is not finite";
  const std::string fault = find_rows_fault(layer.hatch->rows, info);
  return fault.empty() ? fault : "hatch: " + fault;
}

void check_build(const BuildInfo& info) {
  if (std::string fault = find_build_fault(info); !fault.empty()) throw ExportError(fault);
}

void check_layer(const Layer& layer, const BuildInfo& info) {
  const std::string fault = find_layer_fault(layer, info);
  if (!fault.empty()) throw ExportError(fault, "layer " + std::to_string(layer.index));
}

}  // namespace lamella
