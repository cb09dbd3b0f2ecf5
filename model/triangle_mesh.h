#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/geometry.h"

namespace lamella {

/// Triangles of one solid, each counterclockwise seen from outside. Faces have nodes of their own along shared edges;
/// where they meet, these have the same coordinates.
struct TriangleMesh {
  std::vector<Vec3> vertices;                           ///< mm
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into `vertices`
};

}  // namespace lamella
