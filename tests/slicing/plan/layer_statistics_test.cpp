#include "slicing/plan/layer_statistics.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "slicing/plan/track_order.h"
#include "tests/support/layers.h"

namespace lamella {
namespace {

using test::layer_of_labels;
using test::make_build;

Grid small_grid() {
  Grid grid;
  grid.origin = Vec3(-1.0, 2.0, 0.0);
  grid.pitch = Vec3(0.5, 0.25, 0.2);
  grid.size = {24, 20, 2};
  return grid;
}

/// Labels of a layer as a picture, from which everything is counted anew.
using Picture = std::vector<std::vector<int>>;

Picture random_picture(std::mt19937& random, const Grid& grid, int materials) {
  Picture picture(static_cast<std::size_t>(grid.size[1]), std::vector<int>(static_cast<std::size_t>(grid.size[0]), -1));
  for (auto& row : picture) {
    for (std::size_t i = 0; i < row.size();) {
      const int label = static_cast<int>(random() % static_cast<unsigned>(materials + 1)) - 1;
      for (std::size_t n = 1 + random() % 6; n > 0 && i < row.size(); --n) row[i++] = label;
    }
  }
  return picture;
}

Layer layer_of(const BuildInfo& info, const Picture& picture, std::int64_t k) {
  return layer_of_labels(info, k, [&](std::int64_t i, std::int64_t j, std::int64_t) {
    return picture[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)];
  });
}

/// Takes the island at (j, i) out of the picture and counts its cells (4-neighbours).
int flood(Picture& picture, int label, std::size_t j, std::size_t i) {
  if (j >= picture.size() || i >= picture[0].size() || picture[j][i] != label) return 0;
  picture[j][i] = -2;
  return 1 + flood(picture, label, j + 1, i) + flood(picture, label, j - 1, i) + flood(picture, label, j, i + 1) +
         flood(picture, label, j, i - 1);
}

TEST(LayerStatistics, CountIslandsAndAreasAsAFloodFillDoes) {
  std::mt19937 random(1);
  const BuildInfo info = make_build(small_grid(), {"a", "b"});
  const double cell = 0.5 * 0.25;
  for (int round = 0; round < 200; ++round) {
    const Picture picture = random_picture(random, info.plan.grid, 2);
    const LayerStatistics found =
        measure_layer(layer_of(info, picture, 0), info.plan.grid, 2, {0.4, std::nullopt}, nullptr);
    for (const MaterialStatistics& one : found.materials) {
      Picture left = picture;
      std::uint32_t islands = 0;
      int cells = 0;
      int smallest = 1 << 30;
      for (std::size_t j = 0; j < left.size(); ++j) {
        for (std::size_t i = 0; i < left[0].size(); ++i) {
          const int size = flood(left, static_cast<int>(one.material.value()), j, i);
          if (size == 0) continue;
          ++islands;
          cells += size;
          smallest = std::min(smallest, size);
        }
      }
      ASSERT_EQ(one.islands, islands);
      ASSERT_NEAR(one.area, cells * cell, 1e-12);
      ASSERT_NEAR(one.smallest, smallest * cell, 1e-12);
      ASSERT_EQ(one.unsupported, 0.0);
    }
  }
}

/// Area of the layer's material further than `reach` from all material below, by many points.
double sampled_overhang(const Layer& layer, const Cover& below, const Grid& grid, double reach, MaterialId material) {
  constexpr int kPoints = 40;  // a cell's width
  double area = 0.0;
  for (std::size_t j = 0; j < layer.raster.rows(); ++j) {
    for (const Segment& segment : layer.raster.row(j)) {
      if (segment.material != material) continue;
      const int points = static_cast<int>(std::round((segment.x_end - segment.x_begin) / grid.pitch.x())) * kPoints;
      for (int p = 0; p < points; ++p) {
        const double x = segment.x_begin + (p + 0.5) * (segment.x_end - segment.x_begin) / points;
        bool is_carried = false;
        for (std::size_t r = 0; r < below.rows() && !is_carried; ++r) {
          const double dy = (static_cast<double>(r) - static_cast<double>(j)) * grid.pitch.y();
          for (const Interval& run : below.row(r)) {
            const double dx = std::max({run.lo - x, x - run.hi, 0.0});
            is_carried = is_carried || dx * dx + dy * dy <= reach * reach;
          }
        }
        if (!is_carried) area += (segment.x_end - segment.x_begin) / points * grid.pitch.y();
      }
    }
  }
  return area;
}

TEST(LayerStatistics, MeasureWhatLiesOverNothing) {
  std::mt19937 random(2);
  const BuildInfo info = make_build(small_grid(), {"a", "b"});
  double total = 0.0;
  for (int round = 0; round < 20; ++round) {
    Picture lower = random_picture(random, info.plan.grid, 2);
    for (auto& row : lower) {
      for (int& label : row) label = random() % 8 == 0 ? label : -1;
    }
    const Cover below = cover_of(layer_of(info, lower, 0).raster);
    const Layer layer = layer_of(info, random_picture(random, info.plan.grid, 2), 1);
    for (const double reach : {0.0, 0.2, 0.6, 1.1}) {
      const StatisticsOptions options{.width = 0.4, .self_support = reach};
      const LayerStatistics found = measure_layer(layer, info.plan.grid, 2, options, &below);
      for (const MaterialStatistics& one : found.materials) {
        const double expected = sampled_overhang(layer, below, info.plan.grid, reach, one.material);
        ASSERT_NEAR(one.unsupported, expected, 0.02 * one.area) << reach;
        total += one.unsupported;
      }
    }
  }
  EXPECT_GT(total, 10.0);
}

TEST(LayerStatistics, ABoxOverASmallerOneHangsOverByTheRim) {
  Grid grid;
  grid.pitch = Vec3(0.1, 0.1, 0.1);
  grid.size = {100, 100, 2};
  const BuildInfo info = make_build(grid, {"a"});
  const auto square = [&](std::int64_t margin, std::int64_t k) {
    return layer_of_labels(info, k, [&](std::int64_t i, std::int64_t j, std::int64_t) {
      return std::min({i, j, 99 - i, 99 - j}) >= margin ? 0 : -1;
    });
  };
  const Cover below = cover_of(square(20, 0).raster);  // 6 x 6 mm below 10 x 10 mm
  const auto overhang = [&](double reach) {
    return measure_layer(square(0, 1), grid, 1, {.width = 0.4, .self_support = reach}, &below).materials[0].unsupported;
  };
  EXPECT_NEAR(overhang(0.0), 100.0 - 36.0, 1e-9);
  // Grown by discs: 36 + 4 * 6 r + pi r^2. Each quarter disc is a sum over rows, whose width falls from r to 0: it is
  // right to a row times r.
  EXPECT_NEAR(overhang(1.0), 100.0 - (36.0 + 24.0 + kPi), 4 * 0.1 * 1.0);
}

/// s from rest to rest, in this test's own words.
double ramped(double length, double speed, double acceleration) {
  const double ramp = speed / acceleration;
  const double over_ramps = ramp * speed;
  return over_ramps <= length ? 2.0 * ramp + (length - over_ramps) / speed : std::sqrt(4.0 * length / acceleration);
}

/// Tracks of one material as [from, to] in cells, row by row, every second row that has any the other way round.
std::vector<std::array<int, 3>> tracks_in(const Picture& picture, int label) {
  std::vector<std::array<int, 3>> tracks;
  bool backwards = false;
  for (std::size_t j = 0; j < picture.size(); ++j) {
    std::vector<std::array<int, 3>> row;
    const int width = static_cast<int>(picture[j].size());
    for (int i = 0; i < width; ++i) {
      if (picture[j][static_cast<std::size_t>(i)] != label) continue;
      if (row.empty() || row.back()[2] != i) row.push_back({static_cast<int>(j), i, i});
      row.back()[2] = i + 1;
    }
    if (row.empty()) continue;
    if (backwards) {
      std::reverse(row.begin(), row.end());
      for (auto& track : row) std::swap(track[1], track[2]);
    }
    backwards = !backwards;
    tracks.insert(tracks.end(), row.begin(), row.end());
  }
  return tracks;
}

TEST(LayerStatistics, TimeEveryTrackAndTravelByItself) {
  std::mt19937 random(6);
  const BuildInfo info = make_build(small_grid(), {"a", "b"});
  // 0.5 mm are shorter than what the first pace's tracks need for their speed, and longer than what the second's do.
  const std::vector<Pace> paces{{{40.0, 1000.0}, {200.0, 5000.0}}, {{20.0, 4000.0}, {100.0}}};
  StatisticsOptions options{.width = 0.4, .self_support = std::nullopt};
  options.paces = {paces, {}};
  for (int round = 0; round < 50; ++round) {
    const Picture picture = random_picture(random, info.plan.grid, 2);
    const LayerStatistics found = measure_layer(layer_of(info, picture, 0), info.plan.grid, 2, options, nullptr);
    ASSERT_EQ(found.materials.size(), 2U);
    EXPECT_TRUE(found.materials[1].times.empty());
    const auto tracks = tracks_in(picture, 0);
    for (std::size_t p = 0; p < paces.size(); ++p) {
      double time = 0.0;
      for (std::size_t t = 0; t < tracks.size(); ++t) {
        const auto& [row, from, to] = tracks[t];
        const double length = 0.5 * std::abs(to - from);
        // Rows are 0.25 mm apart and tracks 0.4 mm wide: eight rows are five tracks.
        time += 0.25 / 0.4 * ramped(length, paces[p].depositing.speed, paces[p].depositing.acceleration);
        if (t == 0) continue;
        const double way = std::hypot(0.5 * (from - tracks[t - 1][2]), 0.25 * (row - tracks[t - 1][0]));
        time += 0.25 / 0.4 *
                (std::isinf(paces[p].traveling.acceleration)
                     ? way / paces[p].traveling.speed
                     : ramped(way, paces[p].traveling.speed, paces[p].traveling.acceleration));
      }
      ASSERT_NEAR(found.materials[0].times.at(p), time, 1e-12 + 1e-9 * time);
    }
  }
}

TEST(LayerStatistics, FindTheShortestRunAndWhatIsThinnerThanATrack) {
  Grid grid;
  grid.pitch = Vec3(0.1, 0.5, 0.1);
  grid.size = {100, 3, 1};
  const BuildInfo info = make_build(grid, {"a"});
  Layer layer = test::make_layer(info, 0);
  const auto add = [&](double begin, double end, std::size_t solid) {
    layer.raster.segments.push_back({begin, end, MaterialId{0}, SolidId{solid}});
  };
  add(0.0, 0.2, 0);
  add(0.2, 0.5, 0);  // touches: one run of 0.5
  test::end_row(layer.raster);
  add(2.0, 2.25, 0);  // a run of 0.25
  test::end_row(layer.raster);
  test::end_row(layer.raster);
  const LayerStatistics found = measure_layer(layer, grid, 1, {0.4, std::nullopt}, nullptr);
  ASSERT_EQ(found.materials.size(), 1U);
  const MaterialStatistics& one = found.materials[0];
  EXPECT_EQ(one.segments, 3U);
  EXPECT_DOUBLE_EQ(one.shortest, 0.25);
  EXPECT_DOUBLE_EQ(one.thin, 0.25 * 0.5);
  EXPECT_EQ(one.islands, 2U);
  EXPECT_EQ(one.specks, 1U);
  EXPECT_DOUBLE_EQ(one.length, 0.75);
  // From (0.5, 0) on the first row to (2.25, 0.5) on the second, which runs backwards.
  EXPECT_DOUBLE_EQ(one.travel, std::hypot(1.75, 0.5));
}

TEST(TrackOrder, TurnsOnEveryRowThatHoldsTheMaterial) {
  SegmentRows rows;
  const auto add = [&](double begin, double end, std::size_t material) {
    rows.segments.push_back({begin, end, MaterialId{material}, SolidId{0}});
  };
  add(0, 1, 0);
  add(2, 3, 0);
  test::end_row(rows);
  add(0, 9, 1);
  test::end_row(rows);
  add(0, 1, 0);
  add(1, 4, 0);
  add(5, 6, 0);
  test::end_row(rows);
  std::vector<std::array<double, 3>> tracks;
  const auto collect = [&](std::size_t row, double from, double to) {
    tracks.push_back({static_cast<double>(row), from, to});
  };
  visit_tracks(rows, MaterialId{0}, true, collect);
  EXPECT_EQ(tracks, (std::vector<std::array<double, 3>>{{0, 0, 1}, {0, 2, 3}, {2, 6, 5}, {2, 4, 0}}));
  tracks.clear();
  visit_tracks(rows, MaterialId{0}, false, collect);
  EXPECT_EQ(tracks, (std::vector<std::array<double, 3>>{{0, 0, 1}, {0, 2, 3}, {2, 0, 4}, {2, 5, 6}}));
}

}  // namespace
}  // namespace lamella
