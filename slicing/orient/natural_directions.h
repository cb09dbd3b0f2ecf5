#pragma once

#include <span>
#include <vector>

#include "model/scene.h"

namespace lamella {

/// Directions in which parts tend to be least high, unit vectors, each once but for its sign: normals of plane faces
/// and axes of round ones, of the most faces first, at most 500.
[[nodiscard]] std::vector<Vec3> natural_directions(const Scene& scene, std::span<const SolidId> solids);

}  // namespace lamella
