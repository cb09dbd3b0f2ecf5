#include "model/rational_curve.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "model/bspline.h"
#include "model/de_casteljau.h"

namespace lamella {
namespace {

using Map = RationalForm::Map;

/// cosh and sinh beyond this leave the range of doubles.
constexpr double kMaxHyperbolic = 700.0;
/// Parameters beyond this are placeholders for infinity, not geometry.
constexpr double kMaxParameter = 1e10;

constexpr double kLongestArc = 0.5 * kPi;
constexpr double kLongestHyperbola = 1.0;

void check_range(Interval range) {
  if (std::abs(range.lo) <= kMaxParameter && std::abs(range.hi) <= kMaxParameter) return;
  throw GeometryError(
      "parameters from " + std::to_string(range.lo) + " to " + std::to_string(range.hi) + " are infinite or too large",
      {}, "trim the surface or curve to its finite part");
}

template <int Dim>
Vec<Dim + 1> homogeneous(const Vec<Dim>& point, double weight = 1.0) {
  Vec<Dim + 1> result;
  result << weight * point, weight;
  return result;
}

template <int Dim>
RationalCurve<Dim> convert(const Line<Dim>& line, Interval range) {
  RationalCurve<Dim> result;
  result.pieces.push_back({range,
                           range,
                           {homogeneous<Dim>(line.origin + range.lo * line.direction),
                            homogeneous<Dim>(line.origin + range.hi * line.direction)}});
  return result;
}

template <int Dim>
RationalCurve<Dim> convert(const Parabola<Dim>& p, Interval range) {
  // Polar form of apex + t^2 axis + t tangent at (lo, lo), (lo, hi), (hi, hi).
  const auto polar = [&](double a, double b) -> Vec<Dim + 1> {
    return homogeneous<Dim>(p.apex + (a * b) * p.axis + (0.5 * (a + b)) * p.tangent);
  };
  RationalCurve<Dim> result;
  result.pieces.push_back(
      {range, range, {polar(range.lo, range.lo), polar(range.lo, range.hi), polar(range.hi, range.hi)}});
  return result;
}

/// Ellipse and hyperbola alike: center + c(t) major + s(t) minor in pieces between the breaks.
template <int Dim, class Conic>
RationalCurve<Dim> convert_conic(const Conic& conic, Map map, std::vector<double> breaks,
                                 UnitArc (*arc_of)(double, double)) {
  RationalCurve<Dim> result;
  result.map = map;
  for (std::size_t i = 1; i < breaks.size(); ++i) {
    const UnitArc arc = arc_of(breaks[i - 1], breaks[i]);
    RationalPiece<Dim> piece{{static_cast<double>(i - 1), static_cast<double>(i)}, {breaks[i - 1], breaks[i]}, {}};
    for (int k = 0; k < 3; ++k) {
      Vec<Dim + 1> point;
      point << arc.weight[k] * conic.center + arc.cosine[k] * conic.major + arc.sine[k] * conic.minor, arc.weight[k];
      piece.net.push_back(point);
    }
    result.pieces.push_back(std::move(piece));
  }
  result.breaks = std::move(breaks);
  return result;
}

template <int Dim>
RationalCurve<Dim> convert(const Ellipse<Dim>& ellipse, Interval range) {
  return convert_conic<Dim>(ellipse, Map::angle, even_breaks(range, kLongestArc), unit_arc);
}

template <int Dim>
RationalCurve<Dim> convert(const Hyperbola<Dim>& hyperbola, Interval range) {
  if (std::max(std::abs(range.lo), std::abs(range.hi)) > kMaxHyperbolic) {
    throw GeometryError("a hyperbola with a parameter beyond 700, where cosh overflows");
  }
  return convert_conic<Dim>(hyperbola, Map::hyperbola, even_breaks(range, kLongestHyperbola), unit_hyperbola_arc);
}

/// Cuts the piece's ends off where they stick out of `range`.
template <int Dim>
void clip(RationalPiece<Dim>& piece, Interval range) {
  const int degree = static_cast<int>(piece.net.size()) - 1;
  auto other = piece.net;
  if (range.lo > piece.s.lo) {
    split_in_place(other.data(), piece.net.data(), degree, 1, (range.lo - piece.s.lo) / piece.s.length());
    piece.s.lo = range.lo;
  }
  other = piece.net;
  if (range.hi < piece.s.hi) {
    split_in_place(piece.net.data(), other.data(), degree, 1, (range.hi - piece.s.lo) / piece.s.length());
    piece.s.hi = range.hi;
  }
  piece.t = piece.s;
}

template <int Dim>
RationalCurve<Dim> convert(const BSplineCurve<Dim>& curve, Interval range) {
  check_limits(curve);
  const int degree = curve.degree;
  const BSplineCurve<Dim> fine = refine(curve, bezier_knots(curve.knots, degree));
  RationalCurve<Dim> result;
  for (std::size_t span = degree; span < fine.poles.size(); ++span) {
    RationalPiece<Dim> piece{{fine.knots[span], fine.knots[span + 1]}, {}, {}};
    if (piece.s.length() == 0.0 || piece.s.hi <= range.lo || piece.s.lo >= range.hi) continue;
    for (std::size_t i = span - degree; i <= span; ++i) {
      piece.net.push_back(homogeneous<Dim>(fine.poles[i], fine.weights.empty() ? 1.0 : fine.weights[i]));
    }
    clip(piece, range);
    result.pieces.push_back(std::move(piece));
  }
  return result;
}

/// tan or tanh of half of the distance from a piece's begin, where `q` is the same of a quarter of its length.
/// With r the rational parameter, the (hyperbolic) tangent measured from the middle is q (2 r - 1); the addition
/// theorem moves it to the begin, so that nothing cancels near the ends.
double tangent_at(Map map, double q, double r) {
  const double bend = q * q * (2.0 * r - 1.0);
  return 2.0 * q * r / (map == Map::angle ? 1.0 - bend : 1.0 + bend);
}

double ratio_at(Map map, double q, double tangent) {
  const double sign = map == Map::angle ? 1.0 : -1.0;
  return tangent * (1.0 + sign * q * q) / (2.0 * q * (1.0 + sign * tangent * q));
}

double quarter_tangent(Map map, double length) {
  return map == Map::angle ? std::tan(0.25 * length) : std::tanh(0.25 * length);
}

double half_tangent(Map map, double distance) {
  return map == Map::angle ? std::tan(0.5 * distance) : std::tanh(0.5 * distance);
}

double distance_at(Map map, double q, double r) {
  const double tangent = tangent_at(map, q, r);
  return 2.0 * (map == Map::angle ? std::atan(tangent) : std::atanh(tangent));
}

}  // namespace

std::vector<double> even_breaks(Interval range, double longest) {
  check_range(range);
  if (!(range.length() > 0.0)) return {};
  // A range of n pieces computed in doubles may come out a few ulp longer.
  const double pieces = std::max(1.0, std::ceil(range.length() / longest * (1.0 - 1e-15)));
  if (pieces > kMaxPieces) {
    throw GeometryError("parameters from " + std::to_string(range.lo) + " to " + std::to_string(range.hi) +
                        " turn more often than can be computed with");
  }
  std::vector<double> breaks;
  for (double i = 0.0; i < pieces; ++i) breaks.push_back(range.lo + range.length() * (i / pieces));
  breaks.push_back(range.hi);
  return breaks;
}

UnitArc unit_arc(double begin, double end) {
  const double middle = 0.5 * (begin + end);
  const double weight = std::cos(0.5 * (end - begin));
  return {{std::cos(begin), std::cos(middle), std::cos(end)},
          {std::sin(begin), std::sin(middle), std::sin(end)},
          {1.0, weight, 1.0}};
}

UnitArc unit_hyperbola_arc(double begin, double end) {
  const double middle = 0.5 * (begin + end);
  const double weight = std::cosh(0.5 * (end - begin));
  return {{std::cosh(begin), std::cosh(middle), std::cosh(end)},
          {std::sinh(begin), std::sinh(middle), std::sinh(end)},
          {1.0, weight, 1.0}};
}

double parameter_at(Map map, const std::vector<double>& breaks, double s) {
  if (map == Map::same || breaks.size() < 2) return s;
  const double piece = std::clamp(std::floor(s), 0.0, static_cast<double>(breaks.size() - 2));
  const double begin = breaks[static_cast<std::size_t>(piece)];
  const double end = breaks[static_cast<std::size_t>(piece) + 1];
  const double r = s - piece;
  const double q = quarter_tangent(map, end - begin);
  // Measured from the nearer end: exact there.
  return r <= 0.5 ? begin + distance_at(map, q, r) : end - distance_at(map, q, 1.0 - r);
}

double net_parameter_at(Map map, const std::vector<double>& breaks, double t) {
  if (map == Map::same || breaks.size() < 2) return t;
  const auto above = std::upper_bound(breaks.begin() + 1, breaks.end() - 1, t);
  const auto index = static_cast<std::size_t>(above - breaks.begin()) - 1;
  const double begin = breaks[index];
  const double end = breaks[index + 1];
  const double q = quarter_tangent(map, end - begin);
  const bool nearer_begin = t - begin <= end - t;
  const double r = ratio_at(map, q, half_tangent(map, nearer_begin ? t - begin : end - t));
  return static_cast<double>(index) + (nearer_begin ? r : 1.0 - r);
}

template <int Dim>
RationalCurve<Dim> rational_curve(const Curve<Dim>& curve, Interval range) {
  check_range(range);
  if (!(range.length() > 0.0)) return {};
  RationalCurve<Dim> result = std::visit([&](const auto& shape) { return convert(shape, range); }, curve);
  for (const RationalPiece<Dim>& piece : result.pieces) {
    for (const Vec<Dim + 1>& point : piece.net) {
      if (!point.allFinite()) throw GeometryError("a curve whose coordinates are not finite numbers");
    }
  }
  return result;
}

template RationalCurve<2> rational_curve<2>(const Curve2&, Interval);
template RationalCurve<3> rational_curve<3>(const Curve3&, Interval);

}  // namespace lamella
