#pragma once

#include <vector>

#include "core/geometry.h"

namespace lamella {

/// Unit vectors within `half_angle` (radians) of `axis`; all directions from pi / 2 on.
struct NormalCone {
  Vec3 axis = Vec3::UnitZ();
  double half_angle = kPi;
};

/// A cone that holds every combination of `directions` with factors that aren't negative. Directions no longer than
/// `rounding` say nothing and are left out; if all are, the cone holds everything.
[[nodiscard]] NormalCone cone_of(const std::vector<Vec3>& directions, double rounding = 0.0);

/// Bound of the slant |n_z| over the unit vectors of a cone.
[[nodiscard]] double largest_slant(const NormalCone& cone);

/// Bound of |n_z| over the unit vectors n that are combinations, with factors that aren't negative, of one vector of
/// each cone: what the normals may be around an edge between two faces (docs/methods/adaptive-layers.md).
[[nodiscard]] double largest_slant_between(const NormalCone& first, const NormalCone& second);

/// The same over combinations of any number of unit vectors: the normals around a vertex.
[[nodiscard]] double largest_slant_among(const std::vector<Vec3>& normals);

}  // namespace lamella
