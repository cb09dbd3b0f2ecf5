#include "model/height_net.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "model/de_casteljau.h"

namespace lamella {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kMaxCount = (kMaxDegree + 1) * (kMaxDegree + 1);
using NetBuffer = std::array<double, kMaxCount>;

double magnitude(const Interval& x) { return std::max(std::abs(x.lo), std::abs(x.hi)); }

Interval product(const Interval& a, const Interval& b) {
  const auto [lo, hi] = std::minmax({a.lo * b.lo, a.lo * b.hi, a.hi * b.lo, a.hi * b.hi});
  return {lo, hi};
}

Interval widened(const Interval& x, double by) { return {x.lo - by, x.hi + by}; }

/// Range of the coefficients of one derivative, `term(i, j)` its differences over i <= last_u, j <= last_v; zero where
/// the degree leaves none.
template <class Term>
Interval range_of(int last_u, int last_v, double factor, Term term) {
  if (last_u < 0 || last_v < 0) return {0.0, 0.0};
  Interval range{kInfinity, -kInfinity};
  for (int i = 0; i <= last_u; ++i) {
    for (int j = 0; j <= last_v; ++j) {
      const double x = term(i, j);
      range.lo = std::min(range.lo, x);
      range.hi = std::max(range.hi, x);
    }
  }
  return {factor * range.lo, factor * range.hi};
}

/// Bounds of the second derivatives of a polynomial net.
struct SecondDerivatives {
  Interval uu;
  Interval uv;
  Interval vv;
};

SecondDerivatives second_derivatives(const NetShape& shape, const double* net) {
  const int m = shape.degree_u;
  const int n = shape.degree_v;
  const int row = shape.stride();
  const auto at = [&](int i, int j) { return net + i * row + j; };
  return {range_of(m - 2, n, m * (m - 1.0),
                   [&](int i, int j) {
                     const double* p = at(i, j);
                     return p[2 * row] - 2.0 * p[row] + p[0];
                   }),
          range_of(m - 1, n - 1, static_cast<double>(m) * n,
                   [&](int i, int j) {
                     const double* p = at(i, j);
                     return (p[row + 1] - p[row]) - (p[1] - p[0]);
                   }),
          range_of(m, n - 2, n * (n - 1.0), [&](int i, int j) {
            const double* p = at(i, j);
            return p[2] - 2.0 * p[1] + p[0];
          })};
}

/// Bounds of the first derivatives' size.
Vec2 steepness(const NetShape& shape, const double* net) {
  const int m = shape.degree_u;
  const int n = shape.degree_v;
  const int row = shape.stride();
  const auto in_u = [&](int i, int j) { return net[(i + 1) * row + j] - net[i * row + j]; };
  const auto in_v = [&](int i, int j) { return net[i * row + j + 1] - net[i * row + j]; };
  return {magnitude(range_of(m - 1, n, m, in_u)), magnitude(range_of(m, n - 1, n, in_v))};
}

/// w (z - c) for a c in the middle of the range, so that what multiplies the weights' derivatives is small in a small
/// cell.
NetBuffer centred(const NetShape& shape, const double* net, const Interval& range) {
  NetBuffer buffer{};
  const double c = range.middle();
  const double* weight = net + shape.count();
  for (std::size_t i = 0; i < shape.count(); ++i) buffer[i] = net[i] - c * weight[i];
  return buffer;
}

/// steepness() of w (z - c).
Vec2 centred_steepness(const NetShape& shape, const double* net, double c) {
  const int m = shape.degree_u;
  const int n = shape.degree_v;
  const int row = shape.stride();
  const double* weight = net + shape.count();
  const auto difference = [&](int k, int step) { return net[k + step] - net[k] - c * (weight[k + step] - weight[k]); };
  return {magnitude(range_of(m - 1, n, m, [&](int i, int j) { return difference(i * row + j, row); })),
          magnitude(range_of(m, n - 1, n, [&](int i, int j) { return difference(i * row + j, 1); }))};
}

/// Bounds of w times the second derivatives of g = G / w: w g_uu = G_uu - 2 w_u g_u - w_uu g and so on.
SecondDerivatives rational_second_derivatives(const NetShape& shape, const double* net, const Interval& range) {
  const NetBuffer numerator = centred(shape, net, range);
  const double* weight = net + shape.count();
  const double least = *std::min_element(weight, weight + shape.count());
  const double g = 0.5 * range.length();
  const Vec2 weight_slope = steepness(shape, weight);
  const Vec2 slope = (steepness(shape, numerator.data()) + g * weight_slope) / least;
  const SecondDerivatives w = second_derivatives(shape, weight);
  const SecondDerivatives n = second_derivatives(shape, numerator.data());
  return {widened(n.uu, 2.0 * weight_slope[0] * slope[0] + magnitude(w.uu) * g),
          widened(n.uv, weight_slope[0] * slope[1] + weight_slope[1] * slope[0] + magnitude(w.uv) * g),
          widened(n.vv, 2.0 * weight_slope[1] * slope[1] + magnitude(w.vv) * g)};
}

ThirdDerivatives polynomial_third(const NetShape& shape, const double* net) {
  const int m = shape.degree_u;
  const int n = shape.degree_v;
  const int row = shape.stride();
  const auto bend = [&](int at, int step) { return net[at + 2 * step] - 2.0 * net[at + step] + net[at]; };
  ThirdDerivatives third;
  third.signs_known = true;
  third.uuu = range_of(m - 3, n, m * (m - 1.0) * (m - 2.0),
                       [&](int i, int j) { return bend((i + 1) * row + j, row) - bend(i * row + j, row); });
  third.uuv = range_of(m - 2, n - 1, m * (m - 1.0) * n,
                       [&](int i, int j) { return bend(i * row + j + 1, row) - bend(i * row + j, row); });
  third.uvv = range_of(m - 1, n - 2, n * (n - 1.0) * m,
                       [&](int i, int j) { return bend((i + 1) * row + j, 1) - bend(i * row + j, 1); });
  third.vvv = range_of(m, n - 3, n * (n - 1.0) * (n - 2.0),
                       [&](int i, int j) { return bend(i * row + j + 1, 1) - bend(i * row + j, 1); });
  third.any = magnitude(third.uuu) + 3.0 * magnitude(third.uuv) + 3.0 * magnitude(third.uvv) + magnitude(third.vvv);
  return third;
}

/// Bounds of the derivatives of orders 1 to 3 along any directions with components up to 1.
struct DirectionalBounds {
  double first;
  double second;
  double third;
};

DirectionalBounds directional_bounds(const NetShape& shape, const double* net) {
  const SecondDerivatives h = second_derivatives(shape, net);
  return {steepness(shape, net).sum(), magnitude(h.uu) + 2.0 * magnitude(h.uv) + magnitude(h.vv),
          polynomial_third(shape, net).any};
}

/// Value, first and second derivative of a Bezier polynomial at `s`; overwrites the coefficients.
struct Taylor {
  double value;
  double slope;
  double bend;
};

Taylor reduce(double* p, int degree, double s) {
  const double r = 1.0 - s;
  for (int k = degree; k > 2; --k) {
    for (int i = 0; i < k; ++i) p[i] = r * p[i] + s * p[i + 1];
  }
  if (degree == 0) return {p[0], 0.0, 0.0};
  if (degree == 1) return {r * p[0] + s * p[1], p[1] - p[0], 0.0};
  const double a = r * p[0] + s * p[1];
  const double b = r * p[1] + s * p[2];
  return {r * a + s * b, degree * (b - a), degree * (degree - 1.0) * ((p[2] - p[1]) - (p[1] - p[0]))};
}

HeightJet polynomial_jet(const NetShape& shape, const double* net, double s, double t) {
  std::array<std::array<double, kMaxDegree + 1>, 3> columns;
  std::array<double, kMaxDegree + 1> work;
  for (int i = 0; i <= shape.degree_u; ++i) {
    std::copy_n(net + i * shape.stride(), shape.stride(), work.data());
    const Taylor row = reduce(work.data(), shape.degree_v, t);
    columns[0][i] = row.value;
    columns[1][i] = row.slope;
    columns[2][i] = row.bend;
  }
  const Taylor value = reduce(columns[0].data(), shape.degree_u, s);
  const Taylor slope = reduce(columns[1].data(), shape.degree_u, s);
  const Taylor bend = reduce(columns[2].data(), shape.degree_u, s);
  return {value.value, value.slope, slope.value, value.bend, slope.slope, bend.value};
}

}  // namespace

Interval height_range(const NetShape& shape, const double* net) {
  Interval range{kInfinity, -kInfinity};
  const double* weight = net + shape.count();
  for (std::size_t i = 0; i < shape.count(); ++i) {
    const double z = shape.rational ? net[i] / weight[i] : net[i];
    range.lo = std::min(range.lo, z);
    range.hi = std::max(range.hi, z);
  }
  return range;
}

bool keeps_sign(const NetShape& shape, const double* net, bool along_u, const Interval& range, double slack) {
  const int step = along_u ? shape.stride() : 1;
  const int last_u = shape.degree_u - (along_u ? 1 : 0);
  const int last_v = shape.degree_v - (along_u ? 0 : 1);
  const double* weight = net + shape.count();
  const double c = range.middle();
  Interval slope{kInfinity, -kInfinity};
  double weight_step = 0.0;
  for (int i = 0; i <= last_u; ++i) {
    for (int j = 0; j <= last_v; ++j) {
      const int k = i * shape.stride() + j;
      double d = net[k + step] - net[k];
      if (shape.rational) {
        const double dw = weight[k + step] - weight[k];
        weight_step = std::max(weight_step, std::abs(dw));
        d -= c * dw;
      }
      slope.lo = std::min(slope.lo, d);
      slope.hi = std::max(slope.hi, d);
    }
  }
  // The numerator of the derivative is w G' - G w' with G = w (z - c), so after division by w it is G' up to
  // |z - c| |w'|.
  const double margin = slack + 0.5 * range.length() * weight_step;
  return slope.lo > margin || slope.hi < -margin;
}

bool has_one_to_one_gradient(const NetShape& shape, const double* net, const Interval& range, double rounding) {
  SecondDerivatives h =
      shape.rational ? rational_second_derivatives(shape, net, range) : second_derivatives(shape, net);
  const double noise = 4.0 * rounding;
  h.uu = widened(h.uu, noise * shape.degree_u * shape.degree_u);
  h.uv = widened(h.uv, noise * shape.degree_u * shape.degree_v);
  h.vv = widened(h.vv, noise * shape.degree_v * shape.degree_v);
  // By the mean value theorem equal gradients at p and q make a matrix singular whose rows are those of the Hessian at
  // two places between p and q. Rows may be scaled by w there. That the Hessian itself is regular wouldn't be enough.
  const Interval diagonal = product(h.uu, h.vv);
  const Interval mixed = product(h.uv, h.uv);
  return diagonal.lo > mixed.hi || diagonal.hi < mixed.lo;
}

double ThirdDerivatives::along(const Vec2& axis) const {
  if (!signs_known) return any;
  const double a = axis[0];
  const double b = axis[1];
  const double factors[4] = {a * a * a, 3.0 * a * a * b, 3.0 * a * b * b, b * b * b};
  Interval sum;
  int k = 0;
  for (const Interval& term : {uuu, uuv, uvv, vvv}) {
    const double factor = factors[k++];
    sum.lo += std::min(factor * term.lo, factor * term.hi);
    sum.hi += std::max(factor * term.lo, factor * term.hi);
  }
  return magnitude(sum);
}

ThirdDerivatives third_derivatives(const NetShape& shape, const double* net, const Interval& range) {
  if (!shape.rational) return polynomial_third(shape, net);
  const DirectionalBounds n = directional_bounds(shape, centred(shape, net, range).data());
  const double* weight = net + shape.count();
  const DirectionalBounds w = directional_bounds(shape, weight);
  const double least = *std::min_element(weight, weight + shape.count());
  // Leibniz' rule on G = g w, solved for the derivatives of g in turn.
  const double g = 0.5 * range.length();
  const double first = (n.first + g * w.first) / least;
  const double second = (n.second + 2.0 * first * w.first + g * w.second) / least;
  ThirdDerivatives third;
  third.any = (n.third + 3.0 * second * w.first + 3.0 * first * w.second + g * w.third) / least;
  return third;
}

bool varies_more_in_u(const NetShape& shape, const double* net, const Interval& range) {
  const Vec2 slope = shape.rational ? centred_steepness(shape, net, range.middle()) : steepness(shape, net);
  return slope[0] >= slope[1];
}

void halve(const NetShape& shape, double* first, double* second, bool along_u) {
  std::copy_n(first, shape.doubles(), second);
  const int lines = along_u ? shape.stride() : shape.degree_u + 1;
  const int between = along_u ? 1 : shape.stride();
  for (std::size_t start = 0; start < shape.doubles(); start += shape.count()) {
    for (int k = 0; k < lines; ++k) {
      const std::size_t at = start + static_cast<std::size_t>(k) * between;
      split_in_place(first + at, second + at, along_u ? shape.degree_u : shape.degree_v, along_u ? shape.stride() : 1,
                     0.5);
    }
  }
}

HeightJet evaluate_jet(const NetShape& shape, const double* net, double s, double t) {
  const HeightJet n = polynomial_jet(shape, net, s, t);
  if (!shape.rational) return n;
  const HeightJet w = polynomial_jet(shape, net + shape.count(), s, t);
  HeightJet z;
  z.value = n.value / w.value;
  z.u = (n.u - w.u * z.value) / w.value;
  z.v = (n.v - w.v * z.value) / w.value;
  z.uu = (n.uu - 2.0 * w.u * z.u - w.uu * z.value) / w.value;
  z.uv = (n.uv - w.u * z.v - w.v * z.u - w.uv * z.value) / w.value;
  z.vv = (n.vv - 2.0 * w.v * z.v - w.vv * z.value) / w.value;
  return z;
}

}  // namespace lamella
