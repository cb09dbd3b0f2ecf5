#pragma once

#include "model/rational_form.h"
#include "model/scene.h"

namespace lamella::reference {

/// The rational form of a face over its (u, v) bounds, widened by about `margin` mm on every side that isn't a whole
/// period, so that hits just beyond the trimmed region are still seen. Where a B-spline ends at the bound, its last
/// Bezier pieces are extended: by 1e-3 of their width at most.
[[nodiscard]] RationalForm padded_form(const Face& face, double margin);

}  // namespace lamella::reference
