#include "datasets/generator/shapes.h"

#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_MakeSolid.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepLib.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <Precision.hxx>
#include <ShapeUpgrade_UnifySameDomain.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColStd_Array2OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <gp_Ax2.hxx>
#include <gp_Pln.hxx>
#include <numbers>
#include <stdexcept>

namespace lamella::datasets {
namespace {

/// Distinct knots with multiplicities. A closed uniform knot vector becomes OpenCASCADE's periodic form.
struct Knots {
  TColStd_Array1OfReal values;
  TColStd_Array1OfInteger multiplicities;
  bool periodic;
};

Knots compressed(const std::vector<double>& flat, int degree) {
  const bool periodic = flat.front() < flat[degree];
  const std::vector<double> used = periodic ? std::vector<double>(flat.begin() + degree, flat.end() - degree) : flat;
  std::vector<double> values;
  std::vector<int> counts;
  for (const double k : used) {
    if (values.empty() || k != values.back()) {
      values.push_back(k);
      counts.push_back(1);
    } else {
      ++counts.back();
    }
  }
  const int n = static_cast<int>(values.size());
  Knots result{TColStd_Array1OfReal(1, n), TColStd_Array1OfInteger(1, n), periodic};
  for (int i = 0; i < n; ++i) {
    result.values(i + 1) = values[i];
    result.multiplicities(i + 1) = counts[i];
  }
  return result;
}

gp_Pnt to_point(const Point& p) { return {p[0], p[1], p[2]}; }
gp_Dir to_direction(const Point& p) { return {p[0], p[1], p[2]}; }

TopTools_ListOfShape list_of(const std::vector<TopoDS_Shape>& shapes, std::size_t from = 0) {
  TopTools_ListOfShape list;
  for (std::size_t i = from; i < shapes.size(); ++i) list.Append(shapes[i]);
  return list;
}

TopoDS_Shape finished(BRepAlgoAPI_BooleanOperation& operation) {
  operation.SetRunParallel(false);
  operation.Build();
  if (!operation.IsDone()) throw std::runtime_error("boolean operation failed");
  ShapeUpgrade_UnifySameDomain unify(operation.Shape(), true, true, false);
  unify.Build();
  return unify.Shape();
}

}  // namespace

Handle(Geom_BSplineCurve) to_geom(const SplineCurve& curve) {
  const Knots knots = compressed(curve.knots, curve.degree);
  const int count = static_cast<int>(curve.poles.size()) - (knots.periodic ? curve.degree : 0);
  TColgp_Array1OfPnt poles(1, count);
  TColStd_Array1OfReal weights(1, count);
  for (int i = 0; i < count; ++i) {
    poles(i + 1) = to_point(curve.poles[i]);
    weights(i + 1) = curve.weights.empty() ? 1.0 : curve.weights[i];
  }
  Handle(Geom_BSplineCurve) result =
      new Geom_BSplineCurve(poles, weights, knots.values, knots.multiplicities, curve.degree, knots.periodic);
  if (knots.periodic) result->SetNotPeriodic();
  return result;
}

Handle(Geom_BSplineSurface) to_geom(const SplineSurface& s) {
  const Knots u = compressed(s.knots_u, s.degree_u), v = compressed(s.knots_v, s.degree_v);
  const int total_u = static_cast<int>(s.poles.size()) / s.count_v;
  const int nu = total_u - (u.periodic ? s.degree_u : 0), nv = s.count_v - (v.periodic ? s.degree_v : 0);
  TColgp_Array2OfPnt poles(1, nu, 1, nv);
  TColStd_Array2OfReal weights(1, nu, 1, nv);
  for (int i = 0; i < nu; ++i) {
    for (int j = 0; j < nv; ++j) {
      const std::size_t k = static_cast<std::size_t>(i) * s.count_v + j;
      poles(i + 1, j + 1) = to_point(s.poles[k]);
      weights(i + 1, j + 1) = s.weights.empty() ? 1.0 : s.weights[k];
    }
  }
  Handle(Geom_BSplineSurface) result =
      new Geom_BSplineSurface(poles, weights, u.values, v.values, u.multiplicities, v.multiplicities, s.degree_u,
                              s.degree_v, u.periodic, v.periodic);
  if (u.periodic) result->SetUNotPeriodic();
  if (v.periodic) result->SetVNotPeriodic();
  return result;
}

gp_Trsf translation(double x, double y, double z) {
  gp_Trsf t;
  t.SetTranslation(gp_Vec(x, y, z));
  return t;
}

gp_Trsf rotation(const gp_Ax1& axis, double angle) {
  gp_Trsf t;
  t.SetRotation(axis, angle);
  return t;
}

TopoDS_Shape moved(const TopoDS_Shape& shape, const gp_Trsf& transform) {
  return BRepBuilderAPI_Transform(shape, transform, true).Shape();
}

TopoDS_Shape box(double x0, double y0, double z0, double x1, double y1, double z1) {
  return BRepPrimAPI_MakeBox(gp_Pnt(x0, y0, z0), gp_Pnt(x1, y1, z1)).Shape();
}

TopoDS_Shape cylinder(const Point& base, const Point& direction, double radius, double height) {
  return BRepPrimAPI_MakeCylinder(gp_Ax2(to_point(base), to_direction(direction)), radius, height).Shape();
}

TopoDS_Shape sphere(const Point& centre, double radius) {
  return BRepPrimAPI_MakeSphere(to_point(centre), radius).Shape();
}

TopoDS_Shape torus(const Point& centre, const Point& axis, double major, double minor) {
  return BRepPrimAPI_MakeTorus(gp_Ax2(to_point(centre), to_direction(axis)), major, minor).Shape();
}

TopoDS_Shape revolved_polygon(const std::vector<ProfilePoint>& corners, char axis) {
  BRepBuilderAPI_MakePolygon polygon;
  for (const auto& [axial, radial] : corners)
    polygon.Add(axis == 'x' ? gp_Pnt(axial, radial, 0) : gp_Pnt(radial, 0, axial));
  polygon.Close();
  const TopoDS_Face face = BRepBuilderAPI_MakeFace(polygon.Wire(), true);
  const gp_Dir direction = axis == 'x' ? gp_Dir(1, 0, 0) : gp_Dir(0, 0, 1);
  TopoDS_Solid solid = only_solid(BRepPrimAPI_MakeRevol(face, gp_Ax1(gp_Pnt(0, 0, 0), direction)).Shape());
  BRepLib::OrientClosedSolid(solid);
  return solid;
}

double revolved_polygon_volume(const std::vector<ProfilePoint>& corners) {
  double moment = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto& [x0, y0] = corners[i];
    const auto& [x1, y1] = corners[(i + 1) % corners.size()];
    moment += (x0 * y1 - x1 * y0) * (y0 + y1) / 6;
  }
  return 2 * std::numbers::pi * std::abs(moment);
}

TopoDS_Shape revolved_graph(const SplineCurve& profile, double from, double to) {
  Handle(Geom_BSplineCurve) curve = Handle(Geom_BSplineCurve)::DownCast(to_geom(profile)->Copy());
  curve->Segment(from, to);
  const gp_Pnt a = curve->StartPoint(), b = curve->EndPoint();
  const gp_Pnt foot_a(a.X(), 0, 0), foot_b(b.X(), 0, 0);
  BRepBuilderAPI_MakeWire wire;
  wire.Add(BRepBuilderAPI_MakeEdge(curve));
  if (b.Y() > Precision::Confusion()) wire.Add(BRepBuilderAPI_MakeEdge(b, foot_b));
  wire.Add(BRepBuilderAPI_MakeEdge(foot_b, foot_a));
  if (a.Y() > Precision::Confusion()) wire.Add(BRepBuilderAPI_MakeEdge(foot_a, a));
  const TopoDS_Face face = BRepBuilderAPI_MakeFace(wire.Wire(), true);
  TopoDS_Solid solid = only_solid(BRepPrimAPI_MakeRevol(face, gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0))).Shape());
  BRepLib::OrientClosedSolid(solid);
  return solid;
}

TopoDS_Shape prism(const std::vector<std::array<double, 2>>& corners, double z0, double z1) {
  BRepBuilderAPI_MakePolygon polygon;
  for (const auto& c : corners) polygon.Add(gp_Pnt(c[0], c[1], z0));
  polygon.Close();
  const TopoDS_Face face = BRepBuilderAPI_MakeFace(polygon.Wire(), true);
  TopoDS_Solid solid = only_solid(BRepPrimAPI_MakePrism(face, gp_Vec(0, 0, z1 - z0)).Shape());
  BRepLib::OrientClosedSolid(solid);
  return solid;
}

double polygon_area(const std::vector<std::array<double, 2>>& corners) {
  double twice = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto& a = corners[i];
    const auto& b = corners[(i + 1) % corners.size()];
    twice += a[0] * b[1] - b[0] * a[1];
  }
  return twice / 2;
}

TopoDS_Shape fuse(const std::vector<TopoDS_Shape>& shapes) {
  BRepAlgoAPI_Fuse operation;
  TopTools_ListOfShape first;
  first.Append(shapes.at(0));
  operation.SetArguments(first);
  operation.SetTools(list_of(shapes, 1));
  return finished(operation);
}

TopoDS_Shape cut(const TopoDS_Shape& from, const std::vector<TopoDS_Shape>& tools) {
  BRepAlgoAPI_Cut operation;
  TopTools_ListOfShape first;
  first.Append(from);
  operation.SetArguments(first);
  operation.SetTools(list_of(tools));
  return finished(operation);
}

TopoDS_Shape common(const TopoDS_Shape& a, const TopoDS_Shape& b) {
  BRepAlgoAPI_Common operation;
  TopTools_ListOfShape first, second;
  first.Append(a);
  second.Append(b);
  operation.SetArguments(first);
  operation.SetTools(second);
  return finished(operation);
}

TopoDS_Solid only_solid(const TopoDS_Shape& shape) {
  TopoDS_Solid solid;
  int count = 0;
  for (TopExp_Explorer e(shape, TopAbs_SOLID); e.More(); e.Next()) {
    solid = TopoDS::Solid(e.Current());
    ++count;
  }
  if (count != 1) throw std::runtime_error("expected one solid, got " + std::to_string(count));
  return solid;
}

TopoDS_Solid with_voids(const TopoDS_Shape& outer, const std::vector<TopoDS_Shape>& cavities) {
  const auto shell_of = [](const TopoDS_Shape& s) {
    return TopoDS::Shell(TopExp_Explorer(only_solid(s), TopAbs_SHELL).Current());
  };
  BRepBuilderAPI_MakeSolid maker(shell_of(outer));
  for (const TopoDS_Shape& cavity : cavities) maker.Add(TopoDS::Shell(shell_of(cavity).Reversed()));
  return maker.Solid();
}

TopoDS_Solid sewn(const std::vector<TopoDS_Face>& faces) {
  BRepBuilderAPI_Sewing sewing(1e-6);
  for (const TopoDS_Face& face : faces) sewing.Add(face);
  sewing.Perform();
  if (sewing.NbFreeEdges() > 0) throw std::runtime_error("sewn faces leave free edges");
  TopExp_Explorer shells(sewing.SewedShape(), TopAbs_SHELL);
  TopoDS_Solid solid = BRepBuilderAPI_MakeSolid(TopoDS::Shell(shells.Current()));
  BRepLib::OrientClosedSolid(solid);
  return solid;
}

TopoDS_Face natural_face(const Handle(Geom_Surface) & surface) {
  return BRepBuilderAPI_MakeFace(surface, Precision::Confusion());
}

TopoDS_Face cap(const std::vector<Handle(Geom_Curve)>& outer, const std::vector<Handle(Geom_Curve)>& inner) {
  const auto wire_of = [](const std::vector<Handle(Geom_Curve)>& curves) {
    BRepBuilderAPI_MakeWire wire;
    for (const auto& c : curves) wire.Add(BRepBuilderAPI_MakeEdge(c));
    return wire.Wire();
  };
  const TopoDS_Face face = BRepBuilderAPI_MakeFace(wire_of(outer), true);
  if (inner.empty()) return face;
  BRepBuilderAPI_MakeFace with_hole(face);
  TopoDS_Wire hole = wire_of(inner);
  with_hole.Add(TopoDS::Wire(hole.Reversed()));
  return with_hole.Face();
}

}  // namespace lamella::datasets
