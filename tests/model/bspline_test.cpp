#include "model/bspline.h"

#include <gtest/gtest.h>
#include <limits>

#include "core/error.h"
#include "model/basis_table.h"
#include "model/evaluate.h"
#include "tests/model/random_geometry.h"

namespace lamella {
namespace {

using test::RandomGeometry;

constexpr double kRelative = 1e-13;

/// Parameters that matter: both ends, every knot, and between.
std::vector<double> parameters(RandomGeometry& random, const std::vector<double>& knots) {
  std::vector<double> result = knots;
  for (int i = 0; i < 20; ++i) result.push_back(random.real(knots.front(), knots.back()));
  return result;
}

TEST(Basis, EqualsItsRecursiveDefinition) {
  RandomGeometry random(1);
  for (int degree = 1; degree <= kMaxDegree; ++degree) {
    const auto knots = random.knots(degree, 5);
    for (const double t : parameters(random, knots)) {
      const auto expected = test::basis_by_definition(knots, degree, static_cast<long double>(t));
      const Basis basis = evaluate_basis(knots, degree, t, 0);
      std::vector<double> actual(expected.size(), 0.0);
      for (int k = 0; k <= degree; ++k) actual[basis.first + k] = basis.derivative[0][k];
      for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_NEAR(actual[i], static_cast<double>(expected[i]), kRelative) << "degree " << degree << " t " << t;
      }
    }
  }
}

TEST(Basis, DerivativesEqualDifferencesOfTheDefinition) {
  RandomGeometry random(2);
  const long double h = 1e-5L;
  for (int degree = 1; degree <= 13; ++degree) {
    const std::vector<double> knots = random.knots(degree, 1);
    const double t = 0.3 * knots.front() + 0.7 * knots.back();
    const Basis basis = evaluate_basis(knots, degree, t, 2);
    const auto below = test::basis_by_definition(knots, degree, t - h);
    const auto at = test::basis_by_definition(knots, degree, static_cast<long double>(t));
    const auto above = test::basis_by_definition(knots, degree, t + h);
    const double scale = std::pow(degree / (knots.back() - knots.front()), 4);
    for (int k = 0; k <= degree; ++k) {
      const auto first = static_cast<double>((above[k] - below[k]) / (2 * h));
      const auto second = static_cast<double>((above[k] - 2 * at[k] + below[k]) / (h * h));
      EXPECT_NEAR(basis.derivative[1][k], first, 1e-9 * scale);
      EXPECT_NEAR(basis.derivative[2][k], second, 1e-8 * scale);
    }
  }
}

TEST(BasisTable, EqualsTheDefinitionAndItsDifferences) {
  RandomGeometry random(5);
  const long double h = 1e-5L;
  for (int degree = 1; degree <= 13; ++degree) {
    const std::vector<double> knots = random.knots(degree, 4);
    const BasisTable table(knots, degree);
    for (const double t : parameters(random, knots)) {
      BasisRow values;
      BasisRow slopes;
      const int first = table.evaluate(t, values.data(), slopes.data());
      const auto at = test::basis_by_definition(knots, degree, static_cast<long double>(t));
      for (int k = 0; k <= degree; ++k) {
        EXPECT_NEAR(values[k], static_cast<double>(at[first + k]), 1e-13) << "degree " << degree << " at " << t;
      }
      const auto next = *std::upper_bound(knots.begin(), knots.end() - degree - 1, t);
      if (t - h <= knots[first + degree] || t + h >= next) continue;  // the differences would cross a knot
      const auto below = test::basis_by_definition(knots, degree, t - h);
      const auto above = test::basis_by_definition(knots, degree, t + h);
      const double scale = std::pow(degree / (next - knots[first + degree]), 3);
      for (int k = 0; k <= degree; ++k) {
        EXPECT_NEAR(slopes[k], static_cast<double>((above[first + k] - below[first + k]) / (2 * h)), 1e-9 * scale);
      }
    }
  }
}

TEST(FindSpan, HoldsTheParameterAndIsNeverEmpty) {
  RandomGeometry random(3);
  for (int round = 0; round < 50; ++round) {
    const int degree = random.integer(1, 8);
    const auto knots = random.knots(degree, random.integer(1, 9));
    auto ts = parameters(random, knots);
    ts.insert(ts.end(), {knots.front() - 1.0, knots.back() + 1.0});
    for (const double t : ts) {
      const int span = find_span(knots, degree, t);
      ASSERT_LT(knots[span], knots[span + 1]);
      const double clamped = std::clamp(t, knots.front(), knots.back());
      EXPECT_LE(knots[span], clamped);
      EXPECT_GE(knots[span + 1], clamped);
    }
  }
}

TEST(FindSpan, SurvivesNotANumber) {
  const std::vector<double> knots{0, 0, 1, 1};
  EXPECT_EQ(find_span(knots, 1, std::numeric_limits<double>::quiet_NaN()), 1);
}

/// New knots, some of them old ones or each other, no more often than allowed.
std::vector<double> knots_to_insert(RandomGeometry& random, const std::vector<double>& knots, int degree) {
  std::vector<double> merged = knots;
  std::vector<double> result;
  for (int i = 0; i < 12; ++i) {
    double knot = random.real(knots.front(), knots.back());
    if (i % 3 == 1) knot = merged[random.integer(0, static_cast<int>(merged.size()) - 1)];
    if (i % 3 == 2) knot = result[random.integer(0, i - 1) % result.size()];
    if (std::count(merged.begin(), merged.end(), knot) > degree) continue;
    merged.push_back(knot);
    result.push_back(knot);
  }
  std::sort(result.begin(), result.end());
  return result;
}

TEST(Oslo, DiscreteBSplinesAreAPartitionOfUnity) {
  RandomGeometry random(4);
  for (int degree = 1; degree <= kMaxDegree; ++degree) {
    const auto knots = random.knots(degree, 4);
    const auto refined = merge_knots(knots, degree, knots_to_insert(random, knots, degree));
    for (int i = 0; i + degree + 1 < static_cast<int>(refined.size()); ++i) {
      const DiscreteBSpline row = discrete_bspline(knots, refined, degree, i);
      double sum = 0.0;
      for (int k = 0; k <= degree; ++k) {
        EXPECT_GE(row.alpha[k], 0.0);
        sum += row.alpha[k];
      }
      EXPECT_NEAR(sum, 1.0, kRelative);
    }
  }
}

TEST(Oslo, KeepsCurvesOfEveryDegreeRationalOrNot) {
  RandomGeometry random(5);
  for (int degree = 1; degree <= 13; ++degree) {
    for (const bool rational : {false, true}) {
      const auto curve = random.curve<3>(degree, 4, rational);
      const auto fine = refine(curve, knots_to_insert(random, curve.knots, degree));
      ASSERT_GT(fine.poles.size(), curve.poles.size());
      for (const double t : parameters(random, curve.knots)) {
        const Vec3 expected = evaluate<3>(Curve3(curve), t).point;
        EXPECT_LT((evaluate<3>(Curve3(fine), t).point - expected).norm(), kRelative * 10.0) << degree << " at " << t;
      }
    }
  }
}

TEST(Oslo, KeepsSurfacesInBothDirections) {
  RandomGeometry random(6);
  for (int round = 0; round < 26; ++round) {
    const int p = 1 + round % 13;
    const int q = 1 + (round * 5) % 13;
    const BSplineSurface surface = random.surface(p, q, 3, round % 2 == 0);
    const BSplineSurface fine_u = refine_u(surface, knots_to_insert(random, surface.knots_u, p));
    const BSplineSurface fine = refine_v(fine_u, knots_to_insert(random, surface.knots_v, q));
    ASSERT_GT(fine.count_u, surface.count_u);
    ASSERT_GT(fine.count_v, surface.count_v);
    for (int i = 0; i < 20; ++i) {
      const double u = random.real(surface.domain_u().lo, surface.domain_u().hi);
      const double v = random.real(surface.domain_v().lo, surface.domain_v().hi);
      const Vec3 expected = test::point_by_definition(surface, u, v);
      EXPECT_LT((evaluate_point(fine, {u, v}) - expected).norm(), kRelative * 10.0) << p << " x " << q;
    }
  }
}

TEST(Oslo, RefusesKnotsOutsideTheDomainOrTooOften) {
  RandomGeometry random(7);
  const auto curve = random.curve<2>(3, 2, false);
  const double end = curve.knots.back();
  const double inner = curve.knots[4];
  EXPECT_THROW((void)refine(curve, std::vector<double>{end + 1.0}), GeometryError);
  EXPECT_THROW((void)refine(curve, std::vector<double>{std::numeric_limits<double>::quiet_NaN()}), GeometryError);
  EXPECT_THROW((void)refine(curve, std::vector<double>{end}), GeometryError);
  EXPECT_THROW((void)refine(curve, std::vector<double>(4, inner)), GeometryError);
}

TEST(Limits, NameWhatIsWrong) {
  RandomGeometry random(8);
  const auto good = random.curve<3>(3, 3, true);
  EXPECT_NO_THROW(check_limits(good));
  auto bad = good;
  bad.weights[1] = 0.0;
  EXPECT_THROW(check_limits(bad), GeometryError);
  bad = good;
  bad.weights[1] = bad.weights[0] * 2e9;
  EXPECT_THROW(check_limits(bad), GeometryError);
  bad = good;
  bad.poles[1][2] = std::numeric_limits<double>::infinity();
  EXPECT_THROW(check_limits(bad), GeometryError);
  bad = good;
  bad.knots[0] -= 1.0;
  EXPECT_THROW(check_limits(bad), GeometryError);
  bad = good;
  bad.knots.pop_back();
  EXPECT_THROW(check_limits(bad), GeometryError);
  bad = good;
  std::swap(bad.knots.front(), bad.knots.back());
  EXPECT_THROW(check_limits(bad), GeometryError);
  auto high = random.curve<3>(kMaxDegree, 1, false);
  EXPECT_NO_THROW(check_limits(high));
  high = random.curve<3>(kMaxDegree + 1, 1, false);
  EXPECT_THROW(check_limits(high), GeometryError);
}

TEST(Limits, RefuseSurfacesWhosePolesDoNotFit) {
  RandomGeometry random(9);
  const auto good = random.surface(2, 3, 2, true);
  EXPECT_NO_THROW(check_limits(good));
  auto bad = good;
  bad.poles.pop_back();
  EXPECT_THROW(check_limits(bad), GeometryError);
  bad = good;
  bad.count_u = -bad.count_u;
  EXPECT_THROW(check_limits(bad), GeometryError);
  bad = good;
  bad.degree_v = 0;
  EXPECT_THROW(check_limits(bad), GeometryError);
}

}  // namespace
}  // namespace lamella
