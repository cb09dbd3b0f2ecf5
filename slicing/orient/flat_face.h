#pragma once

#include <optional>

#include "model/scene.h"

namespace lamella {

/// The outward unit normal of a face that is flat: a plane, or a B-spline whose net lies in one to 1e-9 of its size.
[[nodiscard]] std::optional<Vec3> flat_normal(const Face& face);

}  // namespace lamella
