/// Sums of Bezier nets against Bernstein polynomials written out, on every level of the architecture that runs here.

#include "slicing/span/net_kernel.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "slicing/span/bezier_nets.h"

namespace lamella::span {
namespace {

/// The polynomial number i of degree n at t, or its derivative of some order.
double bernstein(int n, int i, double t, int order) {
  if (i < 0 || i > n) return 0.0;
  if (order > 0) return n * (bernstein(n - 1, i - 1, t, order - 1) - bernstein(n - 1, i, t, order - 1));
  return std::exp(std::lgamma(n + 1.0) - std::lgamma(i + 1.0) - std::lgamma(n - i + 1.0)) * std::pow(t, i) *
         std::pow(1.0 - t, n - i);
}

std::vector<double> random_net(int poles, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<double> net;
  for (int i = 0; i < kNetStride * poles; ++i) net.push_back(unit(random));
  return net;
}

class NetDegrees : public testing::TestWithParam<std::pair<int, int>> {};

TEST_P(NetDegrees, SumAsWrittenOutWithEqualBytesOnEveryLevel) {
  const auto [degree_u, degree_v] = GetParam();
  const std::vector<double> net = random_net((degree_u + 1) * (degree_v + 1), 5);
  const NetPlace u{degree_u, 0.37, 2.5};
  const NetPlace v{degree_v, 0.81, 0.3};
  constexpr int kOrders[6][2] = {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}};
  std::vector<double> first;
  for (const NetKernel& kernel : net_kernels()) {
    std::vector<double> sums(6 * kNetStride);
    kernel.surface_bends(net.data(), u, v, sums.data());
    std::vector<double> slopes(3 * kNetStride);
    kernel.surface_slopes(net.data(), u, v, slopes.data());
    EXPECT_EQ(slopes, std::vector<double>(sums.begin(), sums.begin() + 3 * kNetStride));
    if (first.empty()) first = sums;
    EXPECT_EQ(sums, first);
  }
  for (int k = 0; k < 6; ++k) {
    for (int c = 0; c < kNetStride; ++c) {
      double expected = 0.0;
      for (int i = 0; i <= degree_u; ++i) {
        for (int j = 0; j <= degree_v; ++j) {
          expected += bernstein(degree_u, i, u.place, kOrders[k][0]) * bernstein(degree_v, j, v.place, kOrders[k][1]) *
                      net[static_cast<std::size_t>(kNetStride * (i * (degree_v + 1) + j) + c)];
        }
      }
      expected *= std::pow(u.scale, kOrders[k][0]) * std::pow(v.scale, kOrders[k][1]);
      EXPECT_NEAR(first[static_cast<std::size_t>(kNetStride * k + c)], expected, 1e-11 * (1.0 + std::abs(expected)));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Surfaces, NetDegrees,
                         testing::Values(std::pair{3, 3}, std::pair{1, 1}, std::pair{2, 3}, std::pair{3, 5},
                                         std::pair{5, 4}, std::pair{4, 1}, std::pair{6, 11}, std::pair{13, 2},
                                         std::pair{25, 25}));

TEST(NetKernel, SumsCurves) {
  for (const int degree : {1, 2, 3, 4, 5, 6, 9, 25}) {
    const std::vector<double> net = random_net(degree + 1, 8);
    const NetPlace t{degree, 0.44, 1.7};
    for (const NetKernel& kernel : net_kernels()) {
      std::vector<double> sums(3 * kNetStride);
      kernel.curve(net.data(), t, sums.data());
      for (int order = 0; order < 3; ++order) {
        double expected = 0.0;
        for (int i = 0; i <= degree; ++i) {
          expected += bernstein(degree, i, t.place, order) * net[static_cast<std::size_t>(kNetStride * i)];
        }
        expected *= std::pow(t.scale, order);
        EXPECT_NEAR(sums[static_cast<std::size_t>(kNetStride * order)], expected, 1e-11 * (1.0 + std::abs(expected)));
      }
    }
  }
}

TEST(Breaks, HoldEveryPlaceInTheRightPart) {
  // Clusters and wide parts, as in real knots.
  const std::vector<double> limits{0.0, 0.3, 0.3001, 0.3002, 0.30021, 0.9, 4.0};
  const Breaks breaks(limits);
  const int parts = static_cast<int>(limits.size()) - 1;
  for (double place = -0.5; place < 4.5; place += 0.00005) {
    int expected = 0;
    while (expected + 1 < parts && place >= limits[static_cast<std::size_t>(expected) + 1]) ++expected;
    ASSERT_EQ(breaks.part_of(place), expected) << place;
    ASSERT_EQ(breaks.part_of(place, 2, 4), std::clamp(expected, 2, 3)) << place;
  }
  EXPECT_EQ(breaks.part_of(std::nan("")), 0);
}

}  // namespace
}  // namespace lamella::span
