#include "model/rational_form.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <limits>

#include "core/error.h"
#include "model/evaluate.h"
#include "tests/model/random_geometry.h"

namespace lamella {
namespace {

using test::RandomGeometry;

Box2 box(double u0, double v0, double u1, double v1) { return {Vec2(u0, v0), Vec2(u1, v1)}; }

Frame tilted_frame() {
  const Mat3 axes = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  return {Vec3(4, -5, 6), axes.col(0), axes.col(1), axes.col(2)};
}

struct Case {
  const char* name;
  Surface surface;
  Box2 bounds;
};

std::vector<Case> cases() {
  RandomGeometry random(41);
  const Frame f = tilted_frame();
  const Ellipse<3> ellipse{Vec3(5, 0, 1), Vec3(2, 0, 0), Vec3(0.5, 0, 1)};
  const Parabola<3> parabola{Vec3(5, 0, 1), Vec3(1, 0, 0.2), Vec3(0, 0, 1)};
  const Hyperbola<3> hyperbola{Vec3(5, 0, 1), Vec3(1, 0, 0), Vec3(0, 0.2, 1)};
  const Line<3> line{Vec3(3, 1, 0), Vec3(0.1, 0, 2)};
  const auto spline = random.curve<3>(3, 3, true);
  const Interval t{spline.knots.front(), spline.knots.back()};
  const auto surface = random.surface(3, 4, 4, true);
  const Interval u = surface.domain_u();
  const Interval v = surface.domain_v();
  const Vec3 axis = Vec3(0.1, 0.2, 1).normalized();
  return {{"plane", Plane{f}, box(-3, 2, 5, 9)},
          {"cylinder", Cylinder{f, 3.0}, box(0, -2, kTwoPi, 7)},
          {"padded cylinder", Cylinder{f, 3.0}, box(-0.01, -2, kTwoPi + 0.01, 7)},
          {"cone", Cone{f, 2.0, 0.4}, box(1, 0, 6, 5)},
          {"cone with apex", Cone{f, 2.0, -0.5}, box(0, -1, kTwoPi, 2.0 / std::sin(0.5))},
          {"sphere", Sphere{f, 5.0}, box(0, -0.5 * kPi, kTwoPi, 0.5 * kPi)},
          {"sphere band", Sphere{f, 5.0}, box(7, -0.2, 9, 1.1)},
          {"torus", Torus{f, 6.0, 2.0}, box(0, 0, kTwoPi, kTwoPi)},
          {"spindle torus", Torus{f, 1.0, 2.0}, box(0, -2, kTwoPi, 2)},
          {"extruded line", Extrusion{line, axis}, box(-1, -2, 4, 3)},
          {"extruded ellipse", Extrusion{ellipse, axis}, box(0.3, -2, 5, 3)},
          {"extruded parabola", Extrusion{parabola, axis}, box(-2, -2, 3, 3)},
          {"extruded hyperbola", Extrusion{hyperbola, axis}, box(-2.2, -2, 1.9, 3)},
          {"extruded spline", Extrusion{spline, axis}, box(t.lo, -2, t.hi, 3)},
          {"revolved line", Revolution{line, Vec3(0, 1, 2), axis}, box(0, -1, kTwoPi, 2)},
          {"revolved ellipse", Revolution{ellipse, Vec3(0, 1, 2), axis}, box(0.1, 0, 6, kTwoPi)},
          {"revolved parabola", Revolution{parabola, Vec3(0, 1, 2), axis}, box(0, -1, 2, 2)},
          {"revolved hyperbola", Revolution{hyperbola, Vec3(0, 1, 2), axis}, box(0, -2, 2, 2)},
          {"revolved spline", Revolution{spline, Vec3(0, 1, 2), axis}, box(0, t.lo, kTwoPi, t.hi)},
          {"spline", surface, box(u.lo, v.lo, u.hi, v.hi)},
          {"part of a spline", surface, box(u.lo + 0.2, v.lo + 0.1, u.hi - 0.3, v.hi - 0.2)},
          {"fitted", FittedSurface{surface, 1e-6, "offset"}, box(u.lo, v.lo, u.hi, v.hi)}};
}

TEST(RationalForm, EqualsTheSurfaceThroughTheParameterMaps) {
  RandomGeometry random(42);
  for (const Case& c : cases()) {
    const RationalForm form = rational_form(c.surface, c.bounds);
    ASSERT_FALSE(form.patches.empty()) << c.name;
    for (const BezierPatch& patch : form.patches) {
      for (int i = 0; i < 20; ++i) {
        const Vec2 st(random.real(patch.u.lo, patch.u.hi), random.real(patch.v.lo, patch.v.hi));
        const Vec3 expected = evaluate_point(c.surface, form.to_surface(st));
        const double scale = 10.0 + expected.norm();
        EXPECT_LT((evaluate_point(patch, st[0], st[1]) - expected).norm(), 1e-14 * 5.0 * scale) << c.name;
      }
    }
  }
}

TEST(RationalForm, CoversTheBoundsExactlyOnce) {
  for (const Case& c : cases()) {
    const RationalForm form = rational_form(c.surface, c.bounds);
    double area = 0.0;
    Box2 covered;
    for (const BezierPatch& patch : form.patches) {
      const Vec2 low = form.to_surface({patch.u.lo, patch.v.lo});
      const Vec2 high = form.to_surface({patch.u.hi, patch.v.hi});
      ASSERT_TRUE((low.array() < high.array()).all()) << c.name;
      area += (high - low).prod();
      covered.extend(low).extend(high);
    }
    EXPECT_EQ(covered.min(), c.bounds.min()) << c.name;
    EXPECT_EQ(covered.max(), c.bounds.max()) << c.name;
    EXPECT_NEAR(area, c.bounds.volume(), 1e-12 * c.bounds.volume()) << c.name;
  }
}

TEST(RationalForm, ParameterMapsRoundTripToAFewUlps) {
  RandomGeometry random(43);
  constexpr double kUlp = std::numeric_limits<double>::epsilon();
  for (const Case& c : cases()) {
    const RationalForm form = rational_form(c.surface, c.bounds);
    for (int i = 0; i < 2000; ++i) {
      const Vec2 uv = c.bounds.min() + c.bounds.sizes().cwiseProduct(Vec2(random.real(0, 1), random.real(0, 1)));
      const Vec2 st = form.from_surface(uv);
      const Vec2 back = form.to_surface(st);
      // s carries a piece's index, so it resolves its angle to an ulp of s times du/ds <= 2.
      const Vec2 ulps = kUlp * (uv.cwiseAbs() + 2.0 * st.cwiseAbs() + Vec2::Ones());
      EXPECT_LE(std::abs(back[0] - uv[0]), 2.0 * ulps[0]) << c.name;
      EXPECT_LE(std::abs(back[1] - uv[1]), 2.0 * ulps[1]) << c.name;
    }
  }
}

TEST(RationalForm, ParameterMapsAreExactAtTheEndsAndMonotone) {
  for (const Case& c : cases()) {
    const RationalForm form = rational_form(c.surface, c.bounds);
    for (const BezierPatch& patch : form.patches) {
      double before = -1e300;
      for (int i = 0; i <= 1000; ++i) {
        const double s = patch.u.lo + patch.u.length() * (i / 1000.0);
        const double u = form.to_surface({s, patch.v.lo})[0];
        ASSERT_GT(u, before) << c.name;
        before = u;
      }
    }
    const BezierPatch& first = form.patches.front();
    const BezierPatch& last = form.patches.back();
    EXPECT_EQ(form.to_surface({first.u.lo, first.v.lo}), c.bounds.min()) << c.name;
    EXPECT_EQ(form.to_surface({last.u.hi, last.v.hi}), c.bounds.max()) << c.name;
    EXPECT_EQ(form.from_surface(c.bounds.min()), Vec2(first.u.lo, first.v.lo)) << c.name;
    EXPECT_EQ(form.from_surface(c.bounds.max()), Vec2(last.u.hi, last.v.hi)) << c.name;
  }
}

TEST(RationalForm, WeightsArePositiveAndBoxesHoldSamples) {
  RandomGeometry random(44);
  for (const Case& c : cases()) {
    const RationalForm form = rational_form(c.surface, c.bounds);
    for (const BezierPatch& patch : form.patches) {
      for (const Vec4& point : patch.net) ASSERT_GT(point[3], 0.0) << c.name;
      Box3 hull = control_box(patch);
      hull.min().array() -= 1e-13 * 100.0;
      hull.max().array() += 1e-13 * 100.0;
      for (int i = 0; i < 50; ++i) {
        const Vec2 st(random.real(patch.u.lo, patch.u.hi), random.real(patch.v.lo, patch.v.hi));
        EXPECT_TRUE(hull.contains(evaluate_point(c.surface, form.to_surface(st)))) << c.name;
      }
    }
  }
}

TEST(RationalForm, QuadricsSatisfyTheirImplicitEquations) {
  RandomGeometry random(45);
  const Frame f;  // at the origin, so that nothing but the form itself is tested
  const auto check = [&](const Surface& surface, const Box2& bounds, auto&& residual) {
    const RationalForm form = rational_form(surface, bounds);
    for (const BezierPatch& patch : form.patches) {
      for (int i = 0; i < 200; ++i) {
        const Vec3 p = evaluate_point(patch, random.real(patch.u.lo, patch.u.hi), random.real(patch.v.lo, patch.v.hi));
        EXPECT_LT(std::abs(residual(p)), 1e-14) << surface_type_name(surface);
      }
    }
  };
  check(Cylinder{f, 3.0}, box(0, -1, kTwoPi, 1), [](const Vec3& p) { return p.head<2>().norm() / 3.0 - 1.0; });
  check(Sphere{f, 5.0}, box(0, -2, kTwoPi, 2), [](const Vec3& p) { return p.norm() / 5.0 - 1.0; });
  check(Cone{f, 2.0, 0.5}, box(0, -1, kTwoPi, 3), [](const Vec3& p) {
    const double radius = 2.0 + p[2] * std::tan(0.5);
    return p.head<2>().norm() / radius - 1.0;
  });
  check(Torus{f, 6.0, 2.0}, box(0, 0, kTwoPi, kTwoPi),
        [](const Vec3& p) { return (std::hypot(p.head<2>().norm() - 6.0, p[2]) - 2.0) / 8.0; });
}

TEST(RationalForm, CoversASphereNoFurtherThanItsPoles) {
  const RationalForm form = rational_form(Sphere{Frame{}, 1.0}, box(0, -2, kTwoPi, 2));
  EXPECT_EQ(form.breaks_v.front(), -0.5 * kPi);
  EXPECT_EQ(form.breaks_v.back(), 0.5 * kPi);
}

TEST(RationalForm, SplitsArcsAtNinetyDegreesAtMost) {
  EXPECT_EQ(rational_form(Cylinder{Frame{}, 1.0}, box(0, 0, kTwoPi, 1)).patches.size(), 4u);
  EXPECT_EQ(rational_form(Cylinder{Frame{}, 1.0}, box(0, 0, kTwoPi + 1e-9, 1)).patches.size(), 5u);
  EXPECT_EQ(rational_form(Torus{Frame{}, 3.0, 1.0}, box(0, 0, kTwoPi, kPi)).patches.size(), 8u);
}

TEST(RationalForm, RefusesInfiniteAndHugeBounds) {
  const double inf = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {inf, nan, 1e100, 1e11}) {
    EXPECT_THROW((void)rational_form(Plane{}, box(0, 0, 1, bad)), GeometryError) << bad;
    EXPECT_THROW((void)rational_form(Cylinder{Frame{}, 1.0}, box(0, -bad, 1, 1)), GeometryError) << bad;
  }
  EXPECT_THROW((void)rational_form(Cylinder{Frame{}, 1.0}, box(0, 0, 1e6, 1)), GeometryError);
  EXPECT_THROW((void)rational_form(Torus{Frame{}, 3.0, 1.0}, box(0, 0, 5000, 5000)), GeometryError);
  EXPECT_THROW((void)rational_form(Cylinder{Frame{}, nan}, box(0, 0, 1, 1)), GeometryError);
  const Hyperbola<3> hyperbola{Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()};
  EXPECT_THROW((void)rational_form(Extrusion{hyperbola, Vec3::UnitZ()}, box(0, 0, 800, 1)), GeometryError);
}

TEST(RationalForm, HasNoPatchesOverNothing) {
  EXPECT_TRUE(rational_form(Plane{}, Box2()).patches.empty());
  EXPECT_TRUE(rational_form(Plane{}, box(0, 1, 5, 1)).patches.empty());
}

TEST(RationalPieces, HaveTheShapeOfEveryCurveType) {
  RandomGeometry random(46);
  const auto spline = random.curve<2>(4, 3, true);
  const Interval domain{spline.knots.front(), spline.knots.back()};
  const std::vector<std::pair<Curve2, Interval>> curves{
      {Line<2>{Vec2(1, 2), Vec2(3, -1)}, {-2, 5}},
      {Ellipse<2>{Vec2(1, 2), Vec2(3, 0), Vec2(1, 2)}, {0.5, 0.5 + kTwoPi}},
      {Parabola<2>{Vec2(1, 2), Vec2(3, 0), Vec2(1, 2)}, {-1, 2}},
      {Hyperbola<2>{Vec2(1, 2), Vec2(3, 0), Vec2(1, 2)}, {-2, 2.5}},
      {spline, {domain.lo + 0.1, domain.hi - 0.1}},
      {spline, {domain.hi, domain.lo}}};
  for (const auto& [curve, range] : curves) {
    const auto pieces = rational_pieces(curve, range);
    ASSERT_FALSE(pieces.empty());
    EXPECT_EQ(pieces.front().t.lo, range.lo);
    EXPECT_EQ(pieces.back().t.hi, range.hi);
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      const BezierCurve2& piece = pieces[k];
      if (k > 0) {
        EXPECT_EQ(piece.t.lo, pieces[k - 1].t.hi);
      }
      for (const double t : {piece.t.lo, piece.t.hi}) {
        EXPECT_LT((evaluate_point(piece, t) - evaluate<2>(curve, t).point).norm(), 1e-13 * 20.0);
      }
      // Between the ends the parameter differs; the nearest point of the curve must be the same.
      for (double r = 0.05; r < 1.0; r += 0.1) {
        const Vec2 p = evaluate_point(piece, piece.t.lo + r * piece.t.length());
        double t = piece.t.lo + r * piece.t.length();
        for (int i = 0; i < 50; ++i) {
          const CurvePoint<2> at = evaluate<2>(curve, t);
          t += at.dt.dot(p - at.point) / at.dt.squaredNorm();
        }
        EXPECT_LT((evaluate<2>(curve, t).point - p).norm(), 1e-12) << "curve type " << curve.index();
      }
    }
  }
}

TEST(RationalPieces, OfAnEmptyRangeAreNone) {
  EXPECT_TRUE(rational_pieces(Line<2>{Vec2(0, 0), Vec2(1, 0)}, {1, 1}).empty());
}

TEST(RationalPieces, RefuseInfiniteRanges) {
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_THROW((void)rational_pieces(Line<2>{Vec2(0, 0), Vec2(1, 0)}, {0, inf}), GeometryError);
  EXPECT_THROW((void)rational_pieces(Line<2>{Vec2(0, 0), Vec2(1, 0)}, {std::nan(""), 1}), GeometryError);
}

}  // namespace
}  // namespace lamella
