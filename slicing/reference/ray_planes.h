#pragma once

#include "core/geometry.h"

namespace lamella::reference {

/// A ray as the intersection of two planes (Kajiya 1982; paper, eq. 4 to 6): a point p lies on the ray iff
/// n1.(p - o) = 0 and n2.(p - o) = 0. The normals have unit length, so that both values are distances in mm, and
/// (n1, n2, direction) is orthogonal with n1 x n2 = -direction.
struct RayPlanes {
  Vec3 n1;
  Vec3 n2;
  Vec3 origin;     ///< any point of the ray; pick one near the model, rounding grows with its distance
  Vec3 direction;  ///< unit length

  /// The ray's parameter of the point nearest to `p`, mm from `origin`.
  [[nodiscard]] double depth(const Vec3& p) const { return direction.dot(p - origin); }
};

/// The paper's eq. (4) to (6) with normalised normals; (4) never gives a null vector, see docs/methods.
[[nodiscard]] RayPlanes make_ray_planes(const Ray& ray);

}  // namespace lamella::reference
