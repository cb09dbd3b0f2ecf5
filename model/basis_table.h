#pragma once

#include <vector>

#include "model/bspline.h"

namespace lamella {

/// The B-splines over one knot vector, for many evaluations: the reciprocals of all knot differences that the Cox-de
/// Boor recursion divides by are kept, so that a point costs no division. Within a few ulp of evaluate_basis().
class BasisTable {
 public:
  /// Knots as check_limits() wants them; they must outlive the object. Throws GeometryError for a degree outside
  /// [1, kMaxDegree].
  BasisTable(std::span<const double> knots, int degree);

  [[nodiscard]] int degree() const { return degree_; }
  /// Writes the degree + 1 B-splines that don't vanish at `t` (clamped to the domain) and their first derivatives.
  /// Returns the index of the first pole they belong to.
  int evaluate(double t, double* values, double* slopes) const;

 private:
  [[nodiscard]] std::size_t per_span() const { return static_cast<std::size_t>(degree_) * (degree_ + 1) / 2; }

  std::span<const double> knots_;
  int degree_;
  std::vector<double> reciprocals_;  ///< per span from knot `degree` on: of degree 1, 2, ..., in the recursion's order
};

}  // namespace lamella
