#pragma once

#include <cstdint>
#include <span>
#include <vector>

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

/// Pixels [begin, end) of a row with the label 1 + material; 0 is void.
struct LabelRun {
  std::int32_t begin = 0;
  std::int32_t end = 0;
  std::uint32_t label = 0;
};

/// Turns segments into pixels of a grid's rows.
class RowRaster {
 public:
  explicit RowRaster(const Grid& grid);

  /// The pixels whose centres lie in [x_begin, x_end), clipped to [0, grid.size[0]) (command.md): pixel i has the
  /// material of the segment that holds its centre, origin.x + (i + 1/2) pitch.x. Exactly half-open, so that runs of
  /// disjoint segments are disjoint and those of touching segments touch. Empty when a bound is NaN.
  [[nodiscard]] PixelRun pixels(const Segment& segment) const;

  /// The pixels that the segment covers in part or wholly, to rounding, clipped to the grid.
  [[nodiscard]] PixelRun touched(const Segment& segment) const;

  /// Appends the runs of a row's segments, ascending; touching ones of one label are united, empty ones left out.
  void append_runs(std::span<const Segment> row, std::vector<LabelRun>& out) const;

 private:
  [[nodiscard]] std::int64_t first_centre_from(double x) const;

  double origin_;
  double pitch_;
  double pixels_per_mm_;
  std::int64_t count_;
};

/// The same for one segment.
[[nodiscard]] PixelRun pixels_of(const Segment& segment, const Grid& grid);

}  // namespace lamella
