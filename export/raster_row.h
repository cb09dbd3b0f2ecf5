#pragma once

#include <cstdint>
#include <functional>

#include "slicing/layer.h"
#include "slicing/layer_plan.h"

namespace lamella {

/// First and one-past-last pixel whose centres lie in [x_begin, x_end); clipped to [0, grid.size[0]).
struct PixelRun {
  std::int64_t begin = 0;
  std::int64_t end = 0;
};

/// Pixel i has the material of the segment that holds its centre, origin.x + (i + 1/2) pitch.x (command.md).
[[nodiscard]] PixelRun pixels_of(const Segment& segment, const Grid& grid);

}  // namespace lamella
