#include "export/vdb/slab.h"

#include <gtest/gtest.h>

#include "tests/support/layers.h"

namespace lamella::test {
namespace {

BuildInfo build_of_size(std::int64_t x, std::int64_t y, std::int64_t z) {
  Grid grid;
  grid.size = {x, y, z};
  return make_build(grid, {"a", "b", "c"});
}

/// Labels of the voxels of a slab, collected from its leaves: [z][y][x] over whole leaves, 0 is void.
std::vector<std::uint32_t> labels_of(Slab& slab, std::int64_t nx, std::int64_t ny, int* uniform_leaves = nullptr) {
  std::vector<std::uint32_t> labels(static_cast<std::size_t>(nx * ny * 8));
  const auto set = [&](std::int64_t i, std::int64_t j, std::size_t n, std::uint32_t label) {
    const auto x = i * 8 + static_cast<std::int64_t>(n / 64);
    const auto y = j * 8 + static_cast<std::int64_t>(n / 8 % 8);
    const auto z = static_cast<std::int64_t>(n % 8);
    if (label == 0) return;
    ASSERT_LT(x, nx);
    ASSERT_LT(y, ny);
    labels[static_cast<std::size_t>((z * ny + y) * nx + x)] = label;
  };
  slab.visit({[&](auto i, auto j, std::uint32_t label) {
                for (std::size_t n = 0; n < 512; ++n) set(i, j, n, label);
                if (uniform_leaves != nullptr) ++*uniform_leaves;
              },
              [&](auto i, auto j, const LeafLabels& leaf) {
                for (std::size_t n = 0; n < 512; ++n) set(i, j, n, leaf[n]);
              }});
  return labels;
}

TEST(Slab, GivesEveryVoxelTheLabelOfTheSegmentAtItsCentre) {
  std::mt19937 random(17);
  for (int trial = 0; trial < 60; ++trial) {
    const std::int64_t nx = 1 + trial * 3;
    const std::int64_t ny = 1 + trial % 20;
    const BuildInfo info = build_of_size(nx, ny, 16);
    Slab slab(info.plan.grid);
    slab.reset(1);
    std::vector<std::uint32_t> expected(static_cast<std::size_t>(nx * ny * 8));
    for (std::int64_t k = 8; k < 16; ++k) {
      if (trial % 3 == 0 && k % 3 == 0) continue;  // a layer may be left out
      const Layer layer = random_layer(info, k, random);
      slab.add(layer, layer.index);
      for (std::int64_t j = 0; j < ny; ++j) {
        for (std::int64_t i = 0; i < nx; ++i) {
          expected[static_cast<std::size_t>(((k - 8) * ny + j) * nx + i)] =
              static_cast<std::uint32_t>(1 + label_of(layer, info.plan.grid, i, j));
        }
      }
    }
    ASSERT_EQ(labels_of(slab, nx, ny), expected) << trial;
  }
}

TEST(Slab, KeepsTheInsideOfASolidAsWholeLeaves) {
  const BuildInfo info = build_of_size(80, 40, 8);
  Slab slab(info.plan.grid);
  slab.reset(0);
  for (std::int64_t k = 0; k < 8; ++k) slab.add(layer_of_labels(info, k, [](auto, auto, auto) { return 1; }), k);
  int uniform = 0;
  labels_of(slab, 80, 40, &uniform);
  EXPECT_EQ(uniform, 10 * 5);
}

TEST(Slab, UnitesTouchingSegmentsOfOneMaterial) {
  const BuildInfo info = build_of_size(16, 8, 8);
  Slab slab(info.plan.grid);
  slab.reset(0);
  for (std::int64_t k = 0; k < 8; ++k) {
    Layer layer = make_layer(info, k);
    for (int j = 0; j < 8; ++j) {
      for (double x : {0.0, 3.3, 9.1})
        layer.raster.segments.push_back({x, x == 0.0 ? 3.3 : x + 6.9, MaterialId{2}, SolidId{2}});
      layer.raster.segments[layer.raster.segments.size() - 2].x_end = 9.1;
      end_row(layer.raster);
    }
    slab.add(layer, layer.index);
  }
  int uniform = 0;
  labels_of(slab, 16, 8, &uniform);
  EXPECT_EQ(uniform, 2);
}

TEST(Slab, IsEmptyAfterReset) {
  const BuildInfo info = build_of_size(9, 9, 8);
  Slab slab(info.plan.grid);
  slab.add(layer_of_labels(info, 0, [](auto, auto, auto) { return 0; }), 0);
  slab.reset(1);
  EXPECT_TRUE(slab.empty());
  slab.visit({[](auto, auto, auto) { FAIL(); }, [](auto, auto, const auto&) { FAIL(); }});
}

}  // namespace
}  // namespace lamella::test
