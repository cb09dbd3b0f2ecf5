#pragma once

#include <functional>

#include "tests/support/solids.h"

/// Hand-built solids around one B-spline patch.
namespace lamella::test {

/// The B-spline surface of degree `degree` in both parameters that interpolates a polynomial of that degree over
/// [u] x [v]; exact up to rounding.
[[nodiscard]] BSplineSurface polynomial_patch(const std::function<Vec3(double, double)>& at, int degree, Interval u,
                                              Interval v);

/// What a patch sweeps along `way`: the patch, its moved copy, and four sides of extrusion. `way` must cross the patch
/// in one sense everywhere, and points of the patch must not come to lie on each other. The volume is good to 1e-4.
KnownSolid add_swept_patch(Scene& scene, const BSplineSurface& patch, const Vec3& way,
                           const SolidOptions& options = {});

/// Below z = 1 - x^2 - y^2 and above z = -2 over [-1, 1]^2, without a square tunnel [-half, half]^2 about the apex: for
/// 0 < z < 1 - 2 half^2 the dome's section is a circle that meets no edge.
KnownSolid add_pierced_dome(Scene& scene, double half, const SolidOptions& options = {});

}  // namespace lamella::test
