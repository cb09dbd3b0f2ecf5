#pragma once

#include <TopoDS_Shape.hxx>
#include <TopoDS_Solid.hxx>

#include "datasets/generator/spline.h"

/// Ruled and converted spline surfaces.
namespace lamella::datasets {

/// Boundary curve of a clamped surface: u or v at its first or last knot.
enum class Side { u_first, u_last, v_first, v_last };
[[nodiscard]] SplineCurve boundary(const SplineSurface& surface, Side side);

/// Surface of straight lines between two curves of the same degree and knots (degree 1 in v).
[[nodiscard]] SplineSurface ruled(const SplineCurve& from, const SplineCurve& to);

/// Two surfaces with the same knots and the four ruled flanks between their boundaries.
[[nodiscard]] std::vector<SplineSurface> between(const SplineSurface& low, const SplineSurface& high);

/// Full circle of four rational quarters, one closed curve in the plane z = 0.
[[nodiscard]] SplineCurve closed_circle(double x, double y, double radius);

/// All faces as B-splines, outward-oriented.
[[nodiscard]] TopoDS_Solid as_nurbs(const TopoDS_Shape& solid);

}  // namespace lamella::datasets
