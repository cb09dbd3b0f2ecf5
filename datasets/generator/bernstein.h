#pragma once

#include "datasets/generator/spline.h"

namespace lamella::datasets {

/// The curve of a Bezier height field (parameters x, y) above a Bezier curve in the plan, exactly: a rational Bezier
/// curve of degree (degree_u + degree_v) times the plan curve's.
[[nodiscard]] SplineCurve lift(const SplineCurve& plan, const SplineSurface& field);

/// The same curve as (t, z): its trace on a wall whose parameters are t and z. One degree higher.
[[nodiscard]] SplineCurve over_parameter(const SplineCurve& lifted);

}  // namespace lamella::datasets
