#include "export/raster_row.h"

#include <algorithm>

namespace lamella {

namespace {

/// The first pixel in [0, count] whose centre is not below `x`.
///
/// The rounded centre grows with i (every operation of it does), so that one comparison on each side proves the answer.
/// The division only guesses; far from the origin it may be off by many pixels, and then the search decides.
std::int64_t first_centre_from(double x, double origin, double pitch, std::int64_t count) {
  const auto below = [&](std::int64_t i) { return pixel_centre(origin, pitch, i) < x; };
  const double quotient = (x - origin) / pitch - 0.5;
  // Written so that NaN takes the first pixel as its guess.
  const double limited = quotient > 0.0 ? std::min(quotient, static_cast<double>(count)) : 0.0;
  for (std::int64_t guess = static_cast<std::int64_t>(limited), last = guess + 1; guess <= std::min(last, count);
       ++guess) {
    if ((guess == 0 || below(guess - 1)) && (guess == count || !below(guess))) return guess;
  }
  std::int64_t low = 0;
  std::int64_t high = count;
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

}  // namespace

PixelRun pixels_of(const Segment& segment, const Grid& grid) {
  if (!(segment.x_begin < segment.x_end)) return {};  // also NaN
  PixelRun run;
  run.begin = first_centre_from(segment.x_begin, grid.origin.x(), grid.pitch.x(), grid.size[0]);
  run.end = first_centre_from(segment.x_end, grid.origin.x(), grid.pitch.x(), grid.size[0]);
  return run;
}

}  // namespace lamella
