#include "slicing/plan/layer_statistics.h"

#include <algorithm>
#include <cmath>

#include "slicing/compensated_sum.h"
#include "slicing/mixer.h"
#include "slicing/plan/islands.h"
#include "slicing/plan/overhang.h"
#include "slicing/plan/track_order.h"

namespace lamella {

namespace {

const std::vector<Pace> kNoPaces;

/// Area and box, by the raster rows. Sums run along the rows with compensation, as the slice report's do.
void measure_areas(const Layer& layer, const Grid& grid, LayerStatistics& out, std::vector<MaterialStatistics>& by) {
  std::vector<CompensatedSum> length(by.size());
  for (std::size_t j = 0; j < layer.raster.rows(); ++j) {
    const auto row = layer.raster.row(j);
    if (row.empty()) continue;
    const double y = grid.origin.y() + static_cast<double>(j) * grid.pitch.y();
    out.box.extend(Vec2(row.front().x_begin, y));
    out.box.extend(Vec2(row.back().x_end, y + grid.pitch.y()));
    for (const Segment& segment : row) length[segment.material.value()].add(segment.x_end - segment.x_begin);
  }
  for (std::size_t m = 0; m < by.size(); ++m) by[m].area = length[m].value() * grid.pitch.y();
}

/// Tracks one beside the other. Without hatch rows there are as many as the width asks for, and of the way between the
/// raster rows as much less as there are fewer tracks than rows.
struct TrackShare {
  double of_tracks = 1.0;
  double of_travel = 1.0;
};

/// Adds up what the moves along one material's tracks take, move by move, at every pace.
class TrackTimes {
 public:
  TrackTimes(const std::vector<Pace>& paces, const TrackShare& share, std::vector<double>& times)
      : paces_(paces), share_(share), times_(times) {
    times_.assign(paces.size(), 0.0);
  }
  void add_track(double length) {
    for (std::size_t i = 0; i < paces_.size(); ++i) times_[i] += share_.of_tracks * paces_[i].depositing.time(length);
  }
  void add_travel(double length) {
    for (std::size_t i = 0; i < paces_.size(); ++i) times_[i] += share_.of_travel * paces_[i].traveling.time(length);
  }

 private:
  const std::vector<Pace>& paces_;
  TrackShare share_;
  std::vector<double>& times_;
};

/// Segments, length, travel and times on the rows that the machine follows.
void measure_tracks(const SegmentRows& rows, double spacing, const StatisticsOptions& options, const TrackShare& share,
                    std::vector<MaterialStatistics>& by) {
  std::vector<CompensatedSum> length(by.size());
  for (const Segment& segment : rows.segments) {
    ++by[segment.material.value()].segments;
    length[segment.material.value()].add(segment.x_end - segment.x_begin);
  }
  for (std::size_t m = 0; m < by.size(); ++m) {
    TrackTimes times(m < options.paces.size() ? options.paces[m] : kNoPaces, share, by[m].times);
    if (by[m].segments == 0) continue;
    by[m].length = length[m].value();
    bool is_first = true;
    Vec2 at = Vec2::Zero();
    visit_tracks(rows, MaterialId{m}, options.serpentine, [&](std::size_t row, double from, double to) {
      const double y = static_cast<double>(row) * spacing;
      if (!is_first) {
        const double travel = (Vec2(from, y) - at).norm();
        by[m].travel += travel;
        times.add_travel(travel);
      }
      times.add_track(std::abs(to - from));
      is_first = false;
      at = {to, y};
    });
  }
}

}  // namespace

Cover cover_of(const SegmentRows& raster) {
  Cover cover;
  for (std::size_t j = 0; j < raster.rows(); ++j) {
    const std::size_t first = cover.runs.size();
    for (const Segment& segment : raster.row(j)) {
      if (cover.runs.size() > first && cover.runs.back().hi == segment.x_begin) {
        cover.runs.back().hi = segment.x_end;
      } else {
        cover.runs.push_back({segment.x_begin, segment.x_end});
      }
    }
    cover.row_start.push_back(cover.runs.size());
  }
  return cover;
}

LayerStatistics measure_layer(const Layer& layer, const Grid& grid, std::size_t materials,
                              const StatisticsOptions& options, const Cover* below) {
  LayerStatistics out{layer.index, layer.z_bottom, layer.z_top, {}, {}};
  std::vector<MaterialStatistics> by(materials);
  for (std::size_t m = 0; m < materials; ++m) by[m].material = MaterialId{m};
  measure_areas(layer, grid, out, by);
  const bool hatched = options.use_hatch && layer.hatch;
  const double rows_a_track = grid.pitch.y() / options.width;
  measure_tracks(hatched ? layer.hatch->rows : layer.raster, hatched ? layer.hatch->spacing : grid.pitch.y(), options,
                 hatched ? TrackShare{} : TrackShare{rows_a_track, std::min(1.0, rows_a_track)}, by);
  measure_islands(layer.raster, grid.pitch.y(), options.width, by);
  if (below != nullptr && options.self_support) {
    std::vector<double> overhang(materials);
    add_overhang(layer.raster, *below, *options.self_support, grid.pitch.y(), overhang);
    for (std::size_t m = 0; m < materials; ++m) by[m].unsupported = overhang[m] * grid.pitch.y();
  }
  for (const MaterialStatistics& one : by) {
    if (one.area > 0.0 || one.segments > 0) out.materials.push_back(one);
  }
  return out;
}

void credit_components(const Layer& layer, const Grid& grid, const IdVector<MaterialId, Material>& materials,
                       LayerStatistics& statistics) {
  if (layer.raster.mixtures.empty()) return;
  std::vector<double> lengths(materials.size(), 0.0);
  add_component_lengths(layer.raster, materials, lengths);
  std::erase_if(statistics.materials,
                [&](const MaterialStatistics& one) { return materials[one.material].is_graded(); });
  for (std::size_t m = 0; m < lengths.size(); ++m) {
    if (!(lengths[m] > 0.0)) continue;
    const auto place = std::lower_bound(statistics.materials.begin(), statistics.materials.end(), MaterialId{m},
                                        [](const MaterialStatistics& one, MaterialId id) { return one.material < id; });
    const bool is_known = place != statistics.materials.end() && place->material == MaterialId{m};
    MaterialStatistics& one =
        is_known ? *place : *statistics.materials.insert(place, MaterialStatistics{MaterialId{m}});
    one.area += lengths[m] * grid.pitch.y();
  }
}

}  // namespace lamella
