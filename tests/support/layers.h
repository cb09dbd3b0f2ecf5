#pragma once

#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "slicing/layer_sink.h"

/// Hand-made builds and layers for tests of what comes after slicing.
namespace lamella::test {

/// A build of uniform layers with one solid per material name.
inline BuildInfo make_build(const Grid& grid, const std::vector<std::string>& names) {
  BuildInfo info;
  info.sources = {{"parts/grip & pin.step", "AP214", "mm", 1.0, std::string(64, 'a')}};
  info.plan.grid = grid;
  for (const std::string& name : names) {
    const double shade = static_cast<double>(info.materials.size() + 1) / static_cast<double>(names.size() + 1);
    const MaterialId id = info.materials.push_back({name, 1.0 + shade, {shade, 1.0 - shade, 0.25}});
    BuildSolid solid{name + " body", "/assembly/" + name, id, static_cast<int>(id.value()), 12.5 * shade, {}};
    solid.bounds.extend(grid.origin);
    info.solids.push_back(solid);
  }
  for (std::int64_t k = 0; k < grid.size[2]; ++k) {
    const double bottom = grid.origin.z() + static_cast<double>(k) * grid.pitch.z();
    const double top = grid.origin.z() + static_cast<double>(k + 1) * grid.pitch.z();
    info.plan.layers.push_back({bottom, 0.5 * (bottom + top), top});
  }
  return info;
}

/// An empty layer k of a build.
inline Layer make_layer(const BuildInfo& info, std::int64_t k) {
  const LayerSpan& span = info.plan.layers[static_cast<std::size_t>(k)];
  Layer layer;
  layer.index = static_cast<std::uint32_t>(k);
  layer.z_bottom = span.z_bottom;
  layer.z_sample = span.z_sample;
  layer.z_top = span.z_top;
  return layer;
}

inline void end_row(SegmentRows& rows) { rows.row_start.push_back(rows.segments.size()); }

/// Layer k with the label of each voxel given by `label`: a material number, or -1 for void. Segments end on the
/// borders of voxels.
inline Layer layer_of_labels(const BuildInfo& info, std::int64_t k,
                             const std::function<int(std::int64_t, std::int64_t, std::int64_t)>& label) {
  const Grid& grid = info.plan.grid;
  const auto border = [&](std::int64_t i) { return grid.origin.x() + static_cast<double>(i) * grid.pitch.x(); };
  Layer layer = make_layer(info, k);
  for (std::int64_t j = 0; j < grid.size[1]; ++j) {
    for (std::int64_t i = 0; i < grid.size[0];) {
      std::int64_t end = i + 1;
      while (end < grid.size[0] && label(end, j, k) == label(i, j, k)) ++end;
      if (const int m = label(i, j, k); m >= 0) {
        const auto id = static_cast<std::size_t>(m);
        layer.raster.segments.push_back({border(i), border(end), MaterialId{id}, SolidId{id}});
      }
      i = end;
    }
    end_row(layer.raster);
  }
  return layer;
}

/// Disjoint ascending segments with arbitrary ends, some shorter than a pixel, some beyond the grid.
inline void append_random_row(SegmentRows& rows, const BuildInfo& info, std::mt19937& random) {
  const Grid& grid = info.plan.grid;
  const double width = grid.pitch.x() * static_cast<double>(grid.size[0]);
  std::uniform_real_distribution<double> step(0.0, width / 6.0);
  std::uniform_int_distribution<int> material(-1, static_cast<int>(info.materials.size()) - 1);
  for (double x = grid.origin.x() - step(random); x < grid.origin.x() + width;) {
    const double end = x + step(random);
    if (const int m = material(random); m >= 0 && end > x) {
      const auto id = static_cast<std::size_t>(m);
      rows.segments.push_back({x, end, MaterialId{id}, SolidId{id}});
    }
    x = end;
  }
  end_row(rows);
}

/// Layer k with random rows and, when asked, hatch rows.
inline Layer random_layer(const BuildInfo& info, std::int64_t k, std::mt19937& random, bool hatch = false) {
  Layer layer = make_layer(info, k);
  for (std::int64_t j = 0; j < info.plan.grid.size[1]; ++j) append_random_row(layer.raster, info, random);
  if (hatch) {
    layer.hatch.emplace();
    layer.hatch->angle = 0.1 + static_cast<double>(k);
    layer.hatch->spacing = 0.3;
    layer.hatch->first_row = -7 - k;
    for (int row = 0; row < 5; ++row) append_random_row(layer.hatch->rows, info, random);
  }
  return layer;
}

/// An L with a separate marker: asymmetric in x, y and z, so that every mirror image and rotation differs. Material 0
/// is the L (its foot along +x at y = 0), material 1 the marker at the end of the foot, only in the upper half.
inline int l_shape_label(const Grid& grid, std::int64_t i, std::int64_t j, std::int64_t k) {
  const bool upright = i < grid.size[0] / 4;
  const bool foot = j < grid.size[1] / 4;
  if (foot && i >= grid.size[0] - 2) return k >= grid.size[2] / 2 ? 1 : -1;
  return upright || foot ? 0 : -1;
}

/// The label that command.md asks of voxel (i, j) of a layer: linear search for the segment that holds its centre.
inline int label_of(const Layer& layer, const Grid& grid, std::int64_t i, std::int64_t j) {
  const double centre = grid.origin.x() + (static_cast<double>(i) + 0.5) * grid.pitch.x();
  for (const Segment& segment : layer.raster.row(static_cast<std::size_t>(j))) {
    if (segment.x_begin <= centre && centre < segment.x_end) return static_cast<int>(segment.material.value());
  }
  return -1;
}

/// Number of voxels of each material over all layers.
inline std::vector<std::int64_t> count_labels(const std::vector<Layer>& layers, const BuildInfo& info) {
  std::vector<std::int64_t> counts(info.materials.size());
  for (const Layer& layer : layers) {
    for (std::int64_t j = 0; j < info.plan.grid.size[1]; ++j) {
      for (std::int64_t i = 0; i < info.plan.grid.size[0]; ++i) {
        if (const int label = label_of(layer, info.plan.grid, i, j); label >= 0)
          ++counts[static_cast<std::size_t>(label)];
      }
    }
  }
  return counts;
}

/// Keeps what it is given.
class CollectingSink final : public LayerSink {
 public:
  void begin(const BuildInfo& info_given) override { info = info_given; }
  void write(const Layer& layer) override { layers.push_back(layer); }
  void finish(const SliceReport& report_given) override {
    report = report_given;
    finished = true;
  }

  BuildInfo info;
  std::vector<Layer> layers;
  SliceReport report;
  bool finished = false;
};

/// begin, write each, finish.
inline void feed(LayerSink& sink, const BuildInfo& info, const std::vector<Layer>& layers,
                 const SliceReport& report = {}) {
  sink.begin(info);
  for (const Layer& layer : layers) sink.write(layer);
  sink.finish(report);
}

}  // namespace lamella::test
