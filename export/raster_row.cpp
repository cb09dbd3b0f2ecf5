#include "export/raster_row.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella {

RowRaster::RowRaster(const Grid& grid)
    : origin_(grid.origin.x()), pitch_(grid.pitch.x()), pixels_per_mm_(1.0 / grid.pitch.x()), count_(grid.size[0]) {}

PixelRun RowRaster::pixels(const Segment& segment) const {
  if (!(segment.x_begin < segment.x_end)) return {};  // also NaN
  return {first_centre_from(segment.x_begin), first_centre_from(segment.x_end)};
}

PixelRun RowRaster::touched(const Segment& segment) const {
  if (!(segment.x_begin < segment.x_end)) return {};
  const auto limited = [&](double pixel) {
    return static_cast<std::int64_t>(std::clamp(pixel, 0.0, static_cast<double>(count_)));
  };
  return {limited(std::floor((segment.x_begin - origin_) * pixels_per_mm_)),
          limited(std::ceil((segment.x_end - origin_) * pixels_per_mm_))};
}

void RowRaster::append_runs(std::span<const Segment> row, std::vector<LabelRun>& out) const {
  const std::size_t first = out.size();
  double known = std::numeric_limits<double>::quiet_NaN();  // where the last segment ended, often where the next begins
  std::int64_t pixel = 0;
  for (const Segment& segment : row) {
    if (!(segment.x_begin < segment.x_end)) continue;
    const std::int64_t begin = segment.x_begin == known ? pixel : first_centre_from(segment.x_begin);
    known = segment.x_end;
    pixel = first_centre_from(known);
    if (begin >= pixel) continue;
    const std::uint32_t label = 1 + segment.material.value();
    const auto end = static_cast<std::int32_t>(pixel);
    if (out.size() > first && out.back().end == begin && out.back().label == label) {
      out.back().end = end;
    } else {
      out.push_back({static_cast<std::int32_t>(begin), end, label});
    }
  }
}

/// The first pixel in [0, count_] whose centre is not below `x`.
///
/// The rounded centre grows with i (every operation of it does), so that one comparison on each side proves the answer.
/// The product only guesses; far from the origin it may be off by many pixels, and then the search decides.
std::int64_t RowRaster::first_centre_from(double x) const {
  const auto below = [&](std::int64_t i) { return pixel_centre(origin_, pitch_, i) < x; };
  const double quotient = (x - origin_) * pixels_per_mm_ - 0.5;
  // Written so that NaN takes the first pixel as its guess.
  const double limited = quotient > 0.0 ? std::min(quotient, static_cast<double>(count_ - 1)) : -1.0;
  const std::int64_t guess = static_cast<std::int64_t>(limited) + 1;
  for (std::int64_t i = guess; i >= std::max<std::int64_t>(guess - 1, 0); --i) {
    if ((i == 0 || below(i - 1)) && (i == count_ || !below(i))) return i;
  }
  std::int64_t low = 0;
  std::int64_t high = count_;
  while (low < high) {
    const std::int64_t middle = low + (high - low) / 2;
    if (below(middle)) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

PixelRun pixels_of(const Segment& segment, const Grid& grid) { return RowRaster(grid).pixels(segment); }

}  // namespace lamella
