#pragma once

#include <filesystem>

#include "bench/mesh.h"

namespace lamella::bench {

/// Tessellates the solids of a STEP file with OpenCASCADE on one thread: `deflection` in mm is the largest distance
/// from the surface, the angle is left at OpenCASCADE's usual 0.5 rad. Nodes that an edge gives to both its faces
/// become one vertex. Throws std::runtime_error.
[[nodiscard]] ModelMesh tessellate(const std::filesystem::path& file, double deflection);

}  // namespace lamella::bench
