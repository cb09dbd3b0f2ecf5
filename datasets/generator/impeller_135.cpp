#include <cmath>
#include <numbers>
#include <stdexcept>

#include "datasets/generator/catalog.h"
#include "datasets/generator/freeform.h"
#include "datasets/generator/shapes.h"
#include "datasets/generator/terrace.h"

namespace lamella::datasets {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kBlades = 9;
constexpr double kBore = 4.0, kBushing = 5.5, kNose = 24.0, kNoseRadius = 7.0;  // mm
constexpr Rectangle kGround{-54, 54, -54, 54};

/// Hub radius over z, parameter z: wide at the back (z = 0), slim at the nose.
SplineCurve hub_profile() { return graph_spline({0, 6, 12, 18, kNose}, {30.5, 25, 16, 11.5, 8.8, 7.6, kNoseRadius}); }

double hub_radius(double z) { return hub_profile().point(z)[1]; }

/// About z: the profile is a graph over x, so it is revolved there and then turned.
TopoDS_Shape upright(const TopoDS_Shape& about_x) {
  gp_Trsf turn;
  turn.SetValues(0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0);
  return moved(about_x, turn);
}

TopoDS_Shape hub() {
  const TopoDS_Shape body = upright(revolved_graph(hub_profile(), 0, kNose));
  return as_nurbs(cut(body, {cylinder({0, 0, -1}, {0, 0, 1}, kBushing, kNose + 2)}));
}

// --- blades: a ruled thickness between two bicubic sides ------------------------------------------------------------

/// One side of a blade: u runs from the eye (top, near the axis) to the rim, v from the root within the hub to the tip.
SplineSurface blade_side(int blade, double side) {
  SplineSurface s;
  s.knots_u = clamped_knots({0, 0.35, 0.7, 1}, 3);
  s.knots_v = clamped_knots({0, 1}, 3);
  const auto us = greville(s.knots_u, 3), vs = greville(s.knots_v, 3);
  s.count_v = static_cast<int>(vs.size());
  for (const double u : us) {
    for (const double v : vs) {
      const double root_z = 20.5 - 17.0 * u, root_r = hub_radius(root_z) - 1.1;
      const double tip_z = 23.0 - 11.0 * u * u, tip_r = 18.5 + 14.5 * u;
      const double r = root_r + (tip_r - root_r) * v, z = root_z + (tip_z - root_z) * v;
      const double wrap = -1.05 * u + 0.18 * u * u + 0.16 * std::sin(kPi * v) * (1 - u);
      const double half_thickness = (0.75 + 0.55 * std::sin(kPi * std::min(1.0, u + 0.12))) * (1.1 - 0.45 * v);
      const double angle = 2 * kPi / kBlades * blade + wrap + side * half_thickness / r;
      s.poles.push_back({r * std::cos(angle), r * std::sin(angle), z});
    }
  }
  return s;
}

TopoDS_Solid blade_shape(int blade) {
  std::vector<TopoDS_Face> faces;
  for (const SplineSurface& s : between(blade_side(blade, -1), blade_side(blade, 1)))
    faces.push_back(natural_face(to_geom(s)));
  return sewn(faces);
}

/// Point and derivatives of the blade's body at (u, v, w), w from one side to the other.
struct BodyPoint {
  Point at;
  double jacobian;
};

BodyPoint body_point(const SplineSurface& low, const SplineSurface& high, double u, double v, double w) {
  const auto a = low.frame(u, v), b = high.frame(u, v);
  Point p, du, dv, dw;
  for (int c = 0; c < 3; ++c) {
    p[c] = (1 - w) * a.point[c] + w * b.point[c];
    du[c] = (1 - w) * a.du[c] + w * b.du[c];
    dv[c] = (1 - w) * a.dv[c] + w * b.dv[c];
    dw[c] = b.point[c] - a.point[c];
  }
  const double det = dw[0] * (du[1] * dv[2] - du[2] * dv[1]) + dw[1] * (du[2] * dv[0] - du[0] * dv[2]) +
                     dw[2] * (du[0] * dv[1] - du[1] * dv[0]);
  return {p, std::abs(det)};
}

/// Volume of the blade below v = limit(u, w): Gauss quadrature of the Jacobian.
double blade_volume(int blade, const std::function<double(double, double)>& limit, int parts) {
  const SplineSurface low = blade_side(blade, -1), high = blade_side(blade, 1);
  return integrate(
      low.breaks_u(),
      [&](double u) {
        return integrate(0, 1, [&](double w) {
          return integrate(0, limit(u, w), [&](double v) { return body_point(low, high, u, v, w).jacobian; });
        });
      },
      parts);
}

double radial_excess(const SplineSurface& low, const SplineSurface& high, const SplineCurve& profile, double u,
                     double v, double w) {
  const Point p = body_point(low, high, u, v, w).at;
  return std::hypot(p[0], p[1]) - profile.point(p[2])[1];
}

/// The overlap's formula holds if every line from root to tip leaves the hub once and starts outside the bore.
void require_rooted(const SplineSurface& low, const SplineSurface& high, const SplineCurve& profile) {
  for (int i = 0; i <= 40; ++i) {
    for (int k = 0; k <= 8; ++k) {
      const double u = i / 40.0, w = k / 8.0;
      const Point root = body_point(low, high, u, 0, w).at;
      bool outside = false, once = std::hypot(root[0], root[1]) > kBushing && root[2] > 0;
      for (int j = 0; j <= 60; ++j) {
        const bool beyond = radial_excess(low, high, profile, u, j / 60.0, w) > 0;
        once = once && !(outside && !beyond) && !(j == 0 && beyond);
        outside = beyond;
      }
      if (!once || !outside) throw std::logic_error("a blade isn't rooted in the hub");
    }
  }
}

/// Where the blade leaves the hub, by bisection.
double leaving(const SplineSurface& low, const SplineSurface& high, const SplineCurve& profile, double u, double w) {
  double inside = 0, outside = 1;
  for (int i = 0; i < 60; ++i) {
    const double v = 0.5 * (inside + outside);
    (radial_excess(low, high, profile, u, v, w) < 0 ? inside : outside) = v;
  }
  return 0.5 * (inside + outside);
}

double buried_volume(int blade, int parts) {
  const SplineSurface low = blade_side(blade, -1), high = blade_side(blade, 1);
  const SplineCurve profile = hub_profile();
  require_rooted(low, high, profile);
  return blade_volume(
      blade, [&](double u, double w) { return leaving(low, high, profile, u, w); }, parts);
}

// --- plate and diffuser -------------------------------------------------------------------------------------------

SplineSurface plate_back() {
  return height_patch(kGround, 2, [](double x, double y) { return -7.5 + 0.0010 * (x * x + y * y) + 0.01 * x; });
}

/// The seat of the hub: z = 0 throughout, so that hub and plate touch in a plane.
SplineSurface plate_front() {
  return height_patch(kGround, 1, [](double, double) { return 0.0; });
}

Terrace plate() {
  std::vector<Plan> openings{circle_plan(0, 0, kBushing)};
  for (int i = 0; i < kBlades; ++i) {
    const double a = 2 * kPi / kBlades * i;
    openings.push_back(kidney(16.5, 25.5, a - 0.17, a + 0.12));
  }
  return slab(circle_plan(0, 0, 34), plate_back(), plate_front(), openings);
}

/// Nine petals: bulged parabolas joined by rounded valleys.
Plan petals() {
  std::vector<Point> tips;
  Plan plan;
  const auto at = [](double r, double angle) { return Point{r * std::cos(angle), r * std::sin(angle), 0}; };
  const double step = 2 * kPi / kBlades;
  for (int i = 0; i < kBlades; ++i) {
    const double a = step * i, next = i + 1 == kBlades ? 0.0 : step * (i + 1);
    const Point begin = at(44, a + 0.1 * step), end = at(44, a + 0.9 * step), following = at(44, next + 0.1 * step);
    plan.push_back(conic(begin, at(54.5, a + 0.5 * step), end));
    plan.push_back(conic(end, at(40.5, a + step), following, 0.75));
  }
  return plan;
}

Terrace diffuser() {
  const auto low = height_patch(kGround, 2, [](double x, double y) { return -6.0 + 0.0006 * x * x - 0.0004 * y * y; });
  const auto high = height_patch(
      kGround, 2, [](double x, double y) { return 8.5 - 0.0022 * x * x + 0.0012 * y * y + 0.03 * x + 0.02 * y; });
  // Holes in the middle of two petals: nine petals, so a valley faces each.
  const double petal = kPi / kBlades, opposite = petal + 8 * kPi / kBlades;
  return slab(petals(), low, high,
              {circle_plan(0, 0, 36.5), circle_plan(41.5 * std::cos(petal), 41.5 * std::sin(petal), 1.6),
               circle_plan(41.5 * std::cos(opposite), 41.5 * std::sin(opposite), 1.6)});
}

}  // namespace

DataSet impeller_135() {
  DataSet set{"impeller_135",
              "Impeller of 135 NURBS surfaces: twisted blades rooted in a hub, plate, diffuser",
              "mm",
              {},
              {},
              {}};
  set.root.name = "Impeller";
  const char* green = "Green's theorem over the plan with Gauss quadrature of the Bezier height fields";
  const double hub_volume = revolved_volume(hub_profile(), 0, kNose) - kPi * kBushing * kBushing * kNose;
  set.add({"Hub",
           hub(),
           {"AlSi10Mg", 2.67, {0.70, 0.74, 0.80}, 10},
           {hub_volume, "pi * integral of the squared profile, less the bore"}});
  const std::vector<ProfilePoint> tube{{-9, kBore}, {kNose + 2, kBore}, {kNose + 2, kBushing}, {-9, kBushing}};
  set.add({"Bushing",
           as_nurbs(revolved_polygon(tube, 'z')),
           {"CuSn8", 8.80, {0.80, 0.58, 0.28}, 20},
           {revolved_polygon_volume(tube), "Pappus"}});
  set.add({"Plate", build(plate()), {"PEEK-CF30", 1.40, {0.22, 0.24, 0.28}, 0}, {volume(plate()), green}});
  set.add({"Diffuser", build(diffuser()), {"PA6-GF30", 1.36, {0.20, 0.48, 0.46}, 0}, {volume(diffuser()), green}});
  for (int i = 0; i < kBlades; ++i) {
    const double all = blade_volume(
        i, [](double, double) { return 1.0; }, 1);
    set.add({"Blade " + std::to_string(i + 1),
             blade_shape(i),
             {"Ti-6Al-4V", 4.43, {0.86, 0.40, 0.24}, 0},
             {all, "Gauss quadrature of the body's polynomial Jacobian"}});
    const double coarse = buried_volume(i, 1), fine = buried_volume(i, 4);
    set.overlaps.push_back(
        {0,
         set.root.children.size() - 1,
         {fine, "Gauss quadrature up to the hub's profile", 10 * std::abs(fine - coarse) / fine + 1e-12}});
  }
  return set;
}

}  // namespace lamella::datasets
