#pragma once

#include <span>

#include "export/follow_curves.h"
#include "export/step_entities.h"

namespace lamella {

/// Writes a closed loop of stretches at height z: a whole ellipse as CIRCLE or ELLIPSE, else a COMPOSITE_CURVE of
/// POLYLINEs, TRIMMED_CURVEs of circles and ellipses, RATIONAL_B_SPLINE_CURVEs of degree 2 for other conics, and
/// B_SPLINE_CURVE_WITH_KNOTS of degree 5. Numbers have all their
/// digits. `name` is a string with its quotes. Returns the curve's id.
[[nodiscard]] StepId add_curve_loop(StepEntities& entities, std::span<const CurveStretch> loop, double z,
                                    std::string_view name);

/// A conic section by its axes: centre + cos(a) major + sin(a) minor, a ascending from `begin` by `sweep`.
struct ConicArc {
  Vec2 center = Vec2::Zero();
  Vec2 major = Vec2::Zero();  ///< mm, at right angles to `minor` and no shorter
  Vec2 minor = Vec2::Zero();
  double begin = 0.0;  ///< radians, in [0, 2 pi)
  double sweep = 0.0;  ///< radians, positive
};

/// The axes of a stretch of an ellipse.
[[nodiscard]] ConicArc conic_of(const CurveStretch& stretch);

struct RationalBezier {
  std::array<Vec2, 3> poles;  ///< mm
  std::array<double, 3> weights;
};

/// The rational Bezier curve of degree 2 that a stretch of a conic is.
[[nodiscard]] RationalBezier rational_of(const CurveStretch& stretch);

/// Poles of the Bezier curve of degree 5 that a stretch of a quintic is.
[[nodiscard]] std::array<Vec2, 6> bezier_of(const CurveStretch& stretch);

}  // namespace lamella
