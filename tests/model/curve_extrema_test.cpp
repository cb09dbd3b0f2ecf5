#include "model/curve_extrema.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "model/evaluate.h"

namespace lamella {
namespace {

/// Box of many points of the curve: inside the exact bounds, and near them.
Box3 sampled(const Curve3& curve, Interval range) {
  Box3 box;
  constexpr int kSamples = 20000;
  for (int i = 0; i <= kSamples; ++i) {
    box.extend(evaluate<3>(curve, range.lo + range.length() * i / kSamples).point);
  }
  return box;
}

void expect_exact(const Curve3& curve, Interval range) {
  const Box3 exact = exact_bounds(curve, range);
  const Box3 dense = sampled(curve, range);
  const double size = dense.sizes().norm();
  // Between samples a smooth extremum rises by the square of half their distance at most.
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LE(exact.min()[axis], dense.min()[axis] + 1e-13 * size);
    EXPECT_GE(exact.max()[axis], dense.max()[axis] - 1e-13 * size);
    EXPECT_NEAR(exact.min()[axis], dense.min()[axis], 1e-6 * size);
    EXPECT_NEAR(exact.max()[axis], dense.max()[axis], 1e-6 * size);
  }
}

TEST(CurveExtrema, ConicsMeetDenseSamples) {
  const Vec3 o{1, 2, 3}, a{1, 0.5, -0.2}, b{-0.3, 1.1, 0.7};
  expect_exact(Line<3>{o, a}, {-1.0, 2.0});
  expect_exact(Ellipse<3>{o, a, b}, {0.0, kTwoPi});
  expect_exact(Ellipse<3>{o, a, b}, {-9.0, -7.5});
  expect_exact(Ellipse<3>{o, a, b}, {1.0, 1.2});
  expect_exact(Parabola<3>{o, a, b}, {-2.0, 1.0});
  expect_exact(Hyperbola<3>{o, a, b}, {-1.5, 1.0});
}

TEST(CurveExtrema, RandomSplinesMeetDenseSamples) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
  std::uniform_real_distribution<double> weight(0.2, 5.0);
  for (int degree = 1; degree <= 7; ++degree) {
    for (const bool rational : {false, true}) {
      BSplineCurve<3> curve{degree, {}, {}, {}};
      const int count = degree + 6;
      curve.knots.assign(degree + 1, 0.0);
      for (const double inner : {0.2, 0.2, 0.5, 0.6, 0.9})
        curve.knots.push_back(degree == 1 && inner == 0.2 ? 0.1 + 0.1 * (curve.knots.size() % 2) : inner);
      std::sort(curve.knots.begin(), curve.knots.end());
      curve.knots.insert(curve.knots.end(), degree + 1, 1.0);
      for (int i = 0; i < count; ++i) {
        curve.poles.emplace_back(coordinate(random), coordinate(random), coordinate(random));
        if (rational) curve.weights.push_back(weight(random));
      }
      expect_exact(curve, {0.0, 1.0});
      expect_exact(curve, {0.37, 0.83});
    }
  }
}

TEST(CurveExtrema, AnExtremumInsideIsFoundToTheLastDigits) {
  // z = 2 t (1 - t): 1/2 at t = 1/2.
  const BSplineCurve<3> arch{2, {0, 0, 0, 1, 1, 1}, {{0, 0, 0}, {0.5, 0, 1}, {1, 0, 0}}, {}};
  EXPECT_NEAR(exact_bounds(arch, {0.0, 1.0}).max().z(), 0.5, 1e-15);
}

}  // namespace
}  // namespace lamella
