#pragma once

#include <vector>

namespace lamella {

inline constexpr int kMaxGaussNodes = 64;

/// Gauss-Legendre quadrature on [0, 1]: exact for polynomials up to degree 2 n - 1.
struct GaussRule {
  std::vector<double> nodes;    ///< ascending, in (0, 1)
  std::vector<double> weights;  ///< their sum is 1
};

/// The rule with `count` nodes, 1 <= count <= kMaxGaussNodes (clamped). Nodes by Newton's method on the Legendre
/// polynomial, to the last bit or two. Thread-safe; the reference stays valid.
[[nodiscard]] const GaussRule& gauss_legendre(int count);

}  // namespace lamella
