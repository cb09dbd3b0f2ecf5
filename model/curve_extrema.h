#pragma once

#include <vector>

#include "core/geometry.h"
#include "model/curve.h"

namespace lamella {

/// Parameters inside `range` at which direction . C(t) may have a local extremum; the ends of `range` aren't among
/// them. Complete up to roots closer than 1e-12 of a Bezier piece; extrema of a piece that can't leave `known` (values
/// of direction . C found already, an interval) may be left out.
[[nodiscard]] std::vector<double> critical_parameters(const Curve3& curve, Interval range, const Vec3& direction,
                                                      const Interval* known = nullptr);

/// Exact bounds of the curve over `range`: its ends and its extrema along x, y and z.
[[nodiscard]] Box3 exact_bounds(const Curve3& curve, Interval range);

}  // namespace lamella
