#include "model/curve_extrema.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <type_traits>

#include "model/bernstein_roots.h"
#include "model/bspline.h"
#include "model/evaluate.h"

namespace lamella {

namespace {

/// Numerator coefficients (w f) and weights w of one Bezier piece of the function f = direction . C.
struct Piece {
  std::vector<double> numerator;
  std::vector<double> weight;
};

double binomial(int n, int k) {
  double value = 1.0;
  for (int i = 1; i <= k; ++i) value = value * (n - k + i) / i;
  return value;
}

/// Bernstein coefficients of a(t) b(t).
std::vector<double> product(const std::vector<double>& a, const std::vector<double>& b) {
  const int m = static_cast<int>(a.size()) - 1;
  const int n = static_cast<int>(b.size()) - 1;
  std::vector<double> c(m + n + 1, 0.0);
  for (int i = 0; i <= m; ++i) {
    for (int j = 0; j <= n; ++j) c[i + j] += binomial(m, i) * binomial(n, j) * a[i] * b[j];
  }
  for (int k = 0; k <= m + n; ++k) c[k] /= binomial(m + n, k);
  return c;
}

std::vector<double> derivative(const std::vector<double>& a) {
  std::vector<double> slope;
  for (std::size_t i = 0; i + 1 < a.size(); ++i) slope.push_back((a[i + 1] - a[i]) * static_cast<double>(a.size() - 1));
  return slope;
}

double largest(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

/// Roots in (0, 1) of the derivative of numerator / weight.
std::vector<double> stationary(const Piece& piece, bool rational) {
  std::vector<double> slope = derivative(piece.numerator);
  double scale = largest(piece.numerator);
  if (rational) {
    std::vector<double> left = product(slope, piece.weight);
    const std::vector<double> right = product(piece.numerator, derivative(piece.weight));
    for (std::size_t i = 0; i < left.size(); ++i) left[i] -= right[i];
    slope = std::move(left);
    scale *= largest(piece.weight);
  }
  // Differences of coefficients carry rounding of the coefficients' own size.
  return bernstein_roots(slope, 0.1 * scale);
}

bool may_leave(const Piece& piece, const Interval& known) {
  for (std::size_t i = 0; i < piece.numerator.size(); ++i) {
    if (!known.contains(piece.numerator[i] / piece.weight[i])) return true;
  }
  return false;
}

/// The curve as Bezier pieces; knots[piece] are its ends.
struct BezierPieces {
  std::vector<Piece> pieces;
  std::vector<Interval> ranges;
};

BezierPieces to_pieces(const BSplineCurve<3>& curve, const Vec3& direction) {
  const BSplineCurve<3> fine = refine(curve, bezier_knots(curve.knots, curve.degree));
  BezierPieces result;
  const int degree = fine.degree;
  const int count = static_cast<int>(fine.poles.size());
  for (int span = degree; span < count; ++span) {
    if (!(fine.knots[span] < fine.knots[span + 1])) continue;
    Piece piece;
    for (int i = span - degree; i <= span; ++i) {
      const double w = fine.weights.empty() ? 1.0 : fine.weights[i];
      piece.numerator.push_back(w * direction.dot(fine.poles[i]));
      piece.weight.push_back(w);
    }
    result.pieces.push_back(std::move(piece));
    result.ranges.push_back({fine.knots[span], fine.knots[span + 1]});
  }
  return result;
}

std::vector<double> critical(const BSplineCurve<3>& curve, Interval range, const Vec3& direction,
                             const Interval* known) {
  std::vector<double> found;
  const BezierPieces bezier = to_pieces(curve, direction);
  for (std::size_t i = 0; i < bezier.pieces.size(); ++i) {
    const Interval& t = bezier.ranges[i];
    if (t.hi < range.lo || t.lo > range.hi) continue;
    // Ends of pieces are knots, where the curve may have a corner.
    found.push_back(t.lo);
    if (known != nullptr && !may_leave(bezier.pieces[i], *known)) continue;
    for (const double s : stationary(bezier.pieces[i], !curve.weights.empty())) found.push_back(t.lo + s * t.length());
  }
  return found;
}

/// Solutions of a cos t + b sin t extremal.
std::vector<double> critical_angles(double a, double b, Interval range) {
  std::vector<double> found;
  if (!(std::hypot(a, b) > 0.0) || !std::isfinite(range.length())) return found;
  const double first = std::atan2(b, a);
  const double start = std::ceil((range.lo - first) / kPi);
  for (int k = 0; k < 64; ++k) {
    const double t = first + (start + k) * kPi;
    if (!(t <= range.hi)) break;
    found.push_back(t);
  }
  return found;
}

}  // namespace

std::vector<double> critical_parameters(const Curve3& curve, Interval range, const Vec3& direction,
                                        const Interval* known) {
  std::vector<double> found = std::visit(
      [&](const auto& c) -> std::vector<double> {
        using T = std::decay_t<decltype(c)>;
        if constexpr (std::is_same_v<T, Line<3>>) {
          return {};
        } else if constexpr (std::is_same_v<T, Ellipse<3>>) {
          return critical_angles(direction.dot(c.major), direction.dot(c.minor), range);
        } else if constexpr (std::is_same_v<T, Parabola<3>>) {
          return {-0.5 * direction.dot(c.tangent) / direction.dot(c.axis)};
        } else if constexpr (std::is_same_v<T, Hyperbola<3>>) {
          return {std::atanh(-direction.dot(c.minor) / direction.dot(c.major))};
        } else {
          return critical(c, range, direction, known);
        }
      },
      curve);
  // Also drops what isn't a number: no extremum.
  std::erase_if(found, [&](double t) { return !(t > range.lo && t < range.hi); });
  return found;
}

Box3 exact_bounds(const Curve3& curve, Interval range) {
  Box3 box(evaluate<3>(curve, range.lo).point);
  box.extend(evaluate<3>(curve, range.hi).point);
  for (int axis = 0; axis < 3; ++axis) {
    const Interval known{box.min()[axis], box.max()[axis]};
    for (const double t : critical_parameters(curve, range, Vec3::Unit(axis), &known)) {
      const double value = evaluate<3>(curve, t).point[axis];
      box.min()[axis] = std::min(box.min()[axis], value);
      box.max()[axis] = std::max(box.max()[axis], value);
    }
  }
  return box;
}

}  // namespace lamella
