#include "model/evaluate.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/model/random_geometry.h"

namespace lamella {
namespace {

using test::RandomGeometry;

Frame random_frame(RandomGeometry& random, bool left_handed) {
  const Eigen::AngleAxisd turn(random.real(0.0, 6.0), random.point<3>().normalized());
  const Mat3 axes = turn.toRotationMatrix();
  return {random.point<3>(100.0), axes.col(0), axes.col(1), left_handed ? Vec3(-axes.col(2)) : Vec3(axes.col(2))};
}

std::vector<Curve3> curves(RandomGeometry& random) {
  return {Line<3>{random.point<3>(), random.point<3>()},
          Ellipse<3>{random.point<3>(), random.point<3>(), random.point<3>()},
          Parabola<3>{random.point<3>(), random.point<3>(), random.point<3>()},
          Hyperbola<3>{random.point<3>(), random.point<3>(), random.point<3>()},
          random.curve<3>(3, 1, false),
          random.curve<3>(5, 1, true)};
}

std::vector<Surface> surfaces(RandomGeometry& random) {
  std::vector<Surface> result;
  for (const bool left : {false, true}) {
    const Frame frame = random_frame(random, left);
    result.insert(result.end(), {Plane{frame}, Cylinder{frame, 3.0}, Cone{frame, 2.0, 0.4}, Cone{frame, 2.0, -0.4},
                                 Sphere{frame, 5.0}, Torus{frame, 6.0, 2.0}});
  }
  for (const Curve3& curve : curves(random)) {
    result.push_back(Extrusion{curve, random.point<3>().normalized()});
    result.push_back(Revolution{curve, random.point<3>(), random.point<3>().normalized()});
  }
  result.push_back(random.surface(3, 4, 1, false));
  result.push_back(random.surface(2, 5, 1, true));
  result.push_back(FittedSurface{random.surface(3, 3, 1, true), 1e-6, "offset surface"});
  return result;
}

/// Parameters inside the domain of `surface`, [0.3, 0.7] where it has none.
Vec2 inner_parameters(RandomGeometry& random, const Surface& surface) {
  const BSplineSurface* spline = std::get_if<BSplineSurface>(&surface);
  if (const auto* fitted = std::get_if<FittedSurface>(&surface)) spline = &fitted->fit;
  const Vec2 at(random.real(0.3, 0.7), random.real(0.3, 0.7));
  if (spline != nullptr) {
    return {spline->domain_u().lo + at[0] * spline->domain_u().length(),
            spline->domain_v().lo + at[1] * spline->domain_v().length()};
  }
  const auto within = [](const Curve3& curve, double t) {
    const auto* b = std::get_if<BSplineCurve<3>>(&curve);
    return b == nullptr ? t : b->knots.front() + t * (b->knots.back() - b->knots.front());
  };
  if (const auto* e = std::get_if<Extrusion>(&surface)) return {within(e->basis, at[0]), at[1]};
  if (const auto* r = std::get_if<Revolution>(&surface)) return {at[0], within(r->meridian, at[1])};
  return at;
}

TEST(Evaluate, SurfaceDerivativesEqualDifferenceQuotients) {
  RandomGeometry random(11);
  constexpr double kStep = 1e-5;
  for (const Surface& surface : surfaces(random)) {
    const Vec2 uv = inner_parameters(random, surface);
    const Vec2 du(kStep, 0.0);
    const Vec2 dv(0.0, kStep);
    const SurfacePoint2 at = evaluate2(surface, uv);
    const auto quotient = [&](const Vec2& step, auto&& value) -> Vec3 {
      return (value(uv + step) - value(uv - step)) / (2.0 * kStep);
    };
    const auto point = [&](const Vec2& p) -> Vec3 { return evaluate_point(surface, p); };
    const auto tangent_u = [&](const Vec2& p) -> Vec3 { return evaluate(surface, p).du; };
    const auto tangent_v = [&](const Vec2& p) -> Vec3 { return evaluate(surface, p).dv; };
    const double scale = 1.0 + at.du.norm() + at.dv.norm() + at.duu.norm() + at.duv.norm() + at.dvv.norm();
    const double tolerance = 2e-6 * scale;
    const char* name = surface_type_name(surface);
    EXPECT_LT((at.du - quotient(du, point)).norm(), tolerance) << name;
    EXPECT_LT((at.dv - quotient(dv, point)).norm(), tolerance) << name;
    EXPECT_LT((at.duu - quotient(du, tangent_u)).norm(), tolerance) << name;
    EXPECT_LT((at.duv - quotient(dv, tangent_u)).norm(), tolerance) << name;
    EXPECT_LT((at.duv - quotient(du, tangent_v)).norm(), tolerance) << name;
    EXPECT_LT((at.dvv - quotient(dv, tangent_v)).norm(), tolerance) << name;
  }
}

TEST(Evaluate, LowerOrdersAgreeWithHigherOnes) {
  RandomGeometry random(12);
  for (const Surface& surface : surfaces(random)) {
    const Vec2 uv = inner_parameters(random, surface);
    const SurfacePoint2 second = evaluate2(surface, uv);
    const SurfacePoint first = evaluate(surface, uv);
    EXPECT_EQ(evaluate_point(surface, uv), second.point);
    EXPECT_EQ(first.point, second.point);
    EXPECT_EQ(first.du, second.du);
    EXPECT_EQ(first.dv, second.dv);
  }
}

TEST(Evaluate, CurveDerivativesEqualDifferenceQuotients) {
  RandomGeometry random(13);
  constexpr double kStep = 1e-5;
  for (const Curve3& curve : curves(random)) {
    const auto* spline = std::get_if<BSplineCurve<3>>(&curve);
    const double t = spline == nullptr ? 0.4 : 0.6 * spline->knots.front() + 0.4 * spline->knots.back();
    const CurvePoint2<3> at = evaluate2<3>(curve, t);
    const CurvePoint<3> above = evaluate<3>(curve, t + kStep);
    const CurvePoint<3> below = evaluate<3>(curve, t - kStep);
    const double tolerance = 2e-6 * (1.0 + at.dt.norm() + at.dtt.norm());
    EXPECT_LT((at.dt - (above.point - below.point) / (2.0 * kStep)).norm(), tolerance) << curve.index();
    EXPECT_LT((at.dtt - (above.dt - below.dt) / (2.0 * kStep)).norm(), tolerance) << curve.index();
  }
}

TEST(Evaluate, QuadricsSatisfyTheirEquationsAndNormals) {
  RandomGeometry random(14);
  for (int round = 0; round < 200; ++round) {
    const Frame f = random_frame(random, round % 2 == 1);
    const double handed = round % 2 == 1 ? -1.0 : 1.0;
    const Vec2 uv(random.real(-7.0, 7.0), random.real(-1.5, 1.5));
    const auto local = [&](const Vec3& p) -> Vec3 {
      return {(p - f.origin).dot(f.x), (p - f.origin).dot(f.y), (p - f.origin).dot(f.z)};
    };
    const auto radius = [&](const Vec3& p) { return std::hypot(local(p)[0], local(p)[1]); };

    const SurfacePoint cylinder = evaluate(Cylinder{f, 3.0}, uv);
    EXPECT_NEAR(radius(cylinder.point), 3.0, 1e-13 * 100.0);
    const Vec3 outward = std::cos(uv[0]) * f.x + std::sin(uv[0]) * f.y;
    EXPECT_LT((cylinder.normal() - handed * 3.0 * outward).norm(), 1e-14 * 10.0);

    const SurfacePoint sphere = evaluate(Sphere{f, 5.0}, uv);
    EXPECT_NEAR((sphere.point - f.origin).norm(), 5.0, 1e-13 * 100.0);
    const Vec3 radial = (sphere.point - f.origin) * (5.0 * std::cos(uv[1]));
    EXPECT_LT((sphere.normal() - handed * radial).norm(), 1e-12 * 25.0);

    const SurfacePoint cone = evaluate(Cone{f, 2.0, 0.3}, uv);
    EXPECT_NEAR(radius(cone.point), 2.0 + std::tan(0.3) * local(cone.point)[2], 1e-12 * 10.0);
    const Vec3 slant = std::cos(0.3) * outward - std::sin(0.3) * f.z;
    EXPECT_LT((cone.normal() - handed * (2.0 + uv[1] * std::sin(0.3)) * slant).norm(), 1e-13 * 10.0);

    const SurfacePoint torus = evaluate(Torus{f, 6.0, 2.0}, uv);
    EXPECT_NEAR(std::hypot(radius(torus.point) - 6.0, local(torus.point)[2]), 2.0, 1e-13 * 100.0);
    const Vec3 tube = std::cos(uv[1]) * outward + std::sin(uv[1]) * f.z;
    EXPECT_LT((torus.normal() - handed * 2.0 * (6.0 + 2.0 * std::cos(uv[1])) * tube).norm(), 1e-13 * 20.0);
  }
}

TEST(Evaluate, BSplinesEqualTheirDefinition) {
  RandomGeometry random(15);
  for (int round = 0; round < 26; ++round) {
    const BSplineSurface surface = random.surface(1 + round % 13, 1 + (3 * round) % 13, 3, round % 2 == 0);
    for (int i = 0; i < 10; ++i) {
      const double u = i == 0 ? surface.domain_u().hi : random.real(surface.domain_u().lo, surface.domain_u().hi);
      const double v = random.real(surface.domain_v().lo, surface.domain_v().hi);
      EXPECT_LT((evaluate_point(surface, {u, v}) - test::point_by_definition(surface, u, v)).norm(), 1e-12);
    }
  }
}

TEST(Evaluate, ClampsParametersOutsideABSplinesDomain) {
  RandomGeometry random(16);
  const BSplineSurface surface = random.surface(3, 2, 3, true);
  const double u = surface.domain_u().hi;
  const double v = surface.domain_v().lo;
  EXPECT_EQ(evaluate_point(surface, {u + 1.0, v - 1.0}), evaluate_point(surface, {u, v}));
  EXPECT_LT((evaluate_point(surface, {u, v}) - surface.poles[(surface.count_u - 1) * surface.count_v]).norm(), 1e-13);
}

TEST(Evaluate, KeepsDerivativesAccurateFarFromTheOrigin) {
  RandomGeometry random(17);
  BSplineSurface near = random.surface(3, 3, 2, true);
  BSplineSurface far = near;
  const Vec3 offset(2e4, -2e4, 1e4);
  for (Vec3& pole : far.poles) pole = (pole + offset).eval();
  for (std::size_t i = 0; i < near.poles.size(); ++i) near.poles[i] = far.poles[i] - offset;
  const Vec2 uv(near.domain_u().middle(), near.domain_v().middle());
  const SurfacePoint expected = evaluate(near, uv);
  EXPECT_LT((evaluate(far, uv).du - expected.du).norm(), 1e-12 * (1.0 + expected.du.norm()));
}

TEST(Periods, FollowTheType) {
  const Frame frame;
  const Ellipse<3> circle{Vec3(5, 0, 0), Vec3(1, 0, 0), Vec3(0, 0, 1)};
  const Line<3> line{Vec3(1, 0, 0), Vec3(0, 0, 1)};
  EXPECT_EQ(periods(Plane{frame}), Vec2(0, 0));
  EXPECT_EQ(periods(Cylinder{frame, 1.0}), Vec2(kTwoPi, 0));
  EXPECT_EQ(periods(Cone{frame, 1.0, 0.2}), Vec2(kTwoPi, 0));
  EXPECT_EQ(periods(Sphere{frame, 1.0}), Vec2(kTwoPi, 0));
  EXPECT_EQ(periods(Torus{frame, 3.0, 1.0}), Vec2(kTwoPi, kTwoPi));
  EXPECT_EQ(periods(Extrusion{circle, Vec3::UnitY()}), Vec2(kTwoPi, 0));
  EXPECT_EQ(periods(Revolution{circle, Vec3::Zero(), Vec3::UnitZ()}), Vec2(kTwoPi, kTwoPi));
  EXPECT_EQ(periods(Revolution{line, Vec3::Zero(), Vec3::UnitZ()}), Vec2(kTwoPi, 0));
}

}  // namespace
}  // namespace lamella
