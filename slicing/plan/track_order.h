#pragma once

#include <cmath>
#include <span>

#include "slicing/layer.h"

namespace lamella {

/// Visits the tracks of one material on rows in the order in which a machine lays them: rows in their order, every
/// second one that holds the material backwards when `serpentine`. visit(row, from, to) gets positions in mm along the
/// row; touching segments are one track.
template <class Visit>
void visit_tracks(const SegmentRows& rows, MaterialId material, bool serpentine, const Visit& visit) {
  std::vector<std::pair<double, double>> tracks;
  bool backwards = false;
  for (std::size_t r = 0; r < rows.rows(); ++r) {
    tracks.clear();
    for (const Segment& segment : rows.row(r)) {
      if (segment.material != material) continue;
      if (!tracks.empty() && tracks.back().second == segment.x_begin) {
        tracks.back().second = segment.x_end;
      } else {
        tracks.emplace_back(segment.x_begin, segment.x_end);
      }
    }
    if (tracks.empty()) continue;
    if (backwards) {
      for (std::size_t i = tracks.size(); i-- > 0;) visit(r, tracks[i].second, tracks[i].first);
    } else {
      for (const auto& [from, to] : tracks) visit(r, from, to);
    }
    backwards = serpentine && !backwards;
  }
}

}  // namespace lamella
