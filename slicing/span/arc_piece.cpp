#include "slicing/span/arc_piece.h"

#include <algorithm>
#include <limits>

namespace lamella::span {

namespace {

/// Share of a cell by which a piece may bulge over its limit: rounding only. By less than the accuracy is too much next
/// to a saddle on a crease, where arcs that go on within the cell and arcs that leave it lie as near as that.
constexpr double kBulge = 1e-10;

/// Value, first and second derivative at one end of a piece.
struct EndData {
  Vec2 value;
  Vec2 slope;
  Vec2 bend;
};

/// Derivatives by t = w . (u, v) / span from those by arc length, in the plane and in (u, v).
struct End {
  EndData xy;
  EndData uv;
  double rate = 0.0;  ///< dt / ds
};

End end_of(const SectionPoint& p, const Vec2& weight, double span) {
  End end;
  const double rate = weight.dot(p.uv_slope) / span;
  const double drift = weight.dot(p.uv_bend) / span / rate;
  const double per_rate = 1.0 / rate;
  const double square = per_rate * per_rate;
  const Vec2 normal(-p.tangent.y(), p.tangent.x());
  end.xy = {p.xy, p.tangent * per_rate, (p.curvature * normal - drift * p.tangent) * square};
  end.uv = {p.uv, p.uv_slope * per_rate, (p.uv_bend - drift * p.uv_slope) * square};
  end.rate = rate;
  return end;
}

/// Coefficients of the quintic with the given end data along one axis.
std::array<double, 6> quintic(const EndData& a, const EndData& b, int axis) {
  const double p = a.value[axis];
  const double d = a.slope[axis];
  const double h = 0.5 * a.bend[axis];
  const double rest = b.value[axis] - p - d - h;
  const double slope_rest = b.slope[axis] - d - 2.0 * h;
  const double bend_rest = b.bend[axis] - 2.0 * h;
  return {p,
          d,
          h,
          10.0 * rest - 4.0 * slope_rest + 0.5 * bend_rest,
          -15.0 * rest + 7.0 * slope_rest - bend_rest,
          6.0 * rest - 3.0 * slope_rest + 0.5 * bend_rest};
}

double slope_at(const std::array<double, 6>& c, double t) {
  return c[1] + t * (2.0 * c[2] + t * (3.0 * c[3] + t * (4.0 * c[4] + t * 5.0 * c[5])));
}

double bend_at(const std::array<double, 6>& c, double t) {
  return 2.0 * c[2] + t * (6.0 * c[3] + t * (12.0 * c[4] + t * 20.0 * c[5]));
}

ArcPiece joined(const EndData& a, const EndData& b) { return {quintic(a, b, 0), quintic(a, b, 1)}; }

Vec2 chord_weight(const SectionPoint& a, const SectionPoint& b) {
  const Vec2 step = b.uv - a.uv;
  const double e = 0.5 * (a.metric[0] + b.metric[0]);
  const double f = 0.5 * (a.metric[1] + b.metric[1]);
  const double g = 0.5 * (a.metric[2] + b.metric[2]);
  return {e * step[0] + f * step[1], f * step[0] + g * step[1]};
}

/// Bernstein coefficients on [0, 1].
std::array<double, 6> bernstein(const std::array<double, 6>& c) {
  return {c[0],
          c[0] + c[1] / 5.0,
          c[0] + 2.0 / 5.0 * c[1] + c[2] / 10.0,
          c[0] + 3.0 / 5.0 * c[1] + 3.0 / 10.0 * c[2] + c[3] / 10.0,
          c[0] + 4.0 / 5.0 * c[1] + 3.0 / 5.0 * c[2] + 2.0 / 5.0 * c[3] + c[4] / 5.0,
          c[0] + c[1] + c[2] + c[3] + c[4] + c[5]};
}

/// Whether a polynomial stays within a range; halved at most `depth` times to see it.
bool stays_in(std::array<double, 6> net, const Interval& range, int depth) {
  const auto [lowest, highest] = std::minmax_element(net.begin(), net.end());
  if (*lowest >= range.lo && *highest <= range.hi) return true;
  if (depth == 0) return false;
  std::array<double, 6> front;
  for (std::size_t n = 0; n < net.size(); ++n) {
    front[n] = net[0];
    for (std::size_t i = 0; i + 1 + n < net.size(); ++i) net[i] = 0.5 * (net[i] + net[i + 1]);
  }
  return stays_in(front, range, depth - 1) && stays_in(net, range, depth - 1);
}

/// The parameter must run forward at both ends at a rate near the mean, or the quintic overshoots.
bool is_even(const End& a, const End& b, double length) {
  constexpr double kSlowest = 0.4;
  constexpr double kFastest = 2.5;
  const double first = a.rate * length;
  const double second = b.rate * length;
  return first > kSlowest && first < kFastest && second > kSlowest && second < kFastest;
}

}  // namespace

Vec2 ArcPiece::slope(double t) const { return {slope_at(x, t), slope_at(y, t)}; }

Vec2 ArcPiece::bend(double t) const { return {bend_at(x, t), bend_at(y, t)}; }

ArcPiece straight_piece(const Vec2& a, const Vec2& b) {
  ArcPiece piece;
  piece.x = {a.x(), b.x() - a.x()};
  piece.y = {a.y(), b.y() - a.y()};
  return piece;
}

ArcPiece reversed(const ArcPiece& piece) {
  // c(1 - t): the Taylor coefficients about 1 with alternating signs.
  constexpr int kBinomial[6][6] = {{1, 1, 1, 1, 1, 1},  {0, 1, 2, 3, 4, 5}, {0, 0, 1, 3, 6, 10},
                                   {0, 0, 0, 1, 4, 10}, {0, 0, 0, 0, 1, 5}, {0, 0, 0, 0, 0, 1}};
  ArcPiece result;
  for (int k = 0; k < 6; ++k) {
    const double sign = k % 2 == 0 ? 1.0 : -1.0;
    for (int i = k; i < 6; ++i) {
      result.x[k] += sign * kBinomial[k][i] * piece.x[i];
      result.y[k] += sign * kBinomial[k][i] * piece.y[i];
    }
  }
  return result;
}

bool join_points(const SectionPoint& a, const SectionPoint& b, ArcPiece& piece, ArcPiece& uv) {
  const Vec2 weight = chord_weight(a, b);
  const double span = weight.dot(b.uv - a.uv);
  if (!(span > 0.0)) return false;
  const End from = end_of(a, weight, span);
  const End to = end_of(b, weight, span);
  if (!is_even(from, to, (b.xy - a.xy).norm())) return false;
  piece = joined(from.xy, to.xy);
  uv = joined(from.uv, to.uv);
  return true;
}

bool stays_in_cell(const SectionSurface& surface, const Cell& cell, const ArcPiece& uv) {
  if (!surface.is_divided()) return true;
  constexpr int kHalvings = 3;
  for (int axis = 0; axis < 2; ++axis) {
    const bool below = surface.has_neighbor(cell, axis, false);
    const bool above = surface.has_neighbor(cell, axis, true);
    if (!below && !above) continue;
    Interval range = surface.limits(cell, axis);
    const double slack = kBulge * range.length();
    range.lo = below ? range.lo - slack : -std::numeric_limits<double>::infinity();
    range.hi = above ? range.hi + slack : std::numeric_limits<double>::infinity();
    if (!stays_in(bernstein(axis == 0 ? uv.x : uv.y), range, kHalvings)) return false;
  }
  return true;
}

PieceFit fit_piece(const SectionSurface& surface, const Cell& cell, const SectionPoint& a, const SectionPoint& b) {
  PieceFit fit;
  fit.error = std::numeric_limits<double>::infinity();
  fit.weight = chord_weight(a, b);
  ArcPiece uv;
  if (!join_points(a, b, fit.piece, uv) || !stays_in_cell(surface, cell, uv)) return fit;
  const Vec2 aside(-fit.weight[1], fit.weight[0]);
  const std::size_t count = surface.crosses_knot(a.uv, b.uv, cell) ? kMeasured.size() : 1;
  double error = std::abs(b.z - a.z);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = kMeasured[i];
    const SurfacePoint at = surface.evaluate_slopes(uv.at(t), cell);
    // Back to the height of the section without a change of the parameter.
    const Vec3 move = at.du * aside[0] + at.dv * aside[1];
    const double amount = (a.z - at.point.z()) / move.z();
    const double off = (fit.piece.at(t) - at.point.head<2>() - amount * move.head<2>()).norm();
    if (!(off <= error)) error = off;  // keeps NaN
  }
  if (error <= 0.1 * (b.xy - a.xy).norm()) fit.error = error;  // not for NaN
  return fit;
}

Vec2 uv_at(const PieceFit& fit, const SectionPoint& a, const SectionPoint& b, double t) {
  const double span = fit.weight.dot(b.uv - a.uv);
  return joined(end_of(a, fit.weight, span).uv, end_of(b, fit.weight, span).uv).at(t);
}

}  // namespace lamella::span
