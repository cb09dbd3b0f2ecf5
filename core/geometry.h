#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

/// Vocabulary of the geometry: lengths in mm, angles in radians, parameters dimensionless.
namespace lamella {

template <int Dim>
using Vec = Eigen::Matrix<double, Dim, 1>;
using Vec2 = Vec<2>;
using Vec3 = Vec<3>;
using Vec4 = Vec<4>;
using Mat3 = Eigen::Matrix3d;
using Box2 = Eigen::AlignedBox2d;
using Box3 = Eigen::AlignedBox3d;

/// A closed interval [lo, hi].
struct Interval {
  double lo = 0.0;
  double hi = 0.0;

  [[nodiscard]] double length() const { return hi - lo; }
  [[nodiscard]] double middle() const { return 0.5 * (lo + hi); }
  [[nodiscard]] bool contains(double x) const { return lo <= x && x <= hi; }
};

/// A line in space: point(t) = origin + t * direction, with |direction| = 1, so that t is a length in mm.
struct Ray {
  Vec3 origin = Vec3::Zero();
  Vec3 direction = Vec3::UnitX();

  [[nodiscard]] Vec3 at(double t) const { return origin + t * direction; }
};

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kTwoPi = 2.0 * kPi;

}  // namespace lamella
