#pragma once

#include <memory>
#include <optional>
#include <string>

#include "materials/field.h"
#include "materials/stops.h"

namespace lamella {

/// Fractions by the distance along a direction (unit length) from `origin`, part frame, mm.
[[nodiscard]] std::shared_ptr<const FieldSource> make_axis_field(const Vec3& origin, const Vec3& direction,
                                                                 Stops stops);

/// Fractions by the distance from the line through `origin` along `direction`, or without one from the point `origin`.
[[nodiscard]] std::shared_ptr<const FieldSource> make_radial_field(const Vec3& origin,
                                                                   const std::optional<Vec3>& direction, Stops stops);

/// Fractions by the exact distance from the solid's own faces: of those whose name matches the glob `faces`, or of all.
/// `where` is named in errors.
[[nodiscard]] std::shared_ptr<const FieldSource> make_distance_field(std::optional<std::string> faces, Stops stops,
                                                                     std::string where);

}  // namespace lamella
