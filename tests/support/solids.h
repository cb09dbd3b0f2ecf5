#pragma once

#include <optional>
#include <string>

#include "core/geometry.h"
#include "core/ids.h"
#include "model/scene.h"

/// Hand-built solids with closed forms. Their half-edge structure is complete: twins, closed shells, voids, exact
/// pcurves, seams and degenerate edges at poles and apexes.
namespace lamella::test {

/// Rotation or rotation with mirror, then translation: p -> linear p + translation, `linear` orthogonal.
struct Placement {
  Mat3 linear = Mat3::Identity();
  Vec3 translation = Vec3::Zero();

  [[nodiscard]] bool mirrors() const { return linear.determinant() < 0.0; }
  [[nodiscard]] Vec3 apply(const Vec3& point) const { return linear * point + translation; }

  static Placement at(const Vec3& translation) { return {Mat3::Identity(), translation}; }
  /// Turned by `angle` (radians) about an axis through the origin, then moved.
  static Placement turned(const Vec3& axis, double angle, const Vec3& translation = Vec3::Zero());
  /// Mirrored at the plane through the origin with this normal, then moved.
  static Placement mirrored(const Vec3& normal, const Vec3& translation = Vec3::Zero());
};

/// Where a hand-built solid goes and what it is called. Path defaults to "/" + name.
struct SolidOptions {
  Placement placement;
  std::string name = "solid";
  std::string path{};
  std::optional<Color> color{};
};

/// A solid just added, with its exact values (mm^3, mm^2).
struct KnownSolid {
  SolidId id;
  double volume = 0.0;
  std::optional<double> area;  ///< absent where there is no closed form
};

/// Axis-parallel (before placement) box from `lo` to `hi`.
KnownSolid add_box(Scene& scene, const Vec3& lo, const Vec3& hi, const SolidOptions& options = {});

/// Cylinder about z from z = 0 to `height`.
KnownSolid add_cylinder(Scene& scene, double radius, double height, const SolidOptions& options = {});

/// Cone frustum about z: radius `r0` at z = 0, `r1` at z = `height`; both > 0 and different.
KnownSolid add_frustum(Scene& scene, double r0, double r1, double height, const SolidOptions& options = {});

/// Cone about z with its base at z = 0 and its apex (a degenerate edge) at z = `height`.
KnownSolid add_cone(Scene& scene, double radius, double height, const SolidOptions& options = {});

/// Sphere about the origin: one face, a seam, and a degenerate edge at each pole.
KnownSolid add_sphere(Scene& scene, double radius, const SolidOptions& options = {});

/// Torus about z: one face, two seams, one vertex.
KnownSolid add_torus(Scene& scene, double major, double minor, const SolidOptions& options = {});

/// Box [0,a] x [0,b] x [0,h] whose top is one bicubic B-spline face, the graph of a Bernstein polynomial of z over x
/// and y: net heights h at the corners, h + bump / 2 along the border, h + bump inside. Its four sides end in cubics.
KnownSolid add_dome(Scene& scene, double a, double b, double h, double bump, const SolidOptions& options = {});

/// Box from `lo` to `hi` with a round hole along z through its middle.
KnownSolid add_box_with_hole(Scene& scene, const Vec3& lo, const Vec3& hi, double hole_radius,
                             const SolidOptions& options = {});

/// Box from `lo` to `hi` with a spherical void about its middle: two shells.
KnownSolid add_box_with_void(Scene& scene, const Vec3& lo, const Vec3& hi, double void_radius,
                             const SolidOptions& options = {});

/// A scene of one solid, e.g. `scene_of(add_sphere, 2.0)`.
template <class Add, class... Args>
Scene scene_of(Add add, const Args&... args) {
  Scene scene;
  if constexpr (requires { add(scene, args...); }) {
    add(scene, args...);
  } else {
    add(scene, args..., SolidOptions{});
  }
  return scene;
}

/// Boxes "left" [0,1]^3 and "right" [1,2] x [0,1]^2.
Scene touching_boxes();

/// Boxes "first" [0,2]^3 and "second" [1,3]^3: they share the cube [1,2]^3.
Scene overlapping_boxes();

}  // namespace lamella::test
