#pragma once

#include "model/curve.h"

/// Private to model/step.
namespace lamella::step {

/// A box of the plane curve over `range`, never too small: exact for lines and ellipses, the hull of the poles of the
/// part in `range` for B-splines, of the tangents' triangle for parabolas and hyperbolas.
[[nodiscard]] Box2 curve_box(const Curve2& curve, const Interval& range);

}  // namespace lamella::step
