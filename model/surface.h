#pragma once

#include <string>
#include <variant>
#include <vector>

#include "core/geometry.h"
#include "model/curve.h"

namespace lamella {

/// Orthonormal axes at an origin; left-handed after a mirroring placement.
struct Frame {
  Vec3 origin = Vec3::Zero();
  Vec3 x = Vec3::UnitX();
  Vec3 y = Vec3::UnitY();
  Vec3 z = Vec3::UnitZ();
};

// The parametrisations are those of ISO 10303-42 with angles in radians and lengths in mm.

/// S(u,v) = O + u X + v Y
struct Plane {
  Frame frame;
};

/// S(u,v) = O + r (cos u X + sin u Y) + v Z
struct Cylinder {
  Frame frame;
  double radius;
};

/// S(u,v) = O + (r + v sin a) (cos u X + sin u Y) + v cos a Z, a the half angle
struct Cone {
  Frame frame;
  double radius;
  double half_angle;
};

/// S(u,v) = O + r cos v (cos u X + sin u Y) + r sin v Z
struct Sphere {
  Frame frame;
  double radius;
};

/// S(u,v) = O + (R + r cos v) (cos u X + sin u Y) + r sin v Z
struct Torus {
  Frame frame;
  double major_radius;
  double minor_radius;
};

/// S(u,v) = C(u) + v D, |D| = 1
struct Extrusion {
  Curve3 basis;
  Vec3 direction;
};

/// S(u,v) = C(v) turned by u about the axis, |axis_direction| = 1
struct Revolution {
  Curve3 meridian;
  Vec3 axis_origin;
  Vec3 axis_direction;
};

/// A clamped, non-periodic, possibly rational B-spline surface.
/// poles[i * count_v + j], i along u in [0, count_u); knots flat: knots_u.size() == count_u + degree_u + 1.
/// `weights` is empty for a polynomial surface, else positive, laid out as the poles.
struct BSplineSurface {
  int degree_u = 1;
  int degree_v = 1;
  int count_u = 0;
  int count_v = 0;
  std::vector<double> knots_u;
  std::vector<double> knots_v;
  std::vector<Vec3> poles;
  std::vector<double> weights;

  [[nodiscard]] Interval domain_u() const { return {knots_u[degree_u], knots_u[count_u]}; }
  [[nodiscard]] Interval domain_v() const { return {knots_v[degree_v], knots_v[count_v]}; }
};

/// A surface with no exact rational form (an offset, say) as a B-spline over the same (u, v).
struct FittedSurface {
  BSplineSurface fit;
  double bound;  ///< largest distance in mm between fit and original at equal (u, v), as estimated by dense sampling
  std::string origin;  ///< what it stands for, e.g. "offset surface"
};

using Surface =
    std::variant<Plane, Cylinder, Cone, Sphere, Torus, Extrusion, Revolution, BSplineSurface, FittedSurface>;

/// The key of a surface's type in JSON: plane, cylinder, cone, sphere, torus, extrusion, revolution, bspline, fitted.
[[nodiscard]] const char* surface_type_name(const Surface& surface);

}  // namespace lamella
