#include "slicing/plan/overhang.h"

#include <algorithm>
#include <cmath>

#include "core/tolerances.h"

namespace lamella {

namespace {

/// Whether one run of the row below, grown along the row, already carries the segment.
bool is_carried(const Segment& segment, std::span<const Interval> below, double reach) {
  const auto after = std::upper_bound(below.begin(), below.end(), segment.x_begin + reach,
                                      [](double x, const Interval& run) { return x < run.lo; });
  return after != below.begin() && std::prev(after)->hi + reach >= segment.x_end;
}

/// The grown cover on row j, merged.
void grow(const Cover& below, std::size_t j, double reach, double pitch, std::vector<Interval>& out) {
  const auto rows = static_cast<std::size_t>(std::min(reach / pitch + tolerance::kGridSlack, 1e7));
  const std::size_t first = j > rows ? j - rows : 0;
  const std::size_t last = std::min(j + rows + 1, below.rows());
  out.clear();
  for (std::size_t r = first; r < last; ++r) {
    const double across = static_cast<double>(r > j ? r - j : j - r) * pitch;
    const double along = std::sqrt(std::max(reach * reach - across * across, 0.0));
    for (const Interval& run : below.row(r)) out.push_back({run.lo - along, run.hi + along});
  }
  std::sort(out.begin(), out.end(), [](const Interval& a, const Interval& b) { return a.lo < b.lo; });
  std::size_t kept = 0;
  for (const Interval& run : out) {
    if (kept > 0 && run.lo <= out[kept - 1].hi) {
      out[kept - 1].hi = std::max(out[kept - 1].hi, run.hi);
    } else {
      out[kept++] = run;
    }
  }
  out.resize(kept);
}

double uncovered(const Segment& segment, const std::vector<Interval>& cover) {
  double length = segment.x_end - segment.x_begin;
  for (const Interval& run : cover) {
    length -= std::max(0.0, std::min(run.hi, segment.x_end) - std::max(run.lo, segment.x_begin));
  }
  return std::max(length, 0.0);
}

}  // namespace

void add_overhang(const SegmentRows& raster, const Cover& below, double reach, double pitch,
                  std::vector<double>& length) {
  std::vector<Interval> grown;
  for (std::size_t j = 0; j < raster.rows(); ++j) {
    bool is_grown = false;
    for (const Segment& segment : raster.row(j)) {
      if (is_carried(segment, below.row(j), reach)) continue;
      if (!is_grown) grow(below, j, reach, pitch, grown);
      is_grown = true;
      length[segment.material.value()] += uncovered(segment, grown);
    }
  }
}

}  // namespace lamella
