// Outlines in the plan.
#include <cmath>
#include <numbers>

#include "datasets/generator/terrace.h"

namespace lamella::datasets {
namespace {

constexpr double kPi = std::numbers::pi;

Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

Point meeting(const Point& a, const Point& along_a, const Point& b, const Point& along_b) {
  const double det = along_a[0] * along_b[1] - along_a[1] * along_b[0];
  const double s = ((b[0] - a[0]) * along_b[1] - (b[1] - a[1]) * along_b[0]) / det;
  return {a[0] + s * along_a[0], a[1] + s * along_a[1], 0};
}

Point polar(double r, double angle) { return {r * std::cos(angle), r * std::sin(angle), 0}; }

/// Circular arc about the origin, less than half a turn.
SplineCurve arc(double r, double from, double to) {
  const double half = 0.5 * (to - from);
  return conic(polar(r, from), polar(r / std::cos(half), from + half), polar(r, to), std::cos(half));
}

}  // namespace

SplineCurve conic(const Point& a, const Point& b, const Point& c, double weight) {
  SplineCurve curve{2, {0, 0, 0, 1, 1, 1}, {a, b, c}, {}};
  if (weight != 1.0) curve.weights = {1, weight, 1};
  return curve;
}

Plan circle_plan(double x, double y, double radius) {
  Plan plan;
  for (int i = 0; i < 3; ++i) plan.push_back(arc(radius, 2 * kPi / 3 * i, 2 * kPi / 3 * (i + 1)));
  for (SplineCurve& curve : plan)
    for (Point& p : curve.poles) p = {p[0] + x, p[1] + y, 0};
  for (int i = 0; i < 3; ++i) plan[i].poles[2] = plan[(i + 1) % 3].poles[0];
  return plan;
}

Plan squircle(const Squircle& s) {
  struct SideOf {
    Point begin, middle, end;
  };
  const double cx = s.half_x - s.corner, cy = s.half_y - s.corner, hx = s.half_x, hy = s.half_y, b = 2 * s.bulge;
  const double x = s.x, y = s.y;
  // Counter-clockwise: bottom, right, top, left.
  const std::array<SideOf, 4> sides{{{{x - cx, y - hy, 0}, {x, y - hy - b, 0}, {x + cx, y - hy, 0}},
                                     {{x + hx, y - cy, 0}, {x + hx + b, y, 0}, {x + hx, y + cy, 0}},
                                     {{x + cx, y + hy, 0}, {x, y + hy + b, 0}, {x - cx, y + hy, 0}},
                                     {{x - hx, y + cy, 0}, {x - hx - b, y, 0}, {x - hx, y - cy, 0}}}};
  Plan plan;
  for (std::size_t i = 0; i < 4; ++i) {
    const SideOf& side = sides[i];
    const SideOf& next = sides[(i + 1) % 4];
    plan.push_back(conic(side.begin, side.middle, side.end));
    const Point tip = meeting(side.end, minus(side.end, side.middle), next.begin, minus(next.middle, next.begin));
    plan.push_back(conic(side.end, tip, next.begin, s.corner_weight));
  }
  return plan;
}

Plan eye(double x, double y, double half_length, double half_width, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const auto at = [&](double along, double across) {
    return Point{x + along * c - across * s, y + along * s + across * c, 0};
  };
  return {conic(at(-half_length, 0), at(0, -2 * half_width), at(half_length, 0)),
          conic(at(half_length, 0), at(0, 2 * half_width), at(-half_length, 0))};
}

Plan kidney(double r0, double r1, double angle0, double angle1) {
  const SplineCurve outside = arc(r1, angle0, angle1), inside = arc(r0, angle1, angle0);
  const double middle = 0.5 * (r0 + r1), reach = 0.5 * (r1 - r0) / middle;
  const auto end = [&](const SplineCurve& from, const SplineCurve& to, double angle) {
    return conic(from.poles[2], polar(middle, angle), to.poles[0], 0.8);
  };
  return {outside, end(outside, inside, angle1 + 2 * reach), inside, end(inside, outside, angle0 - 2 * reach)};
}

}  // namespace lamella::datasets
