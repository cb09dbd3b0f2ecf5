#include "slicing/reference/certified.h"

#include <cmath>
#include <complex>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>

#include "core/tolerances.h"

namespace lamella::reference {
namespace {

SubPatch make_sub_patch(BezierPatch patch) {
  SubPatch result;
  result.patch = std::move(patch);
  result.max_weight = 0.0;
  for (const Vec4& pole : result.patch.net) {
    result.max_weight = std::max(result.max_weight, pole.w());
    result.max_coordinate = std::max(result.max_coordinate, pole.head<3>().cwiseAbs().maxCoeff());
  }
  return result;
}

std::vector<PatchRoot> solve(const BezierPatch& patch, const Ray& ray) {
  const SubPatch sub_patch = make_sub_patch(patch);
  PlaneNets nets;
  project(sub_patch, make_ray_planes(ray), nets);
  CertifiedSolver solver;
  std::vector<PatchRoot> roots;
  std::uint64_t iterations = 0;
  solver.solve(nets, 1e-12 * sub_patch.max_coordinate, roots, iterations);
  std::sort(roots.begin(), roots.end(),
            [](const PatchRoot& a, const PatchRoot& b) { return std::tie(a.u, a.v) < std::tie(b.u, b.v); });
  return roots;
}

/// The graph z = f(x, y) of a polynomial over the unit square, coefficients c[i][j] of x^i y^j, as a Bezier patch with
/// weights one: monomial to Bernstein form.
template <std::size_t Nu, std::size_t Nv>
BezierPatch graph(const std::array<std::array<double, Nv>, Nu>& c) {
  const auto binomial = [](int n, int k) {
    double value = 1.0;
    for (int i = 0; i < k; ++i) value = value * (n - i) / (i + 1);
    return value;
  };
  BezierPatch patch{Nu - 1, Nv - 1, {0.0, 1.0}, {0.0, 1.0}, {}};
  for (int i = 0; i < static_cast<int>(Nu); ++i) {
    for (int j = 0; j < static_cast<int>(Nv); ++j) {
      double z = 0.0;
      for (int k = 0; k <= i; ++k) {
        for (int l = 0; l <= j; ++l) {
          z += c[k][l] * binomial(i, k) / binomial(Nu - 1, k) * binomial(j, l) / binomial(Nv - 1, l);
        }
      }
      patch.net.emplace_back(i / (Nu - 1.0), j / (Nv - 1.0), z, 1.0);
    }
  }
  return patch;
}

BezierPatch unit_plane() {
  return {1, 1, {0.0, 1.0}, {0.0, 1.0}, {{0, 0, 0, 1}, {0, 1, 0, 1}, {1, 0, 0, 1}, {1, 1, 0, 1}}};
}

/// y + i z = (u + i v)^3, x = v on [0.1, 1] x [-1, 1]: a positive Jacobian everywhere, and two hits at (y, z) = (-1,
/// 0).
BezierPatch cubic_patch() {
  const Interval u{0.1, 1.0};
  const Interval v{-1.0, 1.0};
  BezierPatch patch{3, 3, u, v, {}};
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      // Blossom of (u + i v)^3 as a tensor product: y = u^3 - 3 u v^2, z = 3 u^2 v - v^3.
      const auto blossom = [](const Interval& range, int index, int power) {
        double sum = 0.0;  // elementary symmetric mean of `power` arguments, `index` of the three being range.hi
        int count = 0;
        for (int mask = 0; mask < 8; ++mask) {
          if (__builtin_popcount(mask) != power) continue;
          double product = 1.0;
          for (int k = 0; k < 3; ++k) {
            if (mask >> k & 1) product *= k < index ? range.hi : range.lo;
          }
          sum += product;
          ++count;
        }
        return sum / count;
      };
      const double y = blossom(u, i, 3) - 3.0 * blossom(u, i, 1) * blossom(v, j, 2);
      const double z = 3.0 * blossom(u, i, 2) * blossom(v, j, 1) - blossom(v, j, 3);
      patch.net.emplace_back(blossom(v, j, 1), y, z, 1.0);
    }
  }
  return patch;
}

TEST(CertifiedSolver, FindsTheOneHitOfAPlaneExactly) {
  const auto roots = solve(unit_plane(), {{0.3, 0.7, 5.0}, {0.0, 0.0, -1.0}});
  ASSERT_EQ(roots.size(), 1U);
  EXPECT_NEAR(roots[0].u, 0.3, 1e-15);
  EXPECT_NEAR(roots[0].v, 0.7, 1e-15);
  EXPECT_FALSE(roots[0].undecided);
  // S_u x S_v = +z and the ray runs along -z: it enters.
  EXPECT_TRUE(roots[0].enters);
}

TEST(CertifiedSolver, LeavesOutWhatTheRayMisses) {
  EXPECT_TRUE(solve(unit_plane(), {{1.3, 0.7, 5.0}, {0.0, 0.0, -1.0}}).empty());
  EXPECT_TRUE(solve(unit_plane(), {{0.3, 1.0 + 1e-6, 5.0}, {0.0, 0.0, -1.0}}).empty());
}

TEST(CertifiedSolver, CountsRootsOnTheBorderOfTheSubPatch) {
  for (const double x : {0.0, 1.0}) {
    for (const double y : {0.0, 0.25, 1.0}) {
      EXPECT_EQ(solve(unit_plane(), {{x, y, 5.0}, {0.0, 0.0, -1.0}}).size(), 1U) << x << " " << y;
    }
  }
}

TEST(CertifiedSolver, FindsBothHitsOfTheCubicPatchWithPositiveJacobian) {
  const BezierPatch patch = cubic_patch();
  const Vec3 check = evaluate_point(patch, 0.5, 0.25);
  const std::complex<double> cube = std::pow(std::complex<double>(0.5, 0.25), 3);
  ASSERT_NEAR(check.y(), cube.real(), 1e-15);
  ASSERT_NEAR(check.z(), cube.imag(), 1e-15);

  const auto roots = solve(patch, {{-9.0, -1.0, 0.0}, {1.0, 0.0, 0.0}});
  ASSERT_EQ(roots.size(), 2U);
  // The cube roots of -1 with positive real part: u = 1/2, v = -+ sqrt(3) / 2.
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(0.1 + 0.9 * roots[k].u, 0.5, 1e-14);
    EXPECT_NEAR(-1.0 + 2.0 * roots[k].v, (k == 0 ? -0.5 : 0.5) * std::sqrt(3.0), 1e-14);
    EXPECT_FALSE(roots[k].undecided);
  }
  EXPECT_EQ(roots[0].enters, roots[1].enters);
}

TEST(CertifiedSolver, FindsAsManyHitsAsTheCubeHasRootsInTheRectangle) {
  const BezierPatch patch = cubic_patch();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> coordinate(-2.0, 1.5);
  for (int ray = 0; ray < 2000; ++ray) {
    const std::complex<double> target(coordinate(random), coordinate(random));
    const double modulus = std::cbrt(std::abs(target));
    std::size_t expected = 0;
    for (int k = -1; k <= 1; ++k) {
      const std::complex<double> root = std::polar(modulus, (std::arg(target) + kTwoPi * k) / 3.0);
      if (root.real() >= 0.1 && root.real() <= 1.0 && std::abs(root.imag()) <= 1.0) ++expected;
    }
    EXPECT_EQ(solve(patch, {{3.0, target.real(), target.imag()}, {-1.0, 0.0, 0.0}}).size(), expected) << target;
  }
}

/// A parabola cylinder z = x^2 - x seen along y' just above its lowest line: two hits 2 sqrt(distance) apart.
TEST(CertifiedSolver, SeparatesFoldPairsDownToADistanceOf1e9) {
  const BezierPatch patch = graph<3, 2>({{{0.0, 0.0}, {-1.0, 0.0}, {1.0, 0.0}}});
  for (const double distance : {1e-3, 1e-5, 1e-7, 1e-9}) {
    const auto roots = solve(patch, {{-2.0, 0.37, -0.25 + distance}, {1.0, 0.0, 0.0}});
    ASSERT_EQ(roots.size(), 2U) << distance;
    EXPECT_NEAR(roots[0].u, 0.5 - std::sqrt(distance), 1e-13 / std::sqrt(distance));
    EXPECT_NEAR(roots[1].u, 0.5 + std::sqrt(distance), 1e-13 / std::sqrt(distance));
    EXPECT_NE(roots[0].enters, roots[1].enters) << distance;
    EXPECT_TRUE(solve(patch, {{-2.0, 0.37, -0.25 - distance}, {1.0, 0.0, 0.0}}).empty()) << distance;
  }
}

TEST(CertifiedSolver, FlagsATangencyAsOneUndecidedPlace) {
  const BezierPatch patch = graph<3, 2>({{{0.0, 0.0}, {-1.0, 0.0}, {1.0, 0.0}}});
  const auto roots = solve(patch, {{-2.0, 0.37, -0.25}, {1.0, 0.0, 0.0}});
  ASSERT_EQ(roots.size(), 1U);
  EXPECT_TRUE(roots[0].undecided);
  EXPECT_NEAR(roots[0].u, 0.5, 1e-6);
  // z varies with the square of u: undecided within 1e-9 of the model's size across the ray.
  EXPECT_LT(roots[0].half_u * roots[0].half_u, tolerance::kUndecidedRelative);
}

TEST(CertifiedSolver, FlagsARayInsideAPlaneAndEndsSoon) {
  const SubPatch sub_patch = make_sub_patch(unit_plane());
  PlaneNets nets;
  project(sub_patch, make_ray_planes({{0.0, 0.3, 0.0}, {1.0, 0.0, 0.0}}), nets);
  CertifiedSolver solver;
  std::vector<PatchRoot> roots;
  std::uint64_t boxes = 0;
  solver.solve(nets, 1e-12, roots, boxes);
  ASSERT_EQ(roots.size(), 1U);
  EXPECT_TRUE(roots[0].undecided);
  EXPECT_NEAR(roots[0].half_u, 0.5, 1e-12);
  EXPECT_NEAR(roots[0].v, 0.3, 1e-9);
  EXPECT_LT(boxes, 400U);
}

TEST(CertifiedSolver, BoundsItsWorkOnDegenerateNets) {
  BezierPatch patch{5, 5, {0.0, 1.0}, {0.0, 1.0}, {}};
  for (int k = 0; k < 36; ++k) patch.net.emplace_back(1.0, 2.0, 3.0, 1.0);
  const SubPatch sub_patch = make_sub_patch(patch);
  PlaneNets nets;
  project(sub_patch, make_ray_planes({{0.0, 2.0, 3.0}, {1.0, 0.0, 0.0}}), nets);
  CertifiedSolver solver;
  std::vector<PatchRoot> roots;
  std::uint64_t boxes = 0;
  solver.solve(nets, 1e-12, roots, boxes);
  EXPECT_LE(boxes, static_cast<std::uint64_t>(CertifiedSolver::kMaxBoxes));
  ASSERT_EQ(roots.size(), 1U);
  EXPECT_TRUE(roots[0].undecided);
}

/// Every point of a random rational patch must be found by a ray through it, whatever the direction.
TEST(CertifiedSolver, FindsThePointThatTheRayWasDrawnThrough) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 3000; ++trial) {
    const int degree_u = 1 + trial % 5;
    const int degree_v = 1 + trial % 3;
    BezierPatch patch{degree_u, degree_v, {0.0, 1.0}, {0.0, 1.0}, {}};
    for (int i = 0; i <= degree_u; ++i) {
      for (int j = 0; j <= degree_v; ++j) {
        const double w = 0.3 + 2.0 * unit(random);
        const Vec3 p(i + 0.7 * normal(random), j + 0.7 * normal(random), normal(random));
        patch.net.emplace_back(w * p.x(), w * p.y(), w * p.z(), w);
      }
    }
    const Vec2 uv(unit(random), unit(random));
    const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
    const auto roots = solve(patch, {evaluate_point(patch, uv.x(), uv.y()) - 3.0 * direction, direction});
    double nearest = 1.0;
    int decided = 0;
    for (const PatchRoot& root : roots) {
      nearest = std::min(nearest, std::max(std::abs(root.u - uv.x()), std::abs(root.v - uv.y())));
      decided += root.undecided ? 0 : 1;
    }
    EXPECT_LT(nearest, 1e-8) << "trial " << trial;
    EXPECT_EQ(decided, static_cast<int>(roots.size())) << "trial " << trial;
  }
}

/// Split anywhere, the halves find together what the whole finds: nothing is lost or doubled on the common border but
/// what lies on it.
TEST(CertifiedSolver, FindsTheSameAfterSplitting) {
  const BezierPatch patch =
      graph<4, 4>({{{0.1, -1.0, 2.5, -1.4}, {-2.0, 3.0, 0.0, 0.0}, {5.0, -3.0, 0.0, 0.0}, {-3.0, 0.0, 1.0, 0.0}}});
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int trial = 0; trial < 500; ++trial) {
    const double angle = kTwoPi * unit(random);
    const Ray ray{{unit(random), unit(random), 0.4 * unit(random) - 0.2}, {std::cos(angle), std::sin(angle), 0.0}};
    const double at = 0.1 + 0.8 * unit(random);
    const auto [left, right] = split_u(patch, at);
    EXPECT_EQ(solve(patch, ray).size(), solve(left, ray).size() + solve(right, ray).size()) << "trial " << trial;
  }
}

}  // namespace
}  // namespace lamella::reference
