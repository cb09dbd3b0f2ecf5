#pragma once

#include <span>
#include <vector>

namespace lamella {

/// Parameters in (0, 1), ascending, at which a polynomial given by its Bernstein coefficients changes sign or may touch
/// zero, by the variation-diminishing property and bisection. Roots closer than 1e-12 count once. A polynomial that is
/// zero throughout (against `scale`) has none. Non-finite coefficients give none.
[[nodiscard]] std::vector<double> bernstein_roots(std::span<const double> coefficients, double scale);

}  // namespace lamella
