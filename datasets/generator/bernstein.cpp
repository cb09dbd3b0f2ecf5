#include "datasets/generator/bernstein.h"

#include <cmath>

namespace lamella::datasets {
namespace {

using Coefficients = std::vector<double>;  ///< of a polynomial on [0, 1] in the Bernstein basis

double binomial(int n, int k) {
  double result = 1.0;
  for (int i = 1; i <= k; ++i) result = result * (n - k + i) / i;
  return std::round(result);
}

/// Product: c_k = sum_i C(m,i) C(n,k-i) a_i b_(k-i) / C(m+n,k).
Coefficients operator*(const Coefficients& a, const Coefficients& b) {
  const int m = static_cast<int>(a.size()) - 1, n = static_cast<int>(b.size()) - 1;
  Coefficients c(a.size() + b.size() - 1, 0.0);
  for (int i = 0; i <= m; ++i)
    for (int j = 0; j <= n; ++j) c[i + j] += binomial(m, i) * binomial(n, j) * a[i] * b[j];
  for (int k = 0; k <= m + n; ++k) c[k] /= binomial(m + n, k);
  return c;
}

Coefficients power(const Coefficients& a, int exponent) {
  Coefficients result{1.0};
  for (int i = 0; i < exponent; ++i) result = result * a;
  return result;
}

/// Homogeneous coordinate of a curve: weight times `offset + scale * coordinate`.
Coefficients homogeneous(const SplineCurve& curve, int axis, double offset = 0.0, double scale = 1.0) {
  Coefficients c;
  for (std::size_t i = 0; i < curve.poles.size(); ++i)
    c.push_back((curve.weights.empty() ? 1.0 : curve.weights[i]) * (offset + scale * curve.poles[i][axis]));
  return c;
}

Coefficients weights_of(const SplineCurve& curve) {
  return curve.weights.empty() ? Coefficients(curve.poles.size(), 1.0) : curve.weights;
}

SplineCurve from_homogeneous(const Coefficients& x, const Coefficients& y, const Coefficients& z, const Coefficients& w,
                             bool rational) {
  SplineCurve curve;
  curve.degree = static_cast<int>(w.size()) - 1;
  curve.knots = clamped_knots({0, 1}, curve.degree);
  for (std::size_t i = 0; i < w.size(); ++i) curve.poles.push_back({x[i] / w[i], y[i] / w[i], z[i] / w[i]});
  if (rational) curve.weights = w;
  return curve;
}

/// All products s^i (w - s)^(degree - i), times C(degree, i): the homogeneous Bernstein basis of a field's axis.
std::vector<Coefficients> basis(const SplineCurve& plan, int axis, double low, double high, int degree) {
  const double width = high - low;
  const Coefficients s = homogeneous(plan, axis, -low / width, 1 / width);
  const Coefficients rest = homogeneous(plan, axis, high / width, -1 / width);
  std::vector<Coefficients> result;
  for (int i = 0; i <= degree; ++i) {
    Coefficients term = power(s, i) * power(rest, degree - i);
    for (double& c : term) c *= binomial(degree, i);
    result.push_back(std::move(term));
  }
  return result;
}

}  // namespace

SplineCurve lift(const SplineCurve& plan, const SplineSurface& field) {
  const auto in_x = basis(plan, 0, field.knots_u.front(), field.knots_u.back(), field.degree_u);
  const auto in_y = basis(plan, 1, field.knots_v.front(), field.knots_v.back(), field.degree_v);
  const int total = field.degree_u + field.degree_v;
  Coefficients z(static_cast<std::size_t>(plan.degree) * total + 1, 0.0);
  for (std::size_t i = 0; i < in_x.size(); ++i) {
    for (std::size_t j = 0; j < in_y.size(); ++j) {
      const Coefficients term = in_x[i] * in_y[j];
      const double height = field.poles[i * field.count_v + j][2];
      for (std::size_t k = 0; k < z.size(); ++k) z[k] += height * term[k];
    }
  }
  const Coefficients w = weights_of(plan), others = power(w, total - 1);
  return from_homogeneous(homogeneous(plan, 0) * others, homogeneous(plan, 1) * others, z, w * others,
                          !plan.weights.empty());
}

SplineCurve over_parameter(const SplineCurve& lifted) {
  const Coefficients t{0, 1}, one{1, 1}, w = weights_of(lifted);
  const Coefficients raised = w * one;
  return from_homogeneous(w * t, homogeneous(lifted, 2) * one, Coefficients(raised.size(), 0.0), raised,
                          !lifted.weights.empty());
}

}  // namespace lamella::datasets
