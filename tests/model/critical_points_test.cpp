#include "model/critical_points.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>

#include "model/evaluate.h"
#include "model/rational_form.h"
#include "tests/model/random_geometry.h"

namespace lamella {
namespace {

using test::RandomGeometry;

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

Box2 box(double u0, double v0, double u1, double v1) { return {Vec2(u0, v0), Vec2(u1, v1)}; }

Box2 domain(const BSplineSurface& s) { return box(s.domain_u().lo, s.domain_v().lo, s.domain_u().hi, s.domain_v().hi); }

int count(const CriticalPoints& found, CriticalKind kind) {
  return static_cast<int>(
      std::count_if(found.points.begin(), found.points.end(), [&](const auto& p) { return p.kind == kind; }));
}

/// maxima + minima - saddles: the Euler characteristic of a closed surface.
int morse_sum(const CriticalPoints& found) {
  return count(found, CriticalKind::maximum) + count(found, CriticalKind::minimum) - count(found, CriticalKind::saddle);
}

bool has_level(const CriticalPoints& found, double z, double accuracy = 1e-7) {
  return std::any_of(found.levels.begin(), found.levels.end(),
                     [&](double level) { return std::abs(level - z) <= accuracy; });
}

Frame random_frame(RandomGeometry& random, bool left_handed = false) {
  const Mat3 axes = Eigen::AngleAxisd(random.real(-3, 3), random.point<3>().normalized()).toRotationMatrix();
  const Vec3 y = axes.col(1);
  return {random.point<3>(), axes.col(0), left_handed ? Vec3(-y) : y, axes.col(2)};
}

Frame tilted(double angle) {
  const Mat3 axes = Eigen::AngleAxisd(angle, Vec3(1, 2, 0).normalized()).toRotationMatrix();
  return {Vec3(1, 2, 3), axes.col(0), axes.col(1), axes.col(2)};
}

/// Z along `z`, which must not be along x.
Frame frame_along(const Vec3& z) {
  const Vec3 y = z.cross(Vec3::UnitX()).normalized();
  return {Vec3(4, 5, 6), y.cross(z.normalized()), y, z.normalized()};
}

void expect_stationary(const Surface& surface, const CriticalPoints& found, double accuracy = 1e-9) {
  EXPECT_TRUE(found.complete);
  for (const CriticalPoint& p : found.points) {
    const SurfacePoint at = evaluate(surface, p.uv);
    EXPECT_NEAR(at.du.z(), 0.0, accuracy * (1.0 + at.du.norm())) << surface_type_name(surface);
    EXPECT_NEAR(at.dv.z(), 0.0, accuracy * (1.0 + at.dv.norm())) << surface_type_name(surface);
    EXPECT_NEAR(at.point.z(), p.z, 1e-13 * (1.0 + std::abs(p.z)));
  }
}

/// Newton's method from the points of a fine grid: all isolated points but for bad luck.
std::vector<Vec2> points_from_many_starts(const Surface& surface, const Box2& bounds, int starts) {
  std::vector<Vec2> all;
  const Vec2 size = bounds.sizes();
  for (int k = 0; k < starts * starts; ++k) {
    Vec2 uv = bounds.min() + size.cwiseProduct(Vec2(k % starts + 0.5, k / starts + 0.5)) / starts;
    for (int i = 0; i < 30 && bounds.contains(uv); ++i) {
      const SurfacePoint2 at = evaluate2(surface, uv);
      Eigen::Matrix2d hessian;
      hessian << at.duu.z(), at.duv.z(), at.duv.z(), at.dvv.z();
      const Vec2 step = -hessian.inverse() * Vec2(at.du.z(), at.dv.z());
      uv += step;
      if (step.cwiseQuotient(size).norm() > 1e-12) continue;
      const auto near = [&](const Vec2& other) { return (other - uv).cwiseQuotient(size).norm() < 1e-7; };
      if (bounds.contains(uv) && std::none_of(all.begin(), all.end(), near)) all.push_back(uv);
      break;
    }
  }
  return all;
}

void expect_all_of_many_starts(const Surface& surface, const Box2& bounds, int starts) {
  const CriticalPoints found = find_critical_points(surface, bounds);
  expect_stationary(surface, found, 1e-8);
  for (const Vec2& uv : points_from_many_starts(surface, bounds, starts)) {
    const auto near = [&](const CriticalPoint& p) { return (p.uv - uv).cwiseQuotient(bounds.sizes()).norm() < 1e-6; };
    const bool there = std::any_of(found.points.begin(), found.points.end(), near);
    EXPECT_TRUE(there || has_level(found, evaluate_point(surface, uv).z()))
        << uv.transpose() << " in " << bounds.min().transpose() << ", " << bounds.max().transpose();
  }
}

/// A graph z over the plane: x and y of the poles at the Greville abscissae, so that x = u and y = v.
BSplineSurface height_field(int degree_u, int degree_v, std::vector<double> knots_u, std::vector<double> knots_v,
                            const std::function<double(int, int)>& z) {
  BSplineSurface s;
  s.degree_u = degree_u;
  s.degree_v = degree_v;
  s.knots_u = std::move(knots_u);
  s.knots_v = std::move(knots_v);
  s.count_u = static_cast<int>(s.knots_u.size()) - degree_u - 1;
  s.count_v = static_cast<int>(s.knots_v.size()) - degree_v - 1;
  const auto greville = [](const std::vector<double>& knots, int degree, int i) {
    double sum = 0.0;
    for (int k = 1; k <= degree; ++k) sum += knots[i + k];
    return sum / degree;
  };
  for (int i = 0; i < s.count_u; ++i) {
    for (int j = 0; j < s.count_v; ++j) {
      s.poles.emplace_back(greville(s.knots_u, degree_u, i), greville(s.knots_v, degree_v, j), z(i, j));
    }
  }
  return s;
}

std::vector<double> uniform_knots(int degree, int spans) {
  std::vector<double> knots(degree + 1, 0.0);
  for (int i = 1; i < spans; ++i) knots.push_back(i);
  knots.insert(knots.end(), degree + 1, spans);
  return knots;
}

BSplineSurface random_field(RandomGeometry& random, int degree_u, int degree_v, int spans, bool rational) {
  // One span where the degree is 1, so that there are no creases.
  BSplineSurface s =
      height_field(degree_u, degree_v, uniform_knots(degree_u, degree_u == 1 ? 1 : spans),
                   uniform_knots(degree_v, degree_v == 1 ? 1 : spans), [&](int, int) { return random.real(-1, 1); });
  if (rational) s.weights = random.weights(s.poles.size());
  return s;
}

/// The nets of a rational form as one spline with knots at whole numbers.
BSplineSurface as_spline(const RationalForm& form) {
  const BezierPatch& last = form.patches.back();
  BSplineSurface s;
  s.degree_u = last.degree_u;
  s.degree_v = last.degree_v;
  const int patches_v = static_cast<int>(last.v.hi);
  const int patches_u = static_cast<int>(form.patches.size()) / patches_v;
  const auto knots = [](int degree, int patches) {
    std::vector<double> k(1, 0.0);
    for (int i = 0; i <= patches; ++i) k.insert(k.end(), degree, i);
    k.push_back(patches);
    return k;
  };
  s.knots_u = knots(s.degree_u, patches_u);
  s.knots_v = knots(s.degree_v, patches_v);
  s.count_u = s.degree_u * patches_u + 1;
  s.count_v = s.degree_v * patches_v + 1;
  for (int i = 0; i < s.count_u; ++i) {
    for (int j = 0; j < s.count_v; ++j) {
      const int pu = std::min(i / s.degree_u, patches_u - 1);
      const int pv = std::min(j / s.degree_v, patches_v - 1);
      const Vec4 p =
          form.patches[pu * patches_v + pv].net[(i - pu * s.degree_u) * (s.degree_v + 1) + j - pv * s.degree_v];
      s.poles.push_back(p.head<3>() / p[3]);
      s.weights.push_back(p[3]);
    }
  }
  return s;
}

/// Bernstein coefficients of x^power on [-1, 1] for a cubic.
double cubic_coefficient(int power, int i) {
  constexpr double kTable[4][4] = {
      {1, 1, 1, 1}, {-1, -1.0 / 3, 1.0 / 3, 1}, {1, -1.0 / 3, -1.0 / 3, 1}, {-1, 1, -1, 1}};
  return kTable[power][i];
}

BSplineSurface bicubic(const std::function<double(int, int)>& z) {
  const std::vector<double> knots{-1, -1, -1, -1, 1, 1, 1, 1};
  return height_field(3, 3, knots, knots, z);
}

const Box2 kTurns = box(0, 0, kTwoPi, kTwoPi);

TEST(CriticalPoints, PlanesHaveNone) {
  RandomGeometry random(1);
  for (const Surface& plane : {Surface(Plane{}), Surface(Plane{random_frame(random)})}) {
    const CriticalPoints found = find_critical_points(plane, box(-1, -2, 3, 4));
    EXPECT_TRUE(found.points.empty() && found.levels.empty() && found.complete);
  }
}

TEST(CriticalPoints, CylindersAndConesHaveNoneInGeneral) {
  RandomGeometry random(2);
  for (int i = 0; i < 100; ++i) {
    const Frame f = random_frame(random, i % 2 == 1);
    for (const Surface& s : {Surface(Cylinder{f, 2.0}), Surface(Cone{f, 2.0, 0.3})}) {
      const CriticalPoints found = find_critical_points(s, box(0, -3, kTwoPi, 3));
      EXPECT_TRUE(found.points.empty() && found.levels.empty() && found.complete);
    }
  }
  EXPECT_TRUE(find_critical_points(Cylinder{Frame{}, 2.0}, box(0, -3, kTwoPi, 3)).levels.empty());
}

TEST(CriticalPoints, AHorizontalCylinderHasItsTopAndBottomAsLevels) {
  const Cylinder lying{frame_along(Vec3::UnitY()), 2.0};
  EXPECT_EQ(find_critical_points(lying, box(0, -3, kTwoPi, 3)).levels.size(), 2u);
  EXPECT_TRUE(has_level(find_critical_points(lying, box(0, -3, kTwoPi, 3)), 8.0, 1e-14));
  EXPECT_TRUE(has_level(find_critical_points(lying, box(0, -3, kTwoPi, 3)), 4.0, 1e-14));
  // A quarter of it has but one of them, or none.
  std::size_t levels = 0;
  for (int k = 0; k < 4; ++k) {
    levels += find_critical_points(lying, box(k * kPi / 2 + 0.1, 0, (k + 1) * kPi / 2 + 0.1, 3)).levels.size();
  }
  EXPECT_EQ(levels, 2u);
  const Cylinder nearly{frame_along(Vec3(0, 1, 1e-13)), 2.0};
  EXPECT_EQ(find_critical_points(nearly, box(0, -3, kTwoPi, 3)).levels.size(), 2u);
}

TEST(CriticalPoints, AConeMayLieOnAHorizontalRuling) {
  const double angle = 0.4;
  const Cone cone{frame_along(Vec3(0, std::cos(angle), std::sin(angle))), 2.0, angle};
  const CriticalPoints found = find_critical_points(cone, box(0, 0, kTwoPi, 3));
  ASSERT_EQ(found.levels.size(), 1u);
  // The lower ruling sinks below the axis at u of the frame's lowest direction.
  double lowest_gradient = 1.0, z = 0.0;
  for (int i = 0; i < 100000; ++i) {
    const SurfacePoint at = evaluate(Surface(cone), Vec2(i * kTwoPi / 100000, 1.0));
    const double gradient = std::abs(at.du.z()) + std::abs(at.dv.z());
    if (gradient < lowest_gradient) z = at.point.z();
    lowest_gradient = std::min(lowest_gradient, gradient);
  }
  EXPECT_LT(lowest_gradient, 1e-3);
  EXPECT_NEAR(found.levels[0], z, 1e-6);
}

TEST(CriticalPoints, SpheresHaveATopAndABottom) {
  RandomGeometry random(3);
  for (int i = 0; i < 100; ++i) {
    const Sphere sphere{random_frame(random, i % 2 == 1), 2.5};
    const CriticalPoints found = find_critical_points(sphere, box(0, -kPi / 2, kTwoPi, kPi / 2));
    ASSERT_EQ(found.points.size(), 2u);
    expect_stationary(sphere, found);
    for (const CriticalPoint& p : found.points) {
      const double side = p.kind == CriticalKind::maximum ? 1.0 : -1.0;
      EXPECT_NEAR(p.z, sphere.frame.origin.z() + side * 2.5, 1e-13);
    }
    EXPECT_EQ(morse_sum(found), 2);
    EXPECT_EQ(find_critical_points(sphere, box(0, -kPi / 2, 2 * kTwoPi, kPi / 2)).points.size(), 4u);
  }
}

TEST(CriticalPoints, AnUprightSphereHasThemAtItsPoles) {
  const CriticalPoints found = find_critical_points(Sphere{Frame{}, 2.0}, box(1, -kPi / 2, 2, kPi / 2));
  ASSERT_EQ(found.points.size(), 2u);
  EXPECT_NEAR(found.points[0].z * found.points[1].z, -4.0, 1e-14);
  EXPECT_EQ(find_critical_points(Sphere{Frame{}, 2.0}, box(1, 0, 2, kPi / 2)).points.size(), 1u);
}

TEST(CriticalPoints, ToriHaveFourByMorse) {
  RandomGeometry random(4);
  for (int i = 0; i < 100; ++i) {
    const Torus torus{random_frame(random, i % 2 == 1), 4.0, 1.5};
    const CriticalPoints found = find_critical_points(torus, box(0.1, 0.2, 0.1 + kTwoPi, 0.2 + kTwoPi));
    ASSERT_EQ(found.points.size(), 4u);
    EXPECT_TRUE(found.levels.empty());
    EXPECT_EQ(count(found, CriticalKind::maximum), 1);
    EXPECT_EQ(morse_sum(found), 0);
    expect_stationary(torus, found);
    expect_all_of_many_starts(torus, kTurns, 12);
  }
}

TEST(CriticalPoints, CopiesCountInEveryPeriodWithinBounds) {
  const Torus torus{tilted(0.3), 4.0, 1.5};
  EXPECT_EQ(find_critical_points(torus, box(0.1, 0.2, 0.1 + 2 * kTwoPi, 0.2 + 3 * kTwoPi)).points.size(), 24u);
  EXPECT_FALSE(find_critical_points(torus, box(0, 0, 1e9, 1e9)).complete);
}

TEST(CriticalPoints, AVerticalTorusHasTwoCircles) {
  const Torus torus{Frame{}, 4.0, 1.5};
  const CriticalPoints found = find_critical_points(torus, kTurns);
  EXPECT_TRUE(found.points.empty());
  ASSERT_EQ(found.levels.size(), 2u);
  EXPECT_NEAR(found.levels[0], -1.5, 1e-15);
  EXPECT_NEAR(found.levels[1], 1.5, 1e-15);
  EXPECT_EQ(find_critical_points(torus, box(0, 0, kTwoPi, kPi)).levels.size(), 1u);
}

TEST(CriticalPoints, ATorusThatHardlyLeansIsCovered) {
  for (const double angle : {1e-15, 1e-12, 1e-9, 1e-8, 1e-7, 1e-6, 1e-4}) {
    const Torus torus{tilted(angle), 4.0, 1.5};
    const CriticalPoints found = find_critical_points(torus, kTurns);
    for (const double side : {-1.0, 1.0}) {
      for (const double end : {-1.0, 1.0}) {
        const double z = 3.0 + side * 4.0 * std::sin(angle) + end * 1.5;
        const bool at_point = std::any_of(found.points.begin(), found.points.end(),
                                          [&](const auto& p) { return std::abs(p.z - z) < 1e-13; });
        EXPECT_TRUE(at_point || has_level(found, z)) << angle;
      }
    }
    EXPECT_EQ(found.points.size(), angle > 2e-8 ? 4u : 0u) << angle;
  }
}

TEST(CriticalPoints, SpindleToriHaveAllTheirs) {
  RandomGeometry random(5);
  for (int i = 0; i < 30; ++i) {
    const Torus torus{random_frame(random), 1.0, 2.0};
    const CriticalPoints found = find_critical_points(torus, kTurns);
    EXPECT_EQ(morse_sum(found), 0);
    expect_stationary(torus, found);
    expect_all_of_many_starts(torus, kTurns, 12);
  }
}

TEST(CriticalPoints, ExtrusionsHaveLevelsOnlyIfHorizontal) {
  const Ellipse<3> ellipse{Vec3(0, 0, 5), Vec3(2, 0, 1), Vec3(0, 0, 3)};
  EXPECT_TRUE(find_critical_points(Extrusion{ellipse, Vec3(0, 0.6, 0.8)}, box(0, 0, kTwoPi, 1)).levels.empty());
  const CriticalPoints found = find_critical_points(Extrusion{ellipse, Vec3::UnitY()}, box(0, 0, kTwoPi, 1));
  ASSERT_EQ(found.levels.size(), 2u);
  EXPECT_NEAR(found.levels[0], 5 - std::sqrt(10.0), 1e-14);
  EXPECT_NEAR(found.levels[1], 5 + std::sqrt(10.0), 1e-14);
}

TEST(CriticalPoints, AnExtrudedSplineHasLevelsAtExtremaCornersAndFlatsOnly) {
  // Rises, a corner at the top, falls, runs level at 1, rises with a knot on the way.
  const BSplineCurve<3> profile{
      1, {0, 0, 1, 2, 3, 4, 5, 5}, {{0, 0, 0}, {1, 0, 3}, {2, 0, 1}, {3, 0, 1}, {4, 0, 2}, {5, 0, 4}}, {}};
  const CriticalPoints found = find_critical_points(Extrusion{profile, Vec3::UnitY()}, box(0, 0, 5, 1));
  EXPECT_EQ(found.levels, (std::vector<double>{1.0, 3.0}));
  EXPECT_TRUE(found.points.empty());
}

TEST(CriticalPoints, ARevolvedCircleIsATorus) {
  RandomGeometry random(6);
  for (int i = 0; i < 50; ++i) {
    const Frame f = i == 0 ? Frame{} : random_frame(random);
    const Torus torus{f, 4.0, 1.5};
    const double turned = random.real(-3, 3);
    const Vec3 out = std::cos(turned) * f.x + std::sin(turned) * f.y;
    const Ellipse<3> circle{f.origin + 4.0 * out, 1.5 * out, 1.5 * f.z};
    const Revolution revolved{circle, f.origin, f.z};
    const Box2 bounds = box(0.1, 0.2, 0.1 + kTwoPi, 0.2 + kTwoPi);
    const CriticalPoints found = find_critical_points(revolved, bounds);
    CriticalPoints expected = find_critical_points(torus, bounds);
    expect_stationary(revolved, found);
    ASSERT_EQ(found.points.size(), expected.points.size());
    ASSERT_EQ(found.levels.size(), expected.levels.size());
    for (const double level : expected.levels) EXPECT_TRUE(has_level(found, level, 1e-13));
    for (const CriticalPoint& p : expected.points) {
      EXPECT_TRUE(std::any_of(found.points.begin(), found.points.end(),
                              [&](const auto& q) { return std::abs(p.z - q.z) < 1e-12 && p.kind == q.kind; }));
    }
  }
}

TEST(CriticalPoints, RevolvedLinesAndSplinesMeetManyStarts) {
  RandomGeometry random(7);
  for (int i = 0; i < 40; ++i) {
    // Skew to the axis, so hyperboloids and their like.
    const Vec3 axis = random.point<3>().normalized();
    const Revolution hyperboloid{Line<3>{Vec3(5, 1, 2), Vec3(0.3, 1, 2)}, Vec3(1, 0, 0), axis};
    expect_all_of_many_starts(hyperboloid, box(0, -2, kTwoPi, 2), 15);
    BSplineCurve<3> curve{3, {0, 0, 0, 0, 1, 2, 2, 2, 2}, {}, {}};
    for (int k = 0; k < 5; ++k) curve.poles.push_back(random.point<3>());
    expect_all_of_many_starts(Revolution{curve, Vec3(20, 0, 0), axis}, box(0, 0, kTwoPi, 2), 15);
    // In a plane with the axis.
    const Vec3 out = axis.cross(random.point<3>()).normalized();
    for (Vec3& pole : curve.poles) pole = random.real(5, 20) * out + random.real(-20, 20) * axis;
    expect_all_of_many_starts(Revolution{curve, Vec3::Zero(), axis}, box(0, 0, kTwoPi, 2), 15);
  }
}

TEST(CriticalPoints, ARevolvedHorizontalRulingIsALevel) {
  const Vec3 axis = Vec3(0, 1, 1).normalized();
  const Revolution cone{Line<3>{Vec3(0, 0, 0), Vec3(0, 1, 0)}, Vec3::Zero(), axis};
  const CriticalPoints found = find_critical_points(cone, box(-0.5, 1, 0.5, 3));
  EXPECT_TRUE(has_level(found, 0.0, 1e-12));
}

TEST(CriticalPoints, ARevolvedCornerIsAnExtremum) {
  const Vec3 axis = Vec3::UnitX();
  // A ridge 5 mm from a horizontal axis.
  const BSplineCurve<3> ridge{1, {0, 0, 1, 2, 2}, {{-1, 4, 0}, {0, 5, 0}, {1, 4, 0}}, {}};
  const CriticalPoints found = find_critical_points(Revolution{ridge, Vec3::Zero(), axis}, box(0, 0, kTwoPi, 2));
  ASSERT_EQ(found.points.size(), 2u);
  EXPECT_EQ(morse_sum(found), 2);
  for (const CriticalPoint& p : found.points) EXPECT_NEAR(std::abs(p.z), 5.0, 1e-14);
}

TEST(CriticalPoints, RandomFieldsMeetManyStarts) {
  RandomGeometry random(8);
  const int degrees[][2] = {{3, 3}, {2, 2}, {1, 3}, {3, 2}, {5, 5}, {13, 1}, {8, 8}, {6, 11}, {1, 1}};
  for (const auto& [m, n] : degrees) {
    for (const bool rational : {false, true}) {
      for (int i = 0; i < 4; ++i) {
        const BSplineSurface s = random_field(random, m, n, m * n > 30 ? 2 : 4, rational);
        expect_all_of_many_starts(s, domain(s), 40);
      }
    }
  }
}

TEST(CriticalPoints, SurfacesInSpaceMeetManyStarts) {
  RandomGeometry random(9);
  for (int i = 0; i < 20; ++i) {
    BSplineSurface s = random.surface(3, 3, 1, i % 2 == 1);
    expect_all_of_many_starts(s, domain(s), 40);
    for (Vec3& pole : s.poles) pole += Vec3(1e4, -1e4, 1e4);
    expect_all_of_many_starts(s, domain(s), 40);
    const Vec2 part = 0.25 * domain(s).sizes();
    expect_all_of_many_starts(s, Box2(domain(s).min() + part, domain(s).max() - part), 20);
    expect_all_of_many_starts(FittedSurface{s, 1e-6, "offset"}, domain(s), 20);
  }
}

TEST(CriticalPoints, EveryCellWhereBothSlopesChangeSignHasOneNear) {
  RandomGeometry random(10);
  constexpr int kCells = 200;
  for (int i = 0; i < 5; ++i) {
    const BSplineSurface s = random_field(random, 3, 3, 5, i % 2 == 1);
    const CriticalPoints found = find_critical_points(s, domain(s));
    std::vector<Vec2> slopes;
    for (int k = 0; k < (kCells + 1) * (kCells + 1); ++k) {
      const Vec2 uv = 5.0 / kCells * Vec2(k / (kCells + 1), k % (kCells + 1));
      const SurfacePoint at = evaluate(s, uv);
      slopes.emplace_back(at.du.z(), at.dv.z());
    }
    // Winding of the gradient round a cell: +1 an extremum, -1 a saddle inside.
    for (int k = 0; k < kCells * kCells; ++k) {
      const int a = (k / kCells) * (kCells + 1) + k % kCells;
      const int round[5] = {a, a + kCells + 1, a + kCells + 2, a + 1, a};
      double angle = 0.0;
      for (int c = 0; c < 4; ++c) {
        const Vec2 p = slopes[round[c]], q = slopes[round[c + 1]];
        angle += std::atan2(p[0] * q[1] - p[1] * q[0], p.dot(q));
      }
      const int winding = static_cast<int>(std::lround(angle / kTwoPi));
      const Vec2 lo = 5.0 / kCells * Vec2(k / kCells, k % kCells);
      int inside = 0;
      for (const CriticalPoint& p : found.points) {
        const bool here = ((p.uv - lo).array() >= 0.0).all() && ((p.uv - lo).array() < 5.0 / kCells).all();
        if (here) inside += p.kind == CriticalKind::saddle ? -1 : 1;
      }
      EXPECT_EQ(inside, winding) << lo.transpose();
    }
  }
}

TEST(CriticalPoints, AFlatSplineIsOneLevel) {
  BSplineSurface s = height_field(3, 3, uniform_knots(3, 4), uniform_knots(3, 4), [](int, int) { return 7.25; });
  EXPECT_EQ(find_critical_points(s, domain(s)).levels, std::vector<double>{7.25});
  RandomGeometry random(11);
  for (Vec3& pole : s.poles) pole.z() += random.real(-1e-10, 1e-10);
  const CriticalPoints found = find_critical_points(s, domain(s));
  EXPECT_EQ(found.levels.size(), 1u);
  EXPECT_TRUE(has_level(found, 7.25));
  EXPECT_TRUE(found.points.empty() && found.complete);
}

TEST(CriticalPoints, APlateauInASplineIsALevel) {
  // Zero but for one high pole far away: some patches are horizontal, the hill has its top.
  const BSplineSurface s = height_field(3, 3, uniform_knots(3, 12), uniform_knots(3, 12),
                                        [](int i, int j) { return i == 4 && j == 4 ? 1.0 : 0.0; });
  const CriticalPoints found = find_critical_points(s, domain(s));
  EXPECT_TRUE(has_level(found, 0.0));
  EXPECT_LE(found.levels.size(), 4u);
  EXPECT_EQ(count(found, CriticalKind::maximum), 1);
}

TEST(CriticalPoints, ALyingCylinderAsSplineHasTwoLevels) {
  for (const double turn : {0.0, 0.3}) {
    Frame f = frame_along(Vec3::UnitY());
    const Vec3 x = std::cos(turn) * f.x + std::sin(turn) * f.z.cross(f.x);
    f = {f.origin, x, f.z.cross(x), f.z};
    const BSplineSurface s = as_spline(rational_form(Cylinder{f, 2.0}, box(0, 0, kTwoPi, 1.0)));
    const CriticalPoints found = find_critical_points(s, domain(s));
    EXPECT_TRUE(found.complete);
    EXPECT_EQ(found.levels.size(), 2u) << turn;
    EXPECT_TRUE(has_level(found, 4.0, 1e-9) && has_level(found, 8.0, 1e-9)) << turn;
  }
}

TEST(CriticalPoints, ToriAsSplinesEqualTori) {
  for (const double angle : {0.0, 1e-3, 0.4, 1.2}) {
    const Torus torus{tilted(angle), 4.0, 1.5};
    const BSplineSurface s = as_spline(rational_form(torus, box(0.3, 0.2, 0.3 + kTwoPi, 0.2 + kTwoPi)));
    const CriticalPoints expected = find_critical_points(torus, kTurns);
    const CriticalPoints found = find_critical_points(s, domain(s));
    EXPECT_TRUE(found.complete);
    EXPECT_EQ(found.points.size(), expected.points.size()) << angle;
    EXPECT_EQ(found.levels.size(), expected.levels.size()) << angle;
    EXPECT_EQ(morse_sum(found), 0);
    for (const CriticalPoint& p : expected.points) {
      EXPECT_TRUE(std::any_of(found.points.begin(), found.points.end(),
                              [&](const auto& q) { return std::abs(q.z - p.z) < 1e-12 && q.kind == p.kind; }));
    }
    for (const double z : expected.levels) EXPECT_TRUE(has_level(found, z, 1e-9));
  }
}

TEST(CriticalPoints, SpheresAsSplinesHaveTwo) {
  for (const double angle : {0.4, 1.2, 2.0}) {
    const Sphere sphere{tilted(angle), 2.0};
    const BSplineSurface s = as_spline(rational_form(sphere, box(0.3, -kPi / 2, 0.3 + kTwoPi, kPi / 2)));
    const CriticalPoints found = find_critical_points(s, domain(s));
    EXPECT_EQ(found.points.size(), 2u) << angle;
    EXPECT_EQ(morse_sum(found), 2);
    EXPECT_TRUE(found.complete);
  }
  const BSplineSurface s = as_spline(rational_form(Sphere{Frame{}, 2.0}, box(0, -kPi / 2, kTwoPi, kPi / 2)));
  const CriticalPoints found = find_critical_points(s, domain(s));
  EXPECT_TRUE(has_level(found, 2.0) && has_level(found, -2.0));
  EXPECT_LE(found.levels.size(), 2u);
}

TEST(CriticalPoints, AMonkeySaddleIsAFlatPointAndALevel) {
  const BSplineSurface s = bicubic([](int i, int j) {
    return 5.0 + cubic_coefficient(3, i) - 3.0 * cubic_coefficient(1, i) * cubic_coefficient(2, j);
  });
  const CriticalPoints found = find_critical_points(s, domain(s));
  EXPECT_TRUE(found.complete);
  ASSERT_EQ(found.points.size(), 1u);
  EXPECT_LT(found.points[0].uv.norm(), 1e-6);
  EXPECT_NEAR(found.points[0].z, 5.0, 1e-12);
  EXPECT_EQ(found.points[0].kind, CriticalKind::flat);
  EXPECT_TRUE(has_level(found, 5.0, 1e-12));
}

TEST(CriticalPoints, ADiagonalValleyIsALevel) {
  // z = (u + v)^2: its bottom is a line across the net.
  const BSplineSurface s = bicubic([](int i, int j) {
    return cubic_coefficient(2, i) + 2.0 * cubic_coefficient(1, i) * cubic_coefficient(1, j) + cubic_coefficient(2, j);
  });
  const CriticalPoints found = find_critical_points(s, domain(s));
  EXPECT_TRUE(found.complete);
  EXPECT_EQ(found.levels.size(), 1u);
  EXPECT_TRUE(has_level(found, 0.0, 1e-9));
  EXPECT_TRUE(found.points.empty());
}

TEST(CriticalPoints, ARoofHasItsRidge) {
  const auto roof = [](double slope) {
    return height_field(1, 1, {0, 0, 1, 2, 2}, {0, 0, 3, 3},
                        [slope](int i, int j) { return (i == 1 ? 4.0 : 3.0) + slope * j; });
  };
  const CriticalPoints level = find_critical_points(roof(0.0), box(0, 0, 2, 3));
  EXPECT_EQ(level.levels, std::vector<double>{4.0});
  const CriticalPoints sloping = find_critical_points(roof(0.5), box(0, 0, 2, 3));
  EXPECT_TRUE(sloping.levels.empty() && sloping.points.empty());
}

TEST(CriticalPoints, ACreaseMayHaveAPeakAndAPass) {
  // z = -|u| +- v^2, quadratic along v.
  for (const double side : {-1.0, 1.0}) {
    const BSplineSurface s = height_field(1, 2, {-1, -1, 0, 1, 1}, {-1, -1, -1, 1, 1, 1}, [&](int i, int j) {
      return (i == 1 ? 0.0 : -1.0) + side * (j == 1 ? -1.0 : 1.0);
    });
    const CriticalPoints found = find_critical_points(s, domain(s));
    ASSERT_EQ(found.points.size(), 1u);
    EXPECT_LT(found.points[0].uv.norm(), 1e-9);
    EXPECT_EQ(found.points[0].kind, side < 0 ? CriticalKind::maximum : CriticalKind::saddle);
  }
}

TEST(CriticalPoints, AKnotNearAPointOnACreaseDoesNotHideItsKind) {
  // The same with a knot beside the point: v^2 has the products of two neighbouring knots as poles.
  constexpr double kKnot = 1e-5;
  const std::array<double, 4> square{1.0, -kKnot, kKnot, 1.0};
  for (const double side : {-1.0, 1.0}) {
    const BSplineSurface s = height_field(1, 2, {-1, -1, 0, 1, 1}, {-1, -1, -1, kKnot, 1, 1, 1}, [&](int i, int j) {
      return (i == 1 ? 7.0 : 6.0) + side * square[static_cast<std::size_t>(j)];
    });
    const CriticalPoints found = find_critical_points(s, domain(s));
    ASSERT_EQ(found.points.size(), 1u);
    EXPECT_EQ(found.points[0].kind, side < 0 ? CriticalKind::maximum : CriticalKind::saddle);
  }
}

TEST(CriticalPoints, CreasedFieldsFollowMorse) {
  // With a low rim a disc again, of any degrees and knots.
  RandomGeometry random(21);
  for (int k = 0; k < 60; ++k) {
    const BSplineSurface knots = random.surface(random.integer(1, 4), random.integer(1, 4), 5, false);
    const BSplineSurface s =
        height_field(knots.degree_u, knots.degree_v, knots.knots_u, knots.knots_v, [&](int i, int j) {
          const bool rim = i == 0 || j == 0 || i + 1 == knots.count_u || j + 1 == knots.count_v;
          return rim ? -2.0 : random.real(-1, 1);
        });
    CriticalPoints found = find_critical_points(s, domain(s));
    std::erase_if(found.points, [](const CriticalPoint& p) { return p.z < -2.0 + 1e-9; });
    EXPECT_EQ(morse_sum(found), 1) << k;
    EXPECT_TRUE(found.complete);
  }
}

TEST(CriticalPoints, CornersOfAFacettedFieldFollowMorse) {
  // Random heights of a bilinear grid with a low rim: a disc sewn to a point below, so the sum is 2 with that point.
  RandomGeometry random(12);
  for (int k = 0; k < 10; ++k) {
    const int n = 8;
    const BSplineSurface s = height_field(1, 1, uniform_knots(1, n), uniform_knots(1, n), [&](int i, int j) {
      const bool rim = i == 0 || j == 0 || i == n || j == n;
      return rim ? -2.0 : random.real(-1, 1);
    });
    CriticalPoints found = find_critical_points(s, domain(s));
    // The rim is level, so both slopes vanish in its corners.
    std::erase_if(found.points, [](const CriticalPoint& p) { return p.z < -2.0 + 1e-9; });
    EXPECT_EQ(morse_sum(found), 1);
    EXPECT_TRUE(found.complete);
  }
}

/// Is there an extremum of the samples in the window that beats its rim? On a slanting ridge a coarse grid pretends so.
bool has_extremum_inside(const Surface& surface, const Box2& window, double sign) {
  constexpr int kCells = 120;
  double inside = -1e300, rim = -1e300;
  for (int a = 0; a <= kCells; ++a) {
    for (int b = 0; b <= kCells; ++b) {
      const Vec2 uv = window.min() + window.sizes().cwiseProduct(Vec2(a, b)) / kCells;
      const bool on_rim = a == 0 || b == 0 || a == kCells || b == kCells;
      double& best = on_rim ? rim : inside;
      best = std::max(best, sign * evaluate_point(surface, uv).z());
    }
  }
  return inside > rim;
}

/// Windows of a coarse grid around its extrema, by what is there.
struct SampledExtremum {
  Box2 window;
  CriticalKind kind;
};

std::vector<SampledExtremum> sampled_extrema(const BSplineSurface& s) {
  constexpr int kCells = 300;
  const Vec2 step = domain(s).sizes() / kCells;
  const auto place = [&](int a, int b) -> Vec2 { return domain(s).min() + step.cwiseProduct(Vec2(a, b)); };
  std::vector<double> z;
  for (int k = 0; k < (kCells + 1) * (kCells + 1); ++k) {
    z.push_back(evaluate_point(s, place(k / (kCells + 1), k % (kCells + 1))).z());
  }
  std::vector<SampledExtremum> extrema;
  for (int a = 2; a < kCells - 1; ++a) {
    for (int b = 2; b < kCells - 1; ++b) {
      int above = 0, below = 0;
      for (int k = 0; k < 25; ++k) {
        const double rise = z[(a + k / 5 - 2) * (kCells + 1) + b + k % 5 - 2] - z[a * (kCells + 1) + b];
        above += rise > 0.0 ? 1 : 0;
        below += rise < 0.0 ? 1 : 0;
      }
      if (above < 24 && below < 24) continue;
      const Box2 window(place(a - 2, b - 2), place(a + 2, b + 2));
      if (!has_extremum_inside(s, window, above == 24 ? -1.0 : 1.0)) continue;
      extrema.push_back({window, above == 24 ? CriticalKind::minimum : CriticalKind::maximum});
    }
  }
  return extrema;
}

TEST(CriticalPoints, ExtremaOfCreasedSurfacesAreThoseOfDenseSamples) {
  RandomGeometry random(15);
  std::size_t seen = 0;
  for (int k = 0; k < 30; ++k) {
    // Inner knots of every multiplicity up to the degree.
    const BSplineSurface knots = random.surface(random.integer(1, 4), random.integer(1, 4), 4, false);
    BSplineSurface s = height_field(knots.degree_u, knots.degree_v, knots.knots_u, knots.knots_v,
                                    [&](int, int) { return random.real(-1, 1); });
    if (k % 2 == 1) s.weights = random.weights(s.poles.size());
    const CriticalPoints found = find_critical_points(s, domain(s));
    EXPECT_TRUE(found.complete);
    for (const SampledExtremum& extremum : sampled_extrema(s)) {
      ++seen;
      const auto there = [&](const CriticalPoint& p) {
        return extremum.window.contains(p.uv) && p.kind == extremum.kind;
      };
      EXPECT_TRUE(std::any_of(found.points.begin(), found.points.end(), there))
          << k << " at " << extremum.window.center().transpose();
    }
  }
  EXPECT_GT(seen, 50u);
}

TEST(CriticalPoints, NothingFiniteGivesNothing) {
  const double inf = std::numeric_limits<double>::infinity();
  RandomGeometry random(13);
  BSplineSurface s = random_field(random, 3, 3, 3, true);
  for (const Box2& bounds : {box(0, 0, kNotANumber, 1), box(0, 0, 1, inf), box(kNotANumber, 0, kNotANumber, 1)}) {
    for (const Surface& surface : {Surface(s), Surface(Torus{Frame{}, 2, 1}), Surface(Cylinder{Frame{}, 1})}) {
      const CriticalPoints found = find_critical_points(surface, bounds);
      EXPECT_TRUE(found.points.empty() && found.levels.empty() && !found.complete);
    }
  }
  s.poles[5].z() = kNotANumber;
  EXPECT_FALSE(find_critical_points(s, domain(s)).complete);
  EXPECT_FALSE(find_critical_points(Torus{Frame{}, 2, kNotANumber}, kTurns).complete);
  EXPECT_TRUE(find_critical_points(Torus{Frame{}, 2, 1}, Box2()).complete);
  EXPECT_TRUE(find_critical_points(Torus{Frame{}, 2, 1}, Box2()).levels.empty());
}

TEST(CriticalPoints, TheSearchIsFastEnoughForEveryFace) {
  RandomGeometry random(14);
  const int degrees[][3] = {{3, 3, 17}, {13, 1, 2}, {8, 8, 2}, {6, 11, 2}, {5, 5, 6}};
  for (const auto& [m, n, spans] : degrees) {
    for (const bool rational : {false, true}) {
      const BSplineSurface s = random_field(random, m, n, spans, rational);
      const auto start = std::chrono::steady_clock::now();
      const CriticalPoints found = find_critical_points(s, domain(s));
      const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
      EXPECT_TRUE(found.complete);
      // Ten times what it takes, for machines with more to do.
      EXPECT_LT(took.count(), 500.0) << m << " x " << n;
      RecordProperty("ms_" + std::to_string(m) + "x" + std::to_string(n) + (rational ? "r" : ""),
                     std::to_string(took.count()));
    }
  }
}

}  // namespace
}  // namespace lamella
