#pragma once

#include <functional>

#include "model/scene.h"

/// Solids said in another way: the same point sets, other surfaces and parameters.
namespace lamella::test {

/// Every face on a rational B-spline surface of its own shape, pcurves carried over; edges stay as they are.
[[nodiscard]] Scene as_splines(Scene scene);

/// The face's B-spline surface from the rational form of its surface; `uv` says how its parameters map.
struct SplineForm {
  BSplineSurface surface;
  std::function<Vec2(const Vec2&)> from_surface;
};
[[nodiscard]] SplineForm spline_form(const Surface& surface, const Box2& uv_bounds);

/// A pcurve of `spans` cubic pieces over `range` that interpolates `uv(t)` at four points of each.
[[nodiscard]] Curve2 fitted_pcurve(const std::function<Vec2(double)>& uv, Interval range, int spans = 64);

}  // namespace lamella::test
