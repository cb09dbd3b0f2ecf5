#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry.h"

namespace lamella {

/// Voxels along each side of the torus that void_and_cluster() ranks.
inline constexpr int kTorusSide = 32;

/// The order in which the voxels of a torus of 32 x 32 x 32 are to be filled so that every prefix of it is spread
/// evenly: ranks 0 to 32767, each once, x fastest, then y, then z.
///
/// `pitch` is the size of a voxel, in any unit: distances are taken in it, so the ranks depend on its ratios. One
/// thread, the same ranks every time. Throws std::invalid_argument unless the pitch is positive, finite and its sides
/// differ by 100 times at most. Source: Ulichney, The void-and-cluster method for dither array generation, SPIE 1913
/// (1993).
[[nodiscard]] std::vector<std::uint16_t> void_and_cluster(const Vec3& pitch);

}  // namespace lamella
