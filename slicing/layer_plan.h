#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/geometry.h"

namespace lamella {

/// The raster lattice of command.md: voxel centres are origin + (i+1/2, j+1/2, k+1/2) * pitch.
struct Grid {
  Vec3 origin = Vec3::Zero();          ///< lower corner of voxel (0,0,0), mm
  Vec3 pitch = Vec3::Ones();           ///< mm; pitch.z is the nominal layer height
  std::array<std::int64_t, 3> size{};  ///< voxels along x, y, z; size[1] rows a layer, size[2] layers
};

/// Parallel lines at an angle: row m of layer k is -x sin t + y cos t = (m + 1/2) spacing with t = angle + k *
/// rotation, m any integer, anchored at the machine origin.
struct HatchLattice {
  double spacing = 0.0;   ///< mm
  double angle = 0.0;     ///< radians
  double rotation = 0.0;  ///< radians per layer
};

struct LayerSpan {
  double z_bottom = 0.0;
  double z_sample = 0.0;  ///< the middle
  double z_top = 0.0;
};

/// Where to cut.
struct LayerPlan {
  Grid grid;
  std::vector<LayerSpan> layers;  ///< ascending, contiguous
  std::optional<HatchLattice> hatch;
  std::optional<double> chord_error;  ///< of contours, if layers have them: mm between polygon and exact section
  bool curves = false;                ///< contours keep the curves that they are chords of
  std::int64_t sub_rows = 0;          ///< lines across a raster row that layers get besides; 0: none

  [[nodiscard]] double row_y(std::int64_t row) const { return grid.origin.y() + (row + 0.5) * grid.pitch.y(); }
};

struct PlanOptions {
  std::optional<double> layer_height;  ///< mm; default: about 500 layers on the larger extent, rounded to 1-2-5
  std::optional<Vec2> pitch;           ///< mm (x, y); default: about 1000 rows, rounded to 1-2-5
  std::optional<Vec3> origin;          ///< default: the lower bounds
  std::optional<HatchLattice> hatch;
  std::optional<double> chord_error;  ///< mm; layers get contours
  bool curves = false;                ///< contours keep their curves; needs a chord error
  std::int64_t sub_rows = 0;          ///< lines across a raster row besides its own, at most 64
};

/// Lays the lattices over exact bounds. Throws UsageError when a pitch isn't positive and finite, when the origin lies
/// above a lower bound, when the lattice would have more than 2^31 - 1 voxels along x or 10^7 rows or layers, when it
/// reaches beyond 10^9 mm, or when its pitch is lost in rounding there; InputError when the bounds are empty or not
/// finite.
[[nodiscard]] LayerPlan plan_layers(const Box3& bounds, const PlanOptions& options = {});

/// Direction of the hatch rows of layer k and their left normal; multiples of 90 degrees are exact.
struct HatchAxes {
  Vec2 along;
  Vec2 across;
};
[[nodiscard]] HatchAxes hatch_axes(const HatchLattice& hatch, std::size_t layer);

}  // namespace lamella
