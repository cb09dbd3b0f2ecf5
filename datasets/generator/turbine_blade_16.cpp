#include <BRepBuilderAPI_MakeFace.hxx>
#include <cmath>
#include <numbers>

#include "datasets/generator/catalog.h"
#include "datasets/generator/freeform.h"
#include "datasets/generator/shapes.h"
#include "datasets/generator/terrace.h"

namespace lamella::datasets {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kHeight = 60.0;  // mm, the airfoil stands on z = 0

/// Stations along the height: rotation, size, lean; control values of quadratic to cubic splines in z.
struct Station {
  double z, angle, scale, lean_x, lean_y;
};

std::vector<Station> stations() {
  std::vector<Station> result;
  for (const double z : greville(clamped_knots({0, 20, 40, kHeight}, 3), 3)) {
    const double t = z / kHeight;
    result.push_back({z, 0.50 - 0.75 * t, 1.0 - 0.28 * t, 1.5 * t * t, 3.0 * t * (1 - t)});
  }
  return result;
}

Point placed(const Station& s, double x, double y) {
  const double c = std::cos(s.angle), d = std::sin(s.angle);
  return {s.lean_x + s.scale * (x * c - y * d), s.lean_y + s.scale * (x * d + y * c), s.z};
}

SplineSurface lofted(const std::vector<std::array<double, 2>>& section, const std::vector<double>& weights,
                     const std::vector<double>& knots, int degree) {
  SplineSurface s;
  s.degree_u = degree;
  s.knots_u = knots;
  s.knots_v = clamped_knots({0, 20, 40, kHeight}, 3);
  const auto at = stations();
  s.count_v = static_cast<int>(at.size());
  for (std::size_t i = 0; i < section.size(); ++i) {
    for (const Station& station : at) {
      s.poles.push_back(placed(station, section[i][0], section[i][1]));
      if (!weights.empty()) s.weights.push_back(weights[i]);
    }
  }
  return s;
}

/// Cambered airfoil, counter-clockwise from the blunt trailing edge over the suction side to the nose and back.
SplineSurface airfoil() {
  std::vector<std::array<double, 2>> poles{{20.0, -4.6}, {19.6, -3.4}, {12, 1.6},  {4, 5.4},  {-5, 7.2}, {-12, 5.4},
                                           {-15.6, 0.8}, {-14, -3.2},  {-8, -3.2}, {0, -1.8}, {9, -2.4}, {16, -4.2}};
  const auto count = static_cast<int>(poles.size());
  for (int i = 0; i < 3; ++i) poles.push_back(poles[i]);
  return lofted(poles, {}, periodic_knots(count, 3), 3);
}

/// The cooling passage: an ellipse that turns and shrinks with the airfoil.
SplineSurface passage() {
  const SplineCurve unit = closed_circle(0, 0, 1);
  std::vector<std::array<double, 2>> section;
  for (const Point& p : unit.poles) section.push_back({-6.0 + 5.6 * p[0], 1.9 + 2.2 * p[1]});
  return lofted(section, unit.weights, unit.knots, 2);
}

std::vector<TopoDS_Face> halves(const Handle(Geom_BSplineSurface) & surface) {
  double u0, u1, v0, v1;
  surface->Bounds(u0, u1, v0, v1);
  const double middle = 0.5 * (u0 + u1);
  return {BRepBuilderAPI_MakeFace(surface, u0, middle, v0, v1, 1e-7).Face(),
          BRepBuilderAPI_MakeFace(surface, middle, u1, v0, v1, 1e-7).Face()};
}

Handle(Geom_Curve) level(const Handle(Geom_BSplineSurface) & surface, double z) { return surface->VIso(z); }

std::vector<Handle(Geom_Curve)> split_level(const Handle(Geom_BSplineSurface) & surface, double z) {
  Handle(Geom_BSplineCurve) whole = Handle(Geom_BSplineCurve)::DownCast(surface->VIso(z));
  const double a = whole->FirstParameter(), b = whole->LastParameter();
  Handle(Geom_BSplineCurve) first = Handle(Geom_BSplineCurve)::DownCast(whole->Copy());
  Handle(Geom_BSplineCurve) second = Handle(Geom_BSplineCurve)::DownCast(whole->Copy());
  first->Segment(a, 0.5 * (a + b));
  second->Segment(0.5 * (a + b), b);
  return {first, second};
}

TopoDS_Solid hollow_airfoil() {
  const auto outside = to_geom(airfoil()), inside = to_geom(passage());
  std::vector<TopoDS_Face> faces = halves(outside);
  for (const TopoDS_Face& face : halves(inside)) faces.push_back(face);
  for (const double z : {0.0, kHeight}) faces.push_back(cap(split_level(outside, z), split_level(inside, z)));
  return as_nurbs(sewn(faces));
}

TopoDS_Solid ceramic_core() {
  const auto side = to_geom(passage());
  return as_nurbs(sewn({natural_face(side), cap({level(side, 0)}), cap({level(side, kHeight)})}));
}

// --- root: a barrel of four rational flanks -------------------------------------------------------------------------

constexpr double kRootDepth = 24.0, kWaist = 3.0, kPinHole = 3.5;

/// Corner line (x, y, z)(v) of the root: a circular arc in (y, z), and x with the same weights.
SplineCurve root_corner(double sign_x, double sign_y) {
  // Arc from (y, z) = (14, -24) to (14, 0) that bows inwards by kWaist at half depth.
  const double half = kRootDepth / 2, radius = (half * half + kWaist * kWaist) / (2 * kWaist);
  const double cosine = (radius - kWaist) / radius;
  const double tip = 14 - half * half / (radius - kWaist);  // where the end tangents meet
  return conic({sign_x * 22, sign_y * 14, -kRootDepth}, {sign_x * 18, sign_y * tip, -half},
               {sign_x * 24, sign_y * 14, 0}, cosine);
}

/// y of the flank at a height: the arc itself.
double flank(double z) {
  const double half = kRootDepth / 2, radius = (half * half + kWaist * kWaist) / (2 * kWaist);
  const double centre = 14 - kWaist + radius;
  return centre - std::sqrt(radius * radius - (z + half) * (z + half));
}

TopoDS_Solid root_block() {
  const std::array<SplineCurve, 4> corners{root_corner(1, 1), root_corner(-1, 1), root_corner(-1, -1),
                                           root_corner(1, -1)};
  std::vector<TopoDS_Face> faces;
  for (std::size_t i = 0; i < 4; ++i) faces.push_back(natural_face(to_geom(ruled(corners[i], corners[(i + 1) % 4]))));
  for (const std::size_t end : {0, 2}) {
    std::vector<Handle(Geom_Curve)> edges;
    for (std::size_t i = 0; i < 4; ++i)
      edges.push_back(
          to_geom(SplineCurve{1, {0, 0, 1, 1}, {corners[i].poles[end], corners[(i + 1) % 4].poles[end]}, {}}));
    faces.push_back(cap(edges));
  }
  const TopoDS_Shape pin = as_nurbs(cylinder({4, -30, -12}, {0, 1, 0}, kPinHole, 60));
  return as_nurbs(cut(as_nurbs(sewn(faces)), {pin}));
}

double root_volume() {
  const SplineCurve corner = root_corner(1, 1);
  const double block = integrate(
      {0, 1},
      [&](double v) {
        const auto [p, slope] = corner.frame(v);
        return 4 * p[0] * p[1] * slope[2];
      },
      8);
  // The pin hole: strips of constant height, z = -12 + r sin(a).
  const double hole = integrate(
      {-kPi / 2, kPi / 2},
      [&](double a) {
        return 2 * flank(-12 + kPinHole * std::sin(a)) * 2 * kPinHole * kPinHole * std::cos(a) * std::cos(a);
      },
      8);
  return block - hole;
}

}  // namespace

DataSet turbine_blade_16() {
  DataSet set{"turbine_blade_16", "Turbine blade of 16 NURBS surfaces: airfoil, ceramic core, root", "mm", {}, {}, {}};
  set.root.name = "Turbine blade";
  const double passage_volume = std::abs(y_flux(passage(), 4));
  const double solid_airfoil = std::abs(y_flux(airfoil()));
  set.add({"Airfoil",
           hollow_airfoil(),
           {"CMSX-4", 8.70, {0.52, 0.58, 0.68}, 0},
           {solid_airfoil - passage_volume, "Gauss quadrature of the flux through the lofted splines"}});
  set.add({"Ceramic core",
           ceramic_core(),
           {"Fused silica", 2.20, {0.95, 0.92, 0.84}, 0},
           {passage_volume, "Gauss quadrature of the flux through the rational loft, four parts a knot span"}});
  set.add({"Root",
           root_block(),
           {"Inconel 718", 8.19, {0.72, 0.56, 0.40}, 0},
           {root_volume(), "Gauss quadrature of the section area along the corner arc and of the pin hole", 1e-7}});
  return set;
}

}  // namespace lamella::datasets
