#pragma once

#include <vector>

#include "core/geometry.h"

namespace lamella {

/// Directions spread over the half sphere z >= 0, of d and -d only one: an octahedron divided `level` times, the poles
/// and axes among them. 3, 9, 33, 129, ... of them; the largest gap is about 90 degrees / 2^level.
[[nodiscard]] std::vector<Vec3> half_sphere(int level);

/// A rotation that turns `up` (a unit vector) to +z. Directions within 1e-12 of an axis turn by exact quarter turns, so
/// that planes along the axes stay so to the last bit.
[[nodiscard]] Mat3 turn_upright(const Vec3& up);

}  // namespace lamella
