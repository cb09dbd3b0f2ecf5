#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "export/raster_row.h"

namespace lamella {

/// Side of a leaf node of an OpenVDB tree, in voxels.
inline constexpr std::int64_t kLeafSide = 8;

/// Labels of the 512 voxels of a leaf in OpenVDB's order, x * 64 + y * 8 + z; 0 is void.
using LeafLabels = std::array<std::uint32_t, 512>;

/// Up to eight slices that share leaf nodes, as runs. Turns them into leaves of one label and leaves of several; only
/// the latter are ever looked at voxel by voxel.
class Slab {
 public:
  explicit Slab(const Grid& grid);

  /// Slices k with k / 8 = index() belong to the slab.
  [[nodiscard]] std::int64_t index() const { return index_; }
  [[nodiscard]] bool empty() const { return runs_.empty(); }
  /// Empties the slab for the slices of another index.
  void reset(std::int64_t index);
  /// Adds a layer as a slice that belongs to the slab and hasn't been added yet.
  void add(const Layer& layer, std::int64_t slice);

  /// Receives each leaf that isn't void, at leaf coordinates (i, j) in the layers' plane, in a fixed order.
  struct Visitor {
    std::function<void(std::int64_t i, std::int64_t j, std::uint32_t label)> uniform;
    std::function<void(std::int64_t i, std::int64_t j, const LeafLabels& labels)> mixed;
  };
  void visit(const Visitor& visitor);

 private:
  /// Row of voxels: y within the leaf, z within the leaf.
  [[nodiscard]] std::span<const LabelRun> row(std::int64_t y, std::int64_t z) const;
  void classify(std::int64_t band, std::int64_t first, std::int64_t last);
  void fill_mixed(std::int64_t band);

  Grid grid_;
  RowRaster raster_;
  std::int64_t index_ = 0;
  std::vector<LabelRun> runs_;
  std::array<std::vector<std::uint64_t>, kLeafSide> row_start_;  ///< by z; empty where there is no layer

  std::vector<std::uint32_t> states_;  ///< per leaf of a band: its label, or one of two marks
  std::vector<std::int64_t> mixed_;    ///< leaves of a band with several labels, ascending
  std::vector<LeafLabels> labels_;     ///< theirs
};

}  // namespace lamella
