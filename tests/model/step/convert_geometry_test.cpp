#include "model/step/convert_geometry.h"

#include <GeomAPI_PointsToBSpline.hxx>
#include <GeomAPI_PointsToBSplineSurface.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierCurve.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_Circle.hxx>
#include <Geom_ConicalSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_Ellipse.hxx>
#include <Geom_Hyperbola.hxx>
#include <Geom_Line.hxx>
#include <Geom_OffsetCurve.hxx>
#include <Geom_OffsetSurface.hxx>
#include <Geom_Parabola.hxx>
#include <Geom_Plane.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_SurfaceOfLinearExtrusion.hxx>
#include <Geom_SurfaceOfRevolution.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <gtest/gtest.h>
#include <vector>

#include "model/evaluate.h"

namespace lamella::step {
namespace {

const gp_Ax3 kAxes(gp_Pnt(1, -2, 3), gp_Dir(1, 2, 2), gp_Dir(2, 1, -2));

gp_Trsf rotation() {
  gp_Trsf trsf;
  trsf.SetRotation(gp_Ax1(gp_Pnt(1, 1, 0), gp_Dir(1, -1, 3)), 1.1);
  return trsf;
}
gp_Trsf mirror() {
  gp_Trsf trsf;
  trsf.SetMirror(gp_Ax2(gp_Pnt(0, 1, 2), gp_Dir(1, 2, -1)));
  return trsf;
}
gp_Trsf point_mirror() {
  gp_Trsf trsf;
  trsf.SetMirror(gp_Pnt(3, 2, 1));
  return trsf;
}
std::vector<gp_Trsf> placements() { return {gp_Trsf(), rotation(), mirror(), mirror() * rotation(), point_mirror()}; }

Handle(Geom_BSplineCurve) periodic_curve() {
  TColgp_Array1OfPnt poles(1, 6);
  TColStd_Array1OfReal knots(1, 7);
  TColStd_Array1OfInteger multiplicities(1, 7);
  for (int i = 1; i <= 6; ++i) poles(i) = gp_Pnt(std::cos(i) * 3, std::sin(i) * 2, 0.1 * i);
  for (int i = 1; i <= 7; ++i) knots(i) = i * 0.5;
  multiplicities.Init(1);
  return new Geom_BSplineCurve(poles, knots, multiplicities, 3, Standard_True);
}

/// An unclamped, not periodic spline, which STEP allows.
Handle(Geom_BSplineCurve) unclamped_curve() {
  TColgp_Array1OfPnt poles(1, 4);
  TColStd_Array1OfReal knots(1, 7);
  TColStd_Array1OfInteger multiplicities(1, 7);
  for (int i = 1; i <= 4; ++i) poles(i) = gp_Pnt(i, i * i, 1.0 / i);
  for (int i = 1; i <= 7; ++i) knots(i) = i;
  multiplicities.Init(1);
  return new Geom_BSplineCurve(poles, knots, multiplicities, 2, Standard_False);
}

Handle(Geom_BezierCurve) rational_bezier() {
  TColgp_Array1OfPnt poles(1, 4);
  TColStd_Array1OfReal weights(1, 4);
  for (int i = 1; i <= 4; ++i) {
    poles(i) = gp_Pnt(i, i % 2, 0.3 * i * i);
    weights(i) = 1.0 + 0.5 * (i % 3);
  }
  return new Geom_BezierCurve(poles, weights);
}

void expect_same(const Handle(Geom_Curve) & original, const Interval& range, double tolerance) {
  for (const gp_Trsf& trsf : placements()) {
    const Curve3 curve = convert_curve(original, placement_of(trsf), range, tolerance);
    for (int i = 0; i <= 60; ++i) {
      const double t = range.lo + range.length() * i / 60.0;
      gp_Pnt expected;
      gp_Vec derivative;
      original->D1(t, expected, derivative);
      expected.Transform(trsf);
      derivative.Transform(trsf);
      const CurvePoint<3> actual = evaluate<3>(curve, t);
      EXPECT_LT((actual.point - Vec3(expected.X(), expected.Y(), expected.Z())).norm(), 1e-12 * 100 + tolerance) << t;
      EXPECT_LT((actual.dt - Vec3(derivative.X(), derivative.Y(), derivative.Z())).norm(), 1e-9 + 1e4 * tolerance) << t;
    }
  }
}

TEST(ConvertGeometry, KeepsEveryCurveAndItsParametrisation) {
  const gp_Ax2 axes = kAxes.Ax2();
  expect_same(new Geom_Line(axes.Axis()), {-3, 4}, 0.0);
  expect_same(new Geom_Circle(axes, 2.5), {-1, 9}, 0.0);
  expect_same(new Geom_Ellipse(axes, 3, 1), {0, 5}, 0.0);
  expect_same(new Geom_Hyperbola(axes, 3, 1), {-1, 2}, 0.0);
  expect_same(new Geom_Parabola(axes, 0.7), {-2, 3}, 0.0);
  expect_same(rational_bezier(), {0, 1}, 0.0);
  expect_same(new Geom_TrimmedCurve(new Geom_Circle(axes, 2.5), 1, 2), {1, 2}, 0.0);
  expect_same(unclamped_curve(), {3, 5}, 0.0);
}

TEST(ConvertGeometry, UnrollsPeriodicCurvesAsFarAsTheRangeGoes) {
  const double first = periodic_curve()->FirstParameter();
  const double period = periodic_curve()->Period();
  expect_same(periodic_curve(), {first, first + period}, 0.0);
  expect_same(periodic_curve(), {first - 0.4 * period, first + 0.5 * period}, 0.0);
  expect_same(periodic_curve(), {first + 1.2 * period, first + 2.1 * period}, 0.0);
}

TEST(ConvertGeometry, FitsOffsetCurvesWithinTheTolerance) {
  expect_same(new Geom_OffsetCurve(rational_bezier(), 0.1, gp_Dir(0, 0, 1)), {0, 1}, 1e-6);
}

void expect_same(const Handle(Geom_Surface) & original, const Box2& uv, double tolerance = 0.0) {
  for (const gp_Trsf& trsf : placements()) {
    const Surface surface = convert_surface(original, placement_of(trsf), uv);
    for (int i = 0; i <= 12; ++i) {
      for (int j = 0; j <= 12; ++j) {
        const Vec2 at = uv.min() + uv.sizes().cwiseProduct(Vec2(i / 12.0, j / 12.0));
        gp_Pnt expected;
        gp_Vec du, dv;
        original->D1(at.x(), at.y(), expected, du, dv);
        expected.Transform(trsf);
        du.Transform(trsf);
        dv.Transform(trsf);
        const SurfacePoint actual = evaluate(surface, at);
        const Vec3 normal = Vec3(du.X(), du.Y(), du.Z()).cross(Vec3(dv.X(), dv.Y(), dv.Z()));
        EXPECT_LT((actual.point - Vec3(expected.X(), expected.Y(), expected.Z())).norm(), 1e-10 + tolerance);
        EXPECT_LT((actual.normal() - normal).norm(), (1e-9 + 1e4 * tolerance) * (1.0 + normal.norm()));
      }
    }
  }
}

Handle(Geom_BSplineSurface) wavy() {
  TColgp_Array2OfPnt points(1, 7, 1, 6);
  for (int i = 1; i <= 7; ++i) {
    for (int j = 1; j <= 6; ++j) points(i, j) = gp_Pnt(i, j, std::sin(i * 0.9) * std::cos(j * 0.7));
  }
  return GeomAPI_PointsToBSplineSurface(points).Surface();
}

Box2 box(double u0, double u1, double v0, double v1) { return {Vec2(u0, v0), Vec2(u1, v1)}; }

TEST(ConvertGeometry, KeepsEverySurfaceItsParametrisationAndItsNormal) {
  expect_same(new Geom_Plane(kAxes), box(-1, 2, -3, 1));
  expect_same(new Geom_CylindricalSurface(kAxes, 2), box(0, 7, -3, 1));
  expect_same(new Geom_ConicalSurface(kAxes, 0.4, 2), box(0, 7, -1, 1));
  expect_same(new Geom_ConicalSurface(kAxes, -0.4, 2), box(0, 7, -1, 1));
  expect_same(new Geom_SphericalSurface(kAxes, 2), box(0, 7, -1.5, 1.5));
  expect_same(new Geom_ToroidalSurface(kAxes, 3, 1), box(0, 7, -1, 6));
  expect_same(new Geom_SurfaceOfLinearExtrusion(rational_bezier(), gp_Dir(1, 1, 3)), box(0, 1, -2, 3));
  expect_same(new Geom_SurfaceOfRevolution(rational_bezier(), gp_Ax1(gp_Pnt(9, 0, 0), gp_Dir(1, 0, 3))),
              box(0, 7, 0, 1));
  expect_same(wavy(), box(0, 1, 0, 1));
  expect_same(new Geom_RectangularTrimmedSurface(wavy(), 0.2, 0.8, 0.1, 0.7), box(0.2, 0.8, 0.1, 0.7));
}

TEST(ConvertGeometry, KeepsLeftHandedAxes) {
  gp_Ax3 left = kAxes;
  left.YReverse();
  expect_same(new Geom_CylindricalSurface(left, 2), box(0, 7, -3, 1));
  expect_same(new Geom_ToroidalSurface(left, 3, 1), box(0, 7, -1, 6));
  expect_same(new Geom_Plane(left), box(-1, 2, -3, 1));
}

TEST(ConvertGeometry, UnrollsPeriodicSurfacesAsFarAsTheTrimsGo) {
  const Handle(Geom_SurfaceOfLinearExtrusion) extrusion =
      new Geom_SurfaceOfLinearExtrusion(periodic_curve(), gp_Dir(0, 0, 1));
  expect_same(extrusion, box(-0.5, 6.5, 0, 1));
  TColgp_Array2OfPnt poles(1, 6, 1, 2);
  for (int i = 1; i <= 6; ++i) {
    for (int j = 1; j <= 2; ++j) poles(i, j) = gp_Pnt(std::cos(i) * j, std::sin(i) * 2, 0.1 * i + j);
  }
  TColStd_Array1OfReal knots(1, 7), ends(1, 2);
  TColStd_Array1OfInteger ones(1, 7), twos(1, 2);
  for (int i = 1; i <= 7; ++i) knots(i) = i * 0.5;
  ones.Init(1);
  twos.Init(2);
  ends(1) = 0;
  ends(2) = 1;
  const Handle(Geom_BSplineSurface) tube = new Geom_BSplineSurface(poles, knots, ends, ones, twos, 3, 1, Standard_True);
  expect_same(tube, box(0.5, 3.5, 0, 1));
  expect_same(tube, box(-1.3, 2.9, 0, 1));
  const Handle(Geom_BSplineSurface) turned = Handle(Geom_BSplineSurface)::DownCast(tube->Copy());
  turned->ExchangeUV();
  expect_same(turned, box(0, 1, 2.2, 5.9));
}

TEST(ConvertGeometry, KeepsOffsetsOfSimpleSurfacesExactAndFitsTheRest) {
  expect_same(new Geom_OffsetSurface(new Geom_CylindricalSurface(kAxes, 2), 0.3), box(0, 7, -3, 1));
  expect_same(new Geom_OffsetSurface(new Geom_ConicalSurface(kAxes, 0.4, 2), 0.3), box(0, 7, -1, 1));
  const Handle(Geom_OffsetSurface) offset = new Geom_OffsetSurface(wavy(), 0.05);
  const Surface fitted = convert_surface(offset, {}, box(0.1, 0.9, 0.1, 0.9));
  ASSERT_TRUE(std::holds_alternative<FittedSurface>(fitted));
  EXPECT_LT(std::get<FittedSurface>(fitted).bound, 1e-4);
  EXPECT_EQ(std::get<FittedSurface>(fitted).origin, "offset surface");
  expect_same(offset, box(0.1, 0.9, 0.1, 0.9), std::get<FittedSurface>(fitted).bound);
}

TEST(ConvertGeometry, ProjectsCurvesOntoPlanesExactly) {
  const Plane plane{{{1, 2, 3}, {0.6, 0.8, 0}, {-0.8, 0.6, 0}, {0, 0, 1}}};
  const gp_Ax2 axes = kAxes.Ax2();
  for (const Handle(Geom_Curve) & original :
       std::vector<Handle(Geom_Curve)>{new Geom_Line(axes.Axis()), new Geom_Circle(axes, 2),
                                       new Geom_Hyperbola(axes, 3, 1), new Geom_Parabola(axes, 1), rational_bezier()}) {
    const Curve3 curve = convert_curve(original, {}, {0, 1});
    const Curve2 image = project_onto(plane, curve);
    for (const double t : {0.0, 0.3, 1.0}) {
      const Vec3 offset = evaluate<3>(curve, t).point - plane.frame.origin;
      const Vec2 expected{offset.dot(plane.frame.x), offset.dot(plane.frame.y)};
      EXPECT_LT((evaluate<2>(image, t).point - expected).norm(), 1e-13 * 100);
    }
  }
}

}  // namespace
}  // namespace lamella::step
