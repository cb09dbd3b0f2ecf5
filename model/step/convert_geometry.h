#pragma once

#include <Geom2d_Curve.hxx>
#include <Geom_Curve.hxx>
#include <Geom_Surface.hxx>
#include <gp_Trsf.hxx>
#include <stdexcept>
#include <string>

#include "core/geometry.h"
#include "model/curve.h"
#include "model/surface.h"

/// Private to model/step: OpenCASCADE geometry into the model's own.
namespace lamella::step {

/// A placement without scaling: x -> linear * x + translation, |det(linear)| = 1. Mirrors if det(linear) < 0.
struct Placement {
  Mat3 linear = Mat3::Identity();
  Vec3 translation = Vec3::Zero();

  [[nodiscard]] bool mirrors() const { return linear.determinant() < 0.0; }
  [[nodiscard]] Vec3 point(const Vec3& p) const { return linear * p + translation; }
  [[nodiscard]] Vec3 direction(const Vec3& d) const { return linear * d; }
};

/// The placement of `trsf`, whose scale factor must be 1 or -1.
[[nodiscard]] Placement placement_of(const gp_Trsf& trsf);

/// Geometry that the model can't hold; the converter of solids turns it into a finding.
class Unconvertible : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The curve with its parametrisation. Periodic B-splines become clamped ones that cover `range`; what has no exact
/// form (offset curves) is fitted over `range` within `tolerance` mm. Throws Unconvertible or GeometryError.
[[nodiscard]] Curve3 convert_curve(const Handle(Geom_Curve) & curve, const Placement& placement, const Interval& range,
                                   double tolerance = 1e-9);
[[nodiscard]] Curve2 convert_curve(const Handle(Geom2d_Curve) & curve, const Interval& range, double tolerance = 1e-9);

/// The surface with its parametrisation, valid over `uv` at least; what has no exact form becomes a FittedSurface.
/// Throws Unconvertible or GeometryError.
[[nodiscard]] Surface convert_surface(const Handle(Geom_Surface) & surface, const Placement& placement, const Box2& uv);

/// Whether the surface is a plane, trimmed or not.
[[nodiscard]] bool is_plane(const Handle(Geom_Surface) & surface);

/// The orthogonal projection of a space curve onto a plane, exact for every kind of curve, same parametrisation.
[[nodiscard]] Curve2 project_onto(const Plane& plane, const Curve3& curve);

}  // namespace lamella::step
