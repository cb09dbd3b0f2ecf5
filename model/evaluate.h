#pragma once

#include "core/geometry.h"
#include "model/curve.h"
#include "model/surface.h"

namespace lamella {

/// Position and first derivatives of a surface; N = du x dv is the paper's normal (eq. 11, 12).
struct SurfacePoint {
  Vec3 point;
  Vec3 du;
  Vec3 dv;
  [[nodiscard]] Vec3 normal() const { return du.cross(dv); }
};

/// With second derivatives as well.
struct SurfacePoint2 : SurfacePoint {
  Vec3 duu;
  Vec3 duv;
  Vec3 dvv;
};

template <int Dim>
struct CurvePoint {
  Vec<Dim> point;
  Vec<Dim> dt;
};

/// With the second derivative as well.
template <int Dim>
struct CurvePoint2 : CurvePoint<Dim> {
  Vec<Dim> dtt;
};

/// Evaluates at (u, v), analytic surfaces by their formula, B-splines by de Boor's algorithm on the active span.
/// Parameters outside a B-spline's domain are clamped.
[[nodiscard]] Vec3 evaluate_point(const Surface& surface, const Vec2& uv);
[[nodiscard]] SurfacePoint evaluate(const Surface& surface, const Vec2& uv);
[[nodiscard]] SurfacePoint2 evaluate2(const Surface& surface, const Vec2& uv);

template <int Dim>
[[nodiscard]] CurvePoint<Dim> evaluate(const Curve<Dim>& curve, double t);

template <int Dim>
[[nodiscard]] CurvePoint2<Dim> evaluate2(const Curve<Dim>& curve, double t);

extern template CurvePoint2<2> evaluate2<2>(const Curve<2>&, double);
extern template CurvePoint2<3> evaluate2<3>(const Curve<3>&, double);
extern template CurvePoint<2> evaluate<2>(const Curve<2>&, double);
extern template CurvePoint<3> evaluate<3>(const Curve<3>&, double);

/// The point of an extrusion over a point of its basis, and of a revolution over a point of its meridian.
[[nodiscard]] SurfacePoint2 extrude(const CurvePoint2<3>& base, const Vec3& direction, double v);
[[nodiscard]] SurfacePoint2 revolve(const CurvePoint2<3>& base, const Revolution& revolution, double u);

/// Periods in u and v, 0 where the surface isn't periodic.
[[nodiscard]] Vec2 periods(const Surface& surface);

}  // namespace lamella
