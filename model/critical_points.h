#pragma once

#include <vector>

#include "core/geometry.h"
#include "model/surface.h"

namespace lamella {

/// What the height of a surface does around one of its critical points; `flat` where second derivatives don't tell
/// (a monkey saddle, say).
enum class CriticalKind { minimum, maximum, saddle, flat };

struct CriticalPoint {
  Vec2 uv;
  double z;  ///< mm
  CriticalKind kind;
};

struct CriticalPoints {
  std::vector<CriticalPoint> points;  ///< isolated ones, no two of them at the same place
  std::vector<double> levels;         ///< mm, ascending: heights of whole lines and areas of critical points
  bool complete = true;               ///< false if the search hit its limit; what is left then is among `levels`
};

/// All places in `uv_bounds` (radians or mm, padded by 1e-9 of its size) where the height S(u, v).z is stationary, and
/// where it may have an extremum or a saddle along the creases of a surface that is only continuous. Between two
/// neighbouring heights of `points` and `levels` the section z = const doesn't change its topology inside the face,
/// but where the section meets the face's border, which is not looked at.
///
/// Every copy of a point in a periodic parameter counts. `uv` is accurate as Newton's method makes it, `z` to rounding.
/// Levels hold the heights of their sets to 1e-7 mm. Poles and apexes, where S_u or S_v vanish, are only found where
/// the height is stationary in every direction. Bounds or surfaces that aren't finite give nothing, not complete.
/// Throws GeometryError for splines beyond kMaxDegree, and as rational_form() does for skew surfaces of revolution.
[[nodiscard]] CriticalPoints find_critical_points(const Surface& surface, const Box2& uv_bounds);

}  // namespace lamella
