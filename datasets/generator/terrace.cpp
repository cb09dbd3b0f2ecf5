#include "datasets/generator/terrace.h"

#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt2d.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <map>

#include "datasets/generator/bernstein.h"
#include "datasets/generator/shapes.h"

namespace lamella::datasets {
namespace {

constexpr double kTolerance = 1e-7;  // mm, OpenCASCADE's least

Handle(Geom2d_BSplineCurve) to_geom2d(const SplineCurve& curve) {
  const int count = static_cast<int>(curve.poles.size());
  TColgp_Array1OfPnt2d poles(1, count);
  TColStd_Array1OfReal weights(1, count), knots(1, 2);
  TColStd_Array1OfInteger multiplicities(1, 2);
  for (int i = 0; i < count; ++i) {
    poles(i + 1) = gp_Pnt2d(curve.poles[i][0], curve.poles[i][1]);
    weights(i + 1) = curve.weights.empty() ? 1.0 : curve.weights[i];
  }
  knots(1) = curve.knots.front();
  knots(2) = curve.knots.back();
  multiplicities.Init(curve.degree + 1);
  return new Geom2d_BSplineCurve(poles, weights, knots, multiplicities, curve.degree);
}

/// Straight segment whose parameter runs from a to b.
SplineCurve line(const Point& from, const Point& to, double a, double b) { return {1, {a, a, b, b}, {from, to}, {}}; }

/// Makes every vertex and edge once, so that neighbouring faces share them.
class Builder {
 public:
  explicit Builder(const Terrace& terrace) : t_(terrace) {}

  TopoDS_Solid solid() {
    TopoDS_Shell shell;
    b_.MakeShell(shell);
    for (const Terrace::Wall& wall : t_.walls)
      for (std::size_t i = 0; i < t_.plans[wall.plan].size(); ++i) b_.Add(shell, wall_face(wall, static_cast<int>(i)));
    for (const Terrace::Roof& roof : t_.roofs) b_.Add(shell, roof_face(roof));
    shell.Closed(true);
    TopoDS_Solid solid;
    b_.MakeSolid(solid);
    b_.Add(solid, shell);
    return solid;
  }

 private:
  struct Lifted {
    TopoDS_Edge edge;
    SplineCurve curve;    ///< in space
    SplineCurve on_wall;  ///< (t, z) on the wall
  };

  Point corner(int plan, int index, int field) const {
    const Plan& p = t_.plans[plan];
    const Point foot = p[index % p.size()].poles.front();
    return t_.fields[field].frame(foot[0], foot[1]).point;
  }

  TopoDS_Vertex vertex(int plan, int index, int field) {
    index %= static_cast<int>(t_.plans[plan].size());
    TopoDS_Vertex& v = vertices_[{plan, index, field}];
    if (v.IsNull()) {
      const Point p = corner(plan, index, field);
      b_.MakeVertex(v, gp_Pnt(p[0], p[1], p[2]), kTolerance);
    }
    return v;
  }

  TopoDS_Edge edge(const SplineCurve& curve, const TopoDS_Vertex& from, const TopoDS_Vertex& to) {
    TopoDS_Edge e;
    b_.MakeEdge(e, to_geom(curve), kTolerance);
    b_.Add(e, from.Oriented(TopAbs_FORWARD));
    b_.Add(e, to.Oriented(TopAbs_REVERSED));
    b_.Range(e, curve.knots.front(), curve.knots.back());
    return e;
  }

  Lifted& lifted(int plan, int index, int field) {
    Lifted& l = lifted_[{plan, index, field}];
    if (l.edge.IsNull()) {
      l.curve = lift(t_.plans[plan][index], t_.fields[field]);
      l.on_wall = over_parameter(l.curve);
      l.edge = edge(l.curve, vertex(plan, index, field), vertex(plan, index + 1, field));
    }
    return l;
  }

  /// The vertical edge at a corner, its parameter is z.
  TopoDS_Edge upright(const Terrace::Wall& wall, int index) {
    index %= static_cast<int>(t_.plans[wall.plan].size());
    TopoDS_Edge& e = uprights_[{wall.plan, index}];
    if (e.IsNull()) {
      const Point a = corner(wall.plan, index, wall.low), b = corner(wall.plan, index, wall.high);
      e = edge(line(a, b, a[2], b[2]), vertex(wall.plan, index, wall.low), vertex(wall.plan, index, wall.high));
    }
    return e;
  }

  TopoDS_Face wall_face(const Terrace::Wall& wall, int index) {
    Lifted& low = lifted(wall.plan, index, wall.low);
    Lifted& high = lifted(wall.plan, index, wall.high);
    TopoDS_Face face;
    b_.MakeFace(face, to_geom(wall_surface(t_.plans[wall.plan][index], low.curve, high.curve)), kTolerance);
    const TopoDS_Edge left = upright(wall, index), right = upright(wall, index + 1);
    b_.UpdateEdge(low.edge, to_geom2d(low.on_wall), face, kTolerance);
    b_.UpdateEdge(high.edge, to_geom2d(high.on_wall), face, kTolerance);
    for (const auto& [side, u] : {std::pair{left, 0.0}, std::pair{right, 1.0}}) {
      double z0, z1;
      BRep_Tool::Range(side, z0, z1);
      b_.UpdateEdge(side, to_geom2d(line({u, z0, 0}, {u, z1, 0}, z0, z1)), face, kTolerance);
    }
    TopoDS_Wire wire;
    b_.MakeWire(wire);
    b_.Add(wire, low.edge);
    b_.Add(wire, right);
    b_.Add(wire, high.edge.Reversed());
    b_.Add(wire, left.Reversed());
    wire.Closed(true);
    b_.Add(face, wire);
    return wall.material_inside ? face : TopoDS::Face(face.Reversed());
  }

  /// Control surface of the plan curve drawn along z, a little beyond what the edges need; its v is z.
  static SplineSurface wall_surface(const SplineCurve& foot, const SplineCurve& low, const SplineCurve& high) {
    double z0 = low.poles[0][2], z1 = z0;
    for (const SplineCurve* c : {&low, &high}) {
      for (const Point& p : c->poles) {
        z0 = std::min(z0, p[2]);
        z1 = std::max(z1, p[2]);
      }
    }
    SplineSurface s{foot.degree, 1, foot.knots, {z0 - 0.5, z0 - 0.5, z1 + 0.5, z1 + 0.5}, 2, {}, {}};
    for (std::size_t i = 0; i < foot.poles.size(); ++i) {
      for (const double z : {z0 - 0.5, z1 + 0.5}) {
        s.poles.push_back({foot.poles[i][0], foot.poles[i][1], z});
        if (!foot.weights.empty()) s.weights.push_back(foot.weights[i]);
      }
    }
    return s;
  }

  TopoDS_Wire loop(const TopoDS_Face& face, int plan, int field) {
    TopoDS_Wire wire;
    b_.MakeWire(wire);
    for (std::size_t i = 0; i < t_.plans[plan].size(); ++i) {
      Lifted& l = lifted(plan, static_cast<int>(i), field);
      b_.UpdateEdge(l.edge, to_geom2d(t_.plans[plan][i]), face, kTolerance);
      b_.Add(wire, l.edge);
    }
    wire.Closed(true);
    return wire;
  }

  TopoDS_Face roof_face(const Terrace::Roof& roof) {
    TopoDS_Face face;
    b_.MakeFace(face, to_geom(t_.fields[roof.field]), kTolerance);
    b_.Add(face, loop(face, roof.outer, roof.field));
    for (const int hole : roof.holes) b_.Add(face, loop(face, hole, roof.field).Reversed());
    return roof.up ? face : TopoDS::Face(face.Reversed());
  }

  const Terrace& t_;
  BRep_Builder b_;
  std::map<std::array<int, 3>, TopoDS_Vertex> vertices_;
  std::map<std::array<int, 3>, Lifted> lifted_;
  std::map<std::array<int, 2>, TopoDS_Edge> uprights_;
};

/// Integral of the field along x from its left border to x, at fixed y.
double strip(const SplineSurface& field, double x, double y) {
  return integrate(field.knots_u.front(), x, [&](double at) { return field.frame(at, y).point[2]; });
}

}  // namespace

SplineSurface height_patch(const Rectangle& r, int degree, const std::function<double(double, double)>& f) {
  SplineSurface s;
  s.degree_u = s.degree_v = degree;
  s.knots_u = clamped_knots({r.x0, r.x1}, degree);
  s.knots_v = clamped_knots({r.y0, r.y1}, degree);
  const auto xs = greville(s.knots_u, degree), ys = greville(s.knots_v, degree);
  s.count_v = static_cast<int>(ys.size());
  for (const double x : xs)
    for (const double y : ys) s.poles.push_back({x, y, f(x, y)});
  return s;
}

SplineSurface raised(SplineSurface patch, double offset) {
  for (Point& p : patch.poles) p[2] += offset;
  return patch;
}

TopoDS_Solid build(const Terrace& terrace) { return Builder(terrace).solid(); }

double volume_under(const SplineSurface& field, const Plan& plan) {
  double sum = 0.0;
  for (const SplineCurve& curve : plan) {
    sum += integrate(
        curve.breaks(),
        [&](double t) {
          const auto [point, slope] = curve.frame(t);
          return strip(field, point[0], point[1]) * slope[1];
        },
        4);
  }
  return sum;
}

double volume(const Terrace& terrace) {
  double sum = 0.0;
  for (const Terrace::Roof& roof : terrace.roofs) {
    double part = volume_under(terrace.fields[roof.field], terrace.plans[roof.outer]);
    for (const int hole : roof.holes) part -= volume_under(terrace.fields[roof.field], terrace.plans[hole]);
    sum += roof.up ? part : -part;
  }
  return sum;
}

Terrace slab(const Plan& outer, const SplineSurface& low, const SplineSurface& high,
             const std::vector<Plan>& openings) {
  Terrace t{{outer}, {low, high}, {{0, false, 0, {}}, {1, true, 0, {}}}, {{0, 0, 1, true}}};
  for (const Plan& opening : openings) {
    const int plan = static_cast<int>(t.plans.size());
    t.plans.push_back(opening);
    t.walls.push_back({plan, 0, 1, false});
    for (Terrace::Roof& roof : t.roofs) roof.holes.push_back(plan);
  }
  return t;
}

}  // namespace lamella::datasets
