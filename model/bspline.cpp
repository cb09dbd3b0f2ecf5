#include "model/bspline.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"

namespace lamella {
namespace {

void check_degree(int degree, const char* what) {
  if (degree >= 1 && degree <= kMaxDegree) return;
  throw GeometryError(std::string(what) + " of degree " + std::to_string(degree) + ", only 1 to " +
                      std::to_string(kMaxDegree) + " can be computed with");
}

/// The clamped knots of `count` poles; a knot may come degree + 1 times, which leaves the curve in two parts there.
void check_knots(std::span<const double> knots, int degree, std::size_t count, const char* what) {
  const std::string name(what);
  const auto order = static_cast<std::size_t>(degree) + 1;
  if (count < order || knots.size() != count + order) {
    throw GeometryError(name + " with " + std::to_string(knots.size()) + " knots for " + std::to_string(count) +
                        " poles of degree " + std::to_string(degree));
  }
  for (std::size_t i = 0; i < knots.size(); ++i) {
    if (!std::isfinite(knots[i])) throw GeometryError(name + " with a knot that is not a finite number");
    if (i > 0 && knots[i] < knots[i - 1]) throw GeometryError(name + " with knots that don't ascend");
    if (i >= order && knots[i] == knots[i - order]) {
      throw GeometryError(name + " with a knot repeated more than degree + 1 times");
    }
  }
  if (knots.front() != knots[degree] || knots.back() != knots[count]) {
    throw GeometryError(name + " whose knots are not clamped at the ends");
  }
}

void check_weights(std::span<const double> weights, std::size_t count, const char* what) {
  const std::string name(what);
  if (weights.empty()) return;
  if (weights.size() != count) throw GeometryError(name + " whose weights and poles differ in number");
  double least = weights[0];
  double largest = weights[0];
  for (const double weight : weights) {
    if (!(weight > 0.0) || !std::isfinite(weight)) throw GeometryError(name + " with a weight that is not positive");
    least = std::min(least, weight);
    largest = std::max(largest, weight);
  }
  if (largest > kMaxWeightRatio * least) {
    throw GeometryError(name + " whose largest weight is more than 1e9 times its smallest");
  }
}

template <int Dim>
void check_poles(const std::vector<Vec<Dim>>& poles, const char* what) {
  const auto finite = [](const Vec<Dim>& pole) { return pole.allFinite(); };
  if (!std::all_of(poles.begin(), poles.end(), finite)) {
    throw GeometryError(std::string(what) + " with a pole that is not finite");
  }
}

/// Derivatives of the B-splines of `degree` from those of one degree less, lower[0, degree).
BasisRow derive(std::span<const double> knots, int span, int degree, const BasisRow& lower) {
  BasisRow result{};
  for (int j = 0; j <= degree; ++j) {
    const int i = span - degree + j;
    double slope = 0.0;
    if (j > 0) slope += lower[j - 1] / (knots[i + degree] - knots[i]);
    if (j < degree) slope -= lower[j] / (knots[i + degree + 1] - knots[i + 1]);
    result[j] = degree * slope;
  }
  return result;
}

}  // namespace

void check_limits(const BSplineSurface& surface) {
  constexpr const char* kWhat = "a B-spline surface";
  check_degree(surface.degree_u, kWhat);
  check_degree(surface.degree_v, kWhat);
  if (surface.count_u < 0 || surface.count_v < 0) throw GeometryError("a B-spline surface without poles");
  const auto count_u = static_cast<std::size_t>(surface.count_u);
  const auto count_v = static_cast<std::size_t>(surface.count_v);
  check_knots(surface.knots_u, surface.degree_u, count_u, kWhat);
  check_knots(surface.knots_v, surface.degree_v, count_v, kWhat);
  if (surface.poles.size() != count_u * count_v) throw GeometryError("a B-spline surface with poles missing");
  check_poles<3>(surface.poles, kWhat);
  check_weights(surface.weights, surface.poles.size(), kWhat);
}

template <int Dim>
void check_limits(const BSplineCurve<Dim>& curve) {
  constexpr const char* kWhat = "a B-spline curve";
  check_degree(curve.degree, kWhat);
  check_knots(curve.knots, curve.degree, curve.poles.size(), kWhat);
  check_poles<Dim>(curve.poles, kWhat);
  check_weights(curve.weights, curve.poles.size(), kWhat);
}

template void check_limits<2>(const BSplineCurve<2>&);
template void check_limits<3>(const BSplineCurve<3>&);

int find_span(std::span<const double> knots, int degree, double t) {
  const auto first = knots.begin() + degree;
  const auto last = knots.end() - degree - 1;
  if (t >= *last) return static_cast<int>(std::lower_bound(first, last, *last) - knots.begin()) - 1;
  return static_cast<int>(std::upper_bound(first + 1, last, t) - knots.begin()) - 1;
}

void raise_degree(std::span<const double> knots, int span, int degree, double x, BasisRow& row) {
  double carried = 0.0;
  for (int j = 0; j < degree; ++j) {
    const double lower = knots[span - degree + 1 + j];
    const double upper = knots[span + 1 + j];
    const double share = row[j] / (upper - lower);
    row[j] = carried + (upper - x) * share;
    carried = (x - lower) * share;
  }
  row[degree] = carried;
}

Basis evaluate_basis(std::span<const double> knots, int degree, double t, int order) {
  if (degree < 1 || degree > kMaxDegree) check_degree(degree, "a B-spline");
  const double x = std::clamp(t, knots[degree], knots[knots.size() - degree - 1]);
  const int span = find_span(knots, degree, x);
  Basis basis;
  basis.first = span - degree;
  BasisRow row;
  row[0] = 1.0;
  BasisRow slopes{};  // first derivatives of degree - 1
  BasisRow lower{};   // values of degree - 1
  for (int d = 1; d <= degree; ++d) {
    if (d == degree - 1 && order >= 2) slopes = derive(knots, span, d, row);
    if (d == degree) lower = row;
    raise_degree(knots, span, d, x, row);
  }
  basis.derivative[0] = row;
  if (order >= 1) basis.derivative[1] = derive(knots, span, degree, lower);
  if (order >= 2) basis.derivative[2] = degree >= 2 ? derive(knots, span, degree, slopes) : BasisRow{};
  return basis;
}

}  // namespace lamella
