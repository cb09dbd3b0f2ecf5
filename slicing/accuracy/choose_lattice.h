#pragma once

#include <optional>
#include <span>

#include "materials/machine.h"
#include "model/measure.h"
#include "model/scene.h"
#include "slicing/layer_plan.h"

namespace lamella::accuracy {

/// Pitch and layer height for a wanted accuracy T, and what they guarantee (docs/methods/accuracy.md):
/// no point of the boundary of a solid's voxels lies further than `surface_bound` <= T from the solid's exact surface,
/// and rows give each solid's volume within `offset_bound` <= T times its exact surface area.
struct LatticeChoice {
  double wanted = 0.0;          ///< mm, T
  Vec3 pitch = Vec3::Zero();    ///< mm; pitch.z() is the layer height
  double surface_bound = 0.0;   ///< mm, half the diagonal of a voxel
  double offset_bound = 0.0;    ///< mm, largest of (p_y A_y + p_z A_z) / A over the solids
  double file_tolerance = 0.0;  ///< mm, what the STEP file itself leaves open at edges and vertices of these solids
};

/// The coarsest such lattice. Without a machine all three pitches are equal, rounded down to two digits; with one the
/// raster pitch is the machine's, and the layer height is the largest that it builds. Throws UsageError when T isn't
/// positive or the machine can't reach it, with what it reaches in the hint.
[[nodiscard]] LatticeChoice choose_lattice(const Scene& scene, const IdVector<SolidId, SolidMeasure>& measures,
                                           std::span<const SolidId> solids, double accuracy, const Machine* machine);

/// What an accuracy T leaves for adaptive layers: their extruded sections stay within `deviation` of the exact surface,
/// and half the diagonal of a pixel is the rest of T.
struct AdaptiveShare {
  Vec2 pitch = Vec2::Zero();  ///< mm, along x and y
  double deviation = 0.0;     ///< mm
};

/// Without a machine the layers get half of T where `deviation` is open, and the pitch, the same along both axes, what
/// is left, both rounded down to two digits; with one the pitch is the machine's and the layers get what is left.
/// Throws UsageError when T isn't positive, or the machine's pitch or the deviation asked for leaves nothing.
[[nodiscard]] AdaptiveShare share_accuracy(double accuracy, std::optional<double> deviation, const Machine* machine);

/// What adaptive layers with this share guarantee when none is thicker than `thickest` and their largest deviation is
/// `deviation`, both in mm. `offset_bound` isn't held down to T.
[[nodiscard]] LatticeChoice adaptive_guarantee(const Scene& scene, const IdVector<SolidId, SolidMeasure>& measures,
                                               std::span<const SolidId> solids, double accuracy, const Vec2& pitch,
                                               double thickest, double deviation);

}  // namespace lamella::accuracy
