#include "slicing/layer_check.h"

#include <cmath>

namespace lamella {

namespace {

/// Comparisons are written so that NaN fails.
std::optional<std::string> find_row_fault(std::span<const Segment> row, const LayerLimits& limits) {
  for (std::size_t i = 0; i < row.size(); ++i) {
    const Segment& segment = row[i];
    if (!std::isfinite(segment.x_begin) || !std::isfinite(segment.x_end)) return "a segment's end is not finite";
    if (!(segment.x_begin < segment.x_end)) return "a segment is empty or reversed";
    if (i > 0 && !(row[i - 1].x_end <= segment.x_begin)) return "segments overlap or are out of order";
    if (!(segment.material.value() < limits.materials)) return "a material id is out of range";
    if (!(segment.solid.value() < limits.solids)) return "a solid id is out of range";
  }
  return std::nullopt;
}

std::optional<std::string> find_rows_fault(const SegmentRows& rows, const LayerLimits& limits) {
  if (rows.row_start.empty() || rows.row_start.front() != 0) return "row_start does not begin with 0";
  for (std::size_t r = 0; r < rows.rows(); ++r) {
    if (rows.row_start[r] > rows.row_start[r + 1]) return "row_start is not monotone";
  }
  if (rows.row_start.back() != rows.segments.size()) return "row_start does not end at the number of segments";
  for (std::size_t r = 0; r < rows.rows(); ++r) {
    if (auto fault = find_row_fault(rows.row(r), limits)) return *fault + " in row " + std::to_string(r);
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> find_layer_fault(const Layer& layer, const LayerLimits& limits) {
  if (!(layer.z_bottom < layer.z_sample) || !(layer.z_sample < layer.z_top)) return "its heights do not ascend";
  if (!std::isfinite(layer.z_bottom) || !std::isfinite(layer.z_top)) return "its heights are not finite";
  if (layer.raster.rows() != limits.rows) {
    return "it has " + std::to_string(layer.raster.rows()) + " rows instead of " + std::to_string(limits.rows);
  }
  if (auto fault = find_rows_fault(layer.raster, limits)) return fault;
  if (!layer.hatch) return std::nullopt;
  if (!std::isfinite(layer.hatch->angle) || !(layer.hatch->spacing > 0.0)) return "its hatch lattice is not finite";
  if (auto fault = find_rows_fault(layer.hatch->rows, limits)) return std::string("hatch: ").append(*fault);
  return std::nullopt;
}

}  // namespace lamella
