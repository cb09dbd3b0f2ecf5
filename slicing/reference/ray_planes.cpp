#include "slicing/reference/ray_planes.h"

namespace lamella::reference {

RayPlanes make_ray_planes(const Ray& ray) {
  const Vec3& d = ray.direction;
  const Vec3 a = d.cwiseAbs();
  // Eq. (4). In the second case |d_x| is at most |d_y| or |d_z|, so that one of these is at least 1 / sqrt(3): neither
  // vector is short, though the case split looks at x alone.
  const bool x_largest = a.x() > a.y() && a.x() > a.z();
  const Vec3 normal = x_largest ? Vec3(d.y(), -d.x(), 0.0) : Vec3(0.0, d.z(), -d.y());
  const Vec3 n1 = normal.normalized();
  return {n1, n1.cross(d).normalized(), ray.origin, d};
}

}  // namespace lamella::reference
