#pragma once

#include <cstdint>

#include "slicing/layer.h"
#include "slicing/layer_plan.h"

namespace lamella {

/// Pixels [begin, end) of one row; empty when begin == end.
struct PixelRun {
  std::int64_t begin = 0;
  std::int64_t end = 0;

  bool operator==(const PixelRun&) const = default;
};

/// Centre of pixel i in mm: the double that origin + (i + 1/2) pitch rounds to, by which all rasters decide.
[[nodiscard]] inline double pixel_centre(double origin, double pitch, std::int64_t i) {
  return origin + (static_cast<double>(i) + 0.5) * pitch;
}

/// The pixels whose centres lie in [x_begin, x_end), clipped to [0, grid.size[0]) (command.md): pixel i has the
/// material of the segment that holds its centre, origin.x + (i + 1/2) pitch.x. Exactly half-open, so that runs of
/// disjoint segments are disjoint and those of touching segments touch. Empty when a bound is NaN.
[[nodiscard]] PixelRun pixels_of(const Segment& segment, const Grid& grid);

}  // namespace lamella
