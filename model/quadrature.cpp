#include "model/quadrature.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry.h"

namespace lamella {

namespace {

/// Legendre polynomial P_n and its derivative at x, |x| < 1, by Bonnet's three-term recursion.
std::pair<double, double> legendre(int n, double x) {
  double before = 1.0;
  double here = x;
  for (int k = 2; k <= n; ++k) {
    before = std::exchange(here, ((2 * k - 1) * x * here - (k - 1) * before) / k);
  }
  return {here, n * (x * here - before) / (x * x - 1.0)};
}

GaussRule make_rule(int n) {
  GaussRule rule{std::vector<double>(n), std::vector<double>(n)};
  for (int i = 0; i < n; ++i) {
    // Tricomi's start is near enough for Newton to converge quadratically for every root.
    double x = std::cos(kPi * (i + 0.75) / (n + 0.5));
    for (int step = 0; step < 20; ++step) {
      const auto [value, slope] = legendre(n, x);
      const double change = value / slope;
      x -= change;
      if (std::abs(change) < 1e-15) break;
    }
    const double slope = n == 1 ? 1.0 : legendre(n, x).second;
    rule.nodes[n - 1 - i] = 0.5 * (1.0 + x);
    rule.weights[n - 1 - i] = 1.0 / ((1.0 - x * x) * slope * slope);
  }
  return rule;
}

std::vector<GaussRule> make_rules() {
  std::vector<GaussRule> rules;
  for (int n = 1; n <= kMaxGaussNodes; ++n) rules.push_back(make_rule(n));
  return rules;
}

}  // namespace

const GaussRule& gauss_legendre(int count) {
  static const std::vector<GaussRule> rules = make_rules();
  return rules[std::clamp(count, 1, kMaxGaussNodes) - 1];
}

}  // namespace lamella
