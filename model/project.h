#pragma once

#include "core/geometry.h"
#include "model/surface.h"

namespace lamella {

/// Parameters within `box` of a point of the surface that lies within `near` mm of `point`: Gauss-Newton steps from the
/// local minima of a grid, which is refined until such a point is found. The steps go on until the distance falls no
/// more. Without such a point, of what was found the nearest. Where several parameters give the point (a pole, a seam)
/// it is one of them.
[[nodiscard]] Vec2 project(const Surface& surface, const Box2& box, const Vec3& point, double near);

}  // namespace lamella
