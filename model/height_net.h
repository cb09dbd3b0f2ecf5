#pragma once

#include <cstddef>

#include "core/geometry.h"

/// Bernstein nets of the height over a part of a patch: bounds of its derivatives, and its value and derivatives at a
/// place. Plain numbers without storage of their own, for searches that look at very many of them.
namespace lamella {

/// How a net lies in memory: w (z - c) for some c, [i * (degree_v + 1) + j], i along u; if rational followed by w in
/// the same order.
struct NetShape {
  int degree_u = 0;
  int degree_v = 0;
  bool rational = false;

  [[nodiscard]] int stride() const { return degree_v + 1; }
  [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>(degree_u + 1) * (degree_v + 1); }
  [[nodiscard]] std::size_t doubles() const { return rational ? 2 * count() : count(); }
};

/// Height and derivatives by the net's own parameters, both in [0, 1] over the net's part of the patch.
struct HeightJet {
  double value = 0.0;
  double u = 0.0;
  double v = 0.0;
  double uu = 0.0;
  double uv = 0.0;
  double vv = 0.0;
};

/// Holds the height over the net, by the convex hull property.
[[nodiscard]] Interval height_range(const NetShape& shape, const double* net);

/// True if the derivative of the height along one parameter is certain to be positive throughout or negative
/// throughout. `range` as height_range() gives it, `slack` (mm) how far from
/// zero the derivative's coefficients must stay, over the degree.
[[nodiscard]] bool keeps_sign(const NetShape& shape, const double* net, bool along_u, const Interval& range,
                              double slack);

/// True if the gradient of the height is certain not to take any value twice, so that at most one place is stationary.
/// `rounding` (mm) is the error of the numbers in the net.
[[nodiscard]] bool has_one_to_one_gradient(const NetShape& shape, const double* net, const Interval& range,
                                           double rounding);

/// Bounds of the height's third derivatives over a net.
struct ThirdDerivatives {
  double any = 0.0;  ///< of D^3 z[a, b, c] for all a, b, c with components up to 1
  bool signs_known = false;
  Interval uuu;  ///< only if `signs_known`, as the others
  Interval uuv;
  Interval uvv;
  Interval vvv;

  /// Bound of the third derivative along one direction with components up to 1.
  [[nodiscard]] double along(const Vec2& axis) const;
};
[[nodiscard]] ThirdDerivatives third_derivatives(const NetShape& shape, const double* net, const Interval& range);

/// Is the height more uneven along u than along v?
[[nodiscard]] bool varies_more_in_u(const NetShape& shape, const double* net, const Interval& range);

/// `first` holds the net on entry; afterwards the two nets are its halves.
void halve(const NetShape& shape, double* first, double* second, bool along_u);

/// By de Casteljau's algorithm; (s, t) may lie somewhat outside the net's part.
[[nodiscard]] HeightJet evaluate_jet(const NetShape& shape, const double* net, double s, double t);

}  // namespace lamella
