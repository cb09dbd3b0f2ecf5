#pragma once

#include "model/rational_form.h"
#include "model/scene.h"

namespace lamella::reference {

/// The rational form of a face over its (u, v) bounds, widened by 1e-9 of them against the rounding of the pcurves, but
/// not beyond a whole period.
[[nodiscard]] RationalForm face_form(const Face& face);

}  // namespace lamella::reference
