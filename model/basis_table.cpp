#include "model/basis_table.h"

#include <algorithm>
#include <string>

#include "core/error.h"

namespace lamella {

BasisTable::BasisTable(std::span<const double> knots, int degree) : knots_(knots), degree_(degree) {
  if (degree < 1 || degree > kMaxDegree) throw GeometryError("a B-spline of degree " + std::to_string(degree));
  const int last = static_cast<int>(knots.size()) - degree - 1;
  reciprocals_.reserve(per_span() * static_cast<std::size_t>(std::max(last - degree, 0)));
  for (int span = degree; span < last; ++span) {
    for (int d = 1; d <= degree; ++d) {
      for (int j = 0; j < d; ++j) reciprocals_.push_back(1.0 / (knots[span + 1 + j] - knots[span - d + 1 + j]));
    }
  }
}

int BasisTable::evaluate(double t, double* values, double* slopes) const {
  const double x = std::clamp(t, knots_[degree_], knots_[knots_.size() - degree_ - 1]);
  const int span = find_span(knots_, degree_, x);
  const double* reciprocal = reciprocals_.data() + per_span() * static_cast<std::size_t>(span - degree_);
  values[0] = 1.0;
  for (int d = 1; d <= degree_; ++d) {
    double carried = 0.0;
    double carried_slope = 0.0;
    for (int j = 0; j < d; ++j) {
      const double share = values[j] * *reciprocal++;
      values[j] = carried + (knots_[span + 1 + j] - x) * share;
      carried = (x - knots_[span - d + 1 + j]) * share;
      if (d < degree_) continue;
      slopes[j] = degree_ * (carried_slope - share);
      carried_slope = share;
    }
    values[d] = carried;
    slopes[d] = degree_ * carried_slope;
  }
  return span - degree_;
}

}  // namespace lamella
