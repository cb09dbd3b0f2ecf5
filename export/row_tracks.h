#pragma once

#include "slicing/layer.h"
#include "slicing/layer_plan.h"

namespace lamella {

/// The lines that a layer's rows run along: point = x along + (anchor + (row + 1/2) spacing) across, mm.
struct RowFrame {
  Vec2 along = Vec2::UnitX();
  Vec2 across = Vec2::UnitY();
  double anchor = 0.0;
  double spacing = 0.0;
  std::int64_t first_row = 0;

  [[nodiscard]] Vec2 at(std::size_t row, double x) const {
    const double number = static_cast<double>(first_row + static_cast<std::int64_t>(row)) + 0.5;
    return x * along + (anchor + number * spacing) * across;
  }
};

/// The hatch rows of a layer where the build has a hatch, else the raster rows.
[[nodiscard]] inline const SegmentRows& tracked_rows(const Layer& layer) {
  return layer.hatch ? layer.hatch->rows : layer.raster;
}

/// Where tracked_rows() lie.
[[nodiscard]] inline RowFrame tracked_frame(const Layer& layer, const LayerPlan& plan) {
  if (!layer.hatch) return {Vec2::UnitX(), Vec2::UnitY(), plan.grid.origin.y(), plan.grid.pitch.y(), 0};
  const HatchAxes axes = hatch_axes(*plan.hatch, layer.index);
  return {axes.along, axes.across, 0.0, layer.hatch->spacing, layer.hatch->first_row};
}

/// Calls visit(material, from, to) with the ends, mm, of every run of one material on the tracked rows, in their order;
/// touching segments of one material are one run.
template <class Visit>
void visit_tracks(const Layer& layer, const LayerPlan& plan, const Visit& visit) {
  const RowFrame frame = tracked_frame(layer, plan);
  const SegmentRows& rows = tracked_rows(layer);
  for (std::size_t r = 0; r < rows.rows(); ++r) {
    const std::span<const Segment> row = rows.row(r);
    for (std::size_t i = 0; i < row.size();) {
      std::size_t last = i;
      while (last + 1 < row.size() && row[last + 1].material == row[i].material &&
             row[last + 1].x_begin == row[last].x_end) {
        ++last;
      }
      visit(row[i].material, frame.at(r, row[i].x_begin), frame.at(r, row[last].x_end));
      i = last + 1;
    }
  }
}

}  // namespace lamella
