#include "model/quadrature.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numeric>

#include "model/bernstein_roots.h"

namespace lamella {
namespace {

TEST(GaussLegendre, IntegratesPowersUpToTwiceItsNodesLessOneExactly) {
  for (int n = 1; n <= kMaxGaussNodes; ++n) {
    const GaussRule& rule = gauss_legendre(n);
    ASSERT_EQ(rule.nodes.size(), static_cast<std::size_t>(n));
    for (const int power : {0, 1, n, 2 * n - 2, 2 * n - 1}) {
      double sum = 0.0;
      for (int k = 0; k < n; ++k) sum += rule.weights[k] * std::pow(rule.nodes[k], power);
      EXPECT_NEAR(sum * (power + 1), 1.0, 1e-13 * n) << n << " nodes, power " << power;
    }
  }
}

TEST(GaussLegendre, IsNotExactForTheNextEvenPower) {
  const GaussRule& rule = gauss_legendre(2);
  double sum = 0.0;
  for (int k = 0; k < 2; ++k) sum += rule.weights[k] * std::pow(rule.nodes[k], 4);
  EXPECT_GT(std::abs(sum - 0.2), 1e-3);
}

TEST(GaussLegendre, NodesAscendInsideTheUnitIntervalAndMirror) {
  for (int n = 1; n <= kMaxGaussNodes; ++n) {
    const GaussRule& rule = gauss_legendre(n);
    for (int k = 0; k < n; ++k) {
      EXPECT_GT(rule.nodes[k], k == 0 ? 0.0 : rule.nodes[k - 1]);
      EXPECT_LT(rule.nodes[k], 1.0);
      EXPECT_NEAR(rule.nodes[k] + rule.nodes[n - 1 - k], 1.0, 4e-16);
    }
  }
}

TEST(BernsteinRoots, FindsSimpleRootsOfProducts) {
  // (t - 1/4)(t - 1/2)(t - 7/8) by its Bernstein coefficients.
  const double roots[] = {0.25, 0.5, 0.875};
  const double power[] = {-roots[0] * roots[1] * roots[2],
                          roots[0] * roots[1] + roots[1] * roots[2] + roots[0] * roots[2],
                          -(roots[0] + roots[1] + roots[2]), 1.0};
  const double b[] = {power[0], power[0] + power[1] / 3, power[0] + 2 * power[1] / 3 + power[2] / 3,
                      power[0] + power[1] + power[2] + power[3]};
  const std::vector<double> found = bernstein_roots(b, 1.0);
  ASSERT_EQ(found.size(), 3u);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(found[i], roots[i], 1e-11);
}

TEST(BernsteinRoots, FindsNoneWhereThereIsNone) {
  const double positive[] = {1.0, 0.1, 1.0};
  const double zero[] = {0.0, 0.0, 0.0};
  const double bad[] = {-1.0, std::nan(""), 1.0};
  EXPECT_TRUE(bernstein_roots(positive, 1.0).empty());
  EXPECT_TRUE(bernstein_roots(zero, 1.0).empty());
  EXPECT_TRUE(bernstein_roots(bad, 1.0).empty());
}

}  // namespace
}  // namespace lamella
