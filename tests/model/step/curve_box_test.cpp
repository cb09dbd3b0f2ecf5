#include "model/step/curve_box.h"

#include <gtest/gtest.h>
#include <random>

#include "model/evaluate.h"

namespace lamella::step {
namespace {

/// The box holds every point of the curve, and is at most `slack` of its size too large.
void expect_box(const Curve2& curve, const Interval& range, double slack) {
  const Box2 box = curve_box(curve, range);
  Box2 exact;
  for (int i = 0; i <= 2000; ++i) exact.extend(evaluate<2>(curve, range.lo + range.length() * i / 2000.0).point);
  const double tiny = 1e-9 * (1.0 + exact.sizes().norm());
  for (int k = 0; k < 2; ++k) {
    EXPECT_LE(box.min()[k], exact.min()[k] + tiny);
    EXPECT_GE(box.max()[k], exact.max()[k] - tiny);
    EXPECT_LE(box.sizes()[k], exact.sizes()[k] + slack * exact.sizes().norm() + tiny);
  }
}

TEST(CurveBox, IsExactForLinesAndEllipses) {
  expect_box(Line<2>{{1, 2}, {3, -4}}, {-1, 2}, 0.0);
  const Ellipse<2> ellipse{{1, 1}, {2, 0.5}, {-0.3, 1}};
  for (const Interval range :
       {Interval{0, 1}, Interval{-0.5, 4}, Interval{5, 9}, Interval{-20, -13}, Interval{3, 3.01}}) {
    expect_box(ellipse, range, 1e-5);
  }
}

TEST(CurveBox, HoldsParabolasAndHyperbolas) {
  expect_box(Parabola<2>{{0, 1}, {1, 0.2}, {0.1, 2}}, {-1, 3}, 1.0);
  expect_box(Hyperbola<2>{{0, 1}, {1, 0.2}, {0.1, 2}}, {-1, 2}, 1.0);
}

TEST(CurveBox, HoldsAnyPartOfASpline) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 200; ++i) {
    BSplineCurve<2> curve{3, {0, 0, 0, 0, 0.25, 0.5, 0.5, 1, 1, 1, 1}, {}, {}};
    for (int k = 0; k < 7; ++k) curve.poles.emplace_back(uniform(random), uniform(random));
    if (i % 2 == 1) {
      for (int k = 0; k < 7; ++k) curve.weights.push_back(1.5 + uniform(random));
    }
    double lo = 0.5 + 0.5 * uniform(random);
    double hi = 0.5 + 0.5 * uniform(random);
    if (i % 5 == 0) lo = 0.25;
    if (i % 7 == 0) hi = 0.5;
    expect_box(curve, {std::min(lo, hi), std::max(lo, hi)}, 2.0);
    expect_box(curve, {0, 1}, 2.0);
  }
}

}  // namespace
}  // namespace lamella::step
