#include "slicing/orient/sphere.h"

#include <cmath>

namespace lamella {

std::vector<Vec3> half_sphere(int level) {
  const int n = 1 << level;
  std::vector<Vec3> directions;
  // Points of the octahedron |x| + |y| + |z| = n; of the rim z = 0 one half.
  for (int x = -n; x <= n; ++x) {
    for (int y = -(n - std::abs(x)); y <= n - std::abs(x); ++y) {
      const int z = n - std::abs(x) - std::abs(y);
      if (z == 0 && (y < 0 || (y == 0 && x < 0))) continue;
      directions.push_back(Vec3(x, y, z).normalized());
    }
  }
  return directions;
}

Mat3 turn_upright(const Vec3& up) {
  Vec3 z = up.normalized();
  int axis = 0;
  z.cwiseAbs().maxCoeff(&axis);
  if (1.0 - std::abs(z[axis]) < 1e-24 || (z - z[axis] * Vec3::Unit(axis)).norm() < 1e-12) {
    z = std::copysign(1.0, z[axis]) * Vec3::Unit(axis);
  }
  // The axis that is most across becomes, as far as it can, the new x.
  int across = 0;
  z.cwiseAbs().minCoeff(&across);
  const Vec3 x = (Vec3::Unit(across) - z[across] * z).normalized();
  Mat3 turn;
  turn.row(0) = x;
  turn.row(1) = z.cross(x);
  turn.row(2) = z;
  return turn;
}

}  // namespace lamella
