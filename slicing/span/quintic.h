#pragma once

#include <array>

namespace lamella::span {

/// A polynomial of degree 5, coefficients ascending.
using Quintic = std::array<double, 6>;

[[nodiscard]] inline double value_at(const Quintic& c, double t) {
  return c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * (c[4] + t * c[5]))));
}

/// Bernstein coefficients of the derivative on [0, 1].
[[nodiscard]] inline std::array<double, 5> slope_net(const Quintic& c) {
  const double a = c[1], b = 2.0 * c[2], d = 3.0 * c[3], e = 4.0 * c[4], f = 5.0 * c[5];
  return {a, a + b / 4.0, a + b / 2.0 + d / 6.0, a + 0.75 * b + d / 2.0 + e / 4.0, a + b + d + e + f};
}

/// Bernstein coefficients of the second derivative on [0, 1].
[[nodiscard]] inline std::array<double, 4> bend_net(const Quintic& c) {
  const double a = 2.0 * c[2], b = 6.0 * c[3], d = 12.0 * c[4], e = 20.0 * c[5];
  return {a, a + b / 3.0, a + 2.0 * b / 3.0 + d / 3.0, a + b + d + e};
}

}  // namespace lamella::span
