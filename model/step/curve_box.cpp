#include "model/step/curve_box.h"

#include <algorithm>
#include <cmath>

#include "model/bspline.h"

namespace lamella::step {
namespace {

/// Range of a cos t + b sin t over `range`.
Interval trigonometric_range(double a, double b, const Interval& range) {
  const auto value = [a, b](double t) { return a * std::cos(t) + b * std::sin(t); };
  Interval result{std::min(value(range.lo), value(range.hi)), std::max(value(range.lo), value(range.hi))};
  const double crest = std::atan2(b, a);
  const double amplitude = std::hypot(a, b);
  const auto reaches = [&range](double t) { return t + kTwoPi * std::ceil((range.lo - t) / kTwoPi) <= range.hi; };
  if (reaches(crest)) result.hi = amplitude;
  if (reaches(crest + kPi)) result.lo = -amplitude;
  return result;
}

Box2 box_of(const Line<2>& line, const Interval& range) {
  Box2 box(Vec2(line.origin + range.lo * line.direction));
  return box.extend(Vec2(line.origin + range.hi * line.direction));
}

Box2 box_of(const Ellipse<2>& ellipse, const Interval& range) {
  const Interval x = trigonometric_range(ellipse.major.x(), ellipse.minor.x(), range);
  const Interval y = trigonometric_range(ellipse.major.y(), ellipse.minor.y(), range);
  return {ellipse.center + Vec2{x.lo, y.lo}, ellipse.center + Vec2{x.hi, y.hi}};
}

/// A piece of a conic lies in the triangle of its ends and the meeting point of its end tangents.
Box2 box_of(const Parabola<2>& c, const Interval& range) {
  const auto blossom = [&c](double s, double t) -> Vec2 { return c.apex + s * t * c.axis + 0.5 * (s + t) * c.tangent; };
  Box2 box(blossom(range.lo, range.lo));
  return box.extend(blossom(range.lo, range.hi)).extend(blossom(range.hi, range.hi));
}

Box2 box_of(const Hyperbola<2>& c, const Interval& range) {
  const auto point = [&c](double t) -> Vec2 { return c.center + std::cosh(t) * c.major + std::sinh(t) * c.minor; };
  const double middle = range.middle();
  const Vec2 apex =
      c.center + (std::cosh(middle) * c.major + std::sinh(middle) * c.minor) / std::cosh(0.5 * range.length());
  Box2 box(point(range.lo));
  return box.extend(apex).extend(point(range.hi));
}

Box2 box_of(const BSplineCurve<2>& curve, const Interval& range) {
  const double first = curve.knots.front();
  const double last = curve.knots.back();
  const double lo = std::clamp(range.lo, first, last);
  const double hi = std::clamp(range.hi, first, last);
  const auto raise = [&curve](std::vector<double>& knots, double t) {
    const auto present = std::count(curve.knots.begin(), curve.knots.end(), t);
    for (auto i = present; i < curve.degree; ++i) knots.push_back(t);
  };
  std::vector<double> added;
  raise(added, lo);
  if (hi > lo) raise(added, hi);
  const BSplineCurve<2> refined = refine(curve, added);
  // With multiplicity `degree` a knot's own pole is the last one whose support begins before it.
  const auto pole_at = [&refined](double t) {
    const auto above = std::lower_bound(refined.knots.begin(), refined.knots.end(), t) - refined.knots.begin();
    return std::clamp<std::ptrdiff_t>(above - 1, 0, static_cast<std::ptrdiff_t>(refined.poles.size()) - 1);
  };
  Box2 box;
  for (auto i = pole_at(lo); i <= pole_at(hi); ++i) box.extend(refined.poles[i]);
  return box;
}

}  // namespace

Box2 curve_box(const Curve2& curve, const Interval& range) {
  return std::visit([&range](const auto& c) { return box_of(c, range); }, curve);
}

}  // namespace lamella::step
