#include <cmath>
#include <numbers>

#include "datasets/generator/catalog.h"
#include "datasets/generator/shapes.h"

namespace lamella::datasets {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kCoverBegin = 10.0, kCoverEnd = 86.0;  // mm along x, the part of the core that TPE covers
constexpr double kShankRadius = 3.2, kShankBegin = 42.0, kCoreEnd = 100.0;

SplineCurve core_profile() { return graph_spline({0, 20, 40, 60, 80, 100}, {9.4, 9.2, 8.2, 9.6, 7.6, 8.6, 7.4, 7.0}); }

SplineCurve pocket_profile() { return graph_spline({9, 17, 25, 33}, {0, 5.2, 4.6, 7.0, 5.4, 0}); }

SplineCurve end_cap_profile() { return graph_spline({-13, -8, 0}, {0, 12.6, 13.4, 11.4, 9.4}); }

/// The hand's side of the cover: closed around x, waved for four fingers below, smooth above, six-fold ribs around.
SplineSurface cover_outside() {
  const int around = 24;
  const std::vector<double> breaks{10, 18, 26, 34, 42, 50, 58, 66, 74, 82, 86};
  SplineSurface s;
  s.knots_u = periodic_knots(around, 3);
  s.knots_v = clamped_knots(breaks, 3);
  const std::vector<double> x = greville(s.knots_v, 3);
  s.count_v = static_cast<int>(x.size());
  for (int i = 0; i < around + 3; ++i) {
    const double angle = 2 * kPi * (i % around) / around;
    const double below = std::max(0.0, -std::sin(angle));
    for (const double at : x) {
      const double along = (at - kCoverBegin) / (kCoverEnd - kCoverBegin);
      const double belly = 12.4 + 5.4 * (1 - std::pow(2 * along - 1, 6)) - 0.8 * along;
      const double fingers = 1.6 * below * std::cos(8 * kPi * along);
      const double ribs = 0.35 * std::cos(6 * angle);
      const double radius = belly + fingers + ribs;
      s.poles.push_back({at, radius * std::cos(angle), 0.92 * radius * std::sin(angle)});
    }
  }
  return s;
}

/// Turns the (around) angle so that the finger side faces -y: y and z of the poles change places.
SplineSurface fingers_down(SplineSurface s) {
  for (Point& p : s.poles) p = {p[0], p[2], -p[1]};
  return s;
}

TopoDS_Shape cover(const SplineSurface& outside, const SplineCurve& core) {
  const Handle(Geom_BSplineSurface) surface = to_geom(outside);
  const auto edge = [&](double x) { return Handle(Geom_Curve)(surface->VIso(x)); };
  const TopoDS_Shape full = sewn({natural_face(surface), cap({edge(kCoverBegin)}), cap({edge(kCoverEnd)})});
  return cut(full, {revolved_graph(core, kCoverBegin, kCoverEnd)});
}

const PartMaterial kCore{"PP Moplen HP500N", 0.905, {0.18, 0.24, 0.34}, 10};
const PartMaterial kCover{"TPE Thermolast K", 1.12, {0.96, 0.62, 0.16}, 0};
const PartMaterial kSteel{"Steel S2", 7.75, {0.72, 0.76, 0.80}, 30};
const PartMaterial kGel{"Silicone gel", 0.98, {0.10, 0.62, 0.56}, 20};
const PartMaterial kBrass{"Brass CW614N", 8.47, {0.84, 0.64, 0.22}, 20};
const PartMaterial kCap{"PA6-GF30", 1.36, {0.82, 0.24, 0.20}, 10};

Part core_part(const SplineCurve& profile) {
  const SplineCurve pocket = pocket_profile();
  const TopoDS_Shape shape = with_voids(revolved_graph(profile, 0, kCoreEnd), {revolved_graph(pocket, 9, 33)});
  const double volume = revolved_volume(profile, 0, kCoreEnd) - revolved_volume(pocket, 9, 33);
  return {
      "Griffkern", shape, kCore, {volume, "pi * integral of the squared polynomial profiles: body less air pocket"}};
}

Part cover_part(const SplineCurve& core) {
  const SplineSurface outside = fingers_down(cover_outside());
  const double enclosed = std::abs(y_flux(outside));
  const TopoDS_Shape channel = torus({49, 0, 0}, {1, 0, 0}, 12.3, 1.4);
  const double air = 2 * kPi * kPi * 12.3 * 1.4 * 1.4;
  const double volume = enclosed - revolved_volume(core, kCoverBegin, kCoverEnd) - air;
  return {"Überzug",
          with_voids(cover(outside, core), {channel}),
          kCover,
          {volume,
           "Gauss quadrature, exact for the polynomial patches, of the flux through the outside; less the "
           "core's integral and the torus 2 pi^2 R r^2"}};
}

}  // namespace

DataSet overmoulded_grip() {
  DataSet set{
      "overmoulded_grip", "Screwdriver grip: soft cover over a hard core, steel shank moulded in", "mm", {}, {}, {}};
  set.root.name = "Overmoulded grip";
  const SplineCurve core = core_profile();
  set.add(core_part(core));
  set.add(cover_part(core));
  const double end_cap = revolved_volume(end_cap_profile(), -13, 0);
  set.add(
      {"End cap", revolved_graph(end_cap_profile(), -13, 0), kCap, {end_cap, "pi * integral of the squared profile"}});
  const std::vector<ProfilePoint> shank{
      {kShankBegin, 0}, {kShankBegin, kShankRadius}, {132, kShankRadius}, {138, 2.0}, {142, 2.0}, {142, 0}};
  set.add({"Shank", revolved_polygon(shank), kSteel, {revolved_polygon_volume(shank), "Pappus"}});
  const std::vector<ProfilePoint> ferrule{{100, kShankRadius}, {110, kShankRadius}, {110, 5.0}, {107, 6.2}, {100, 7.0}};
  set.add({"Ferrule", revolved_polygon(ferrule), kBrass, {revolved_polygon_volume(ferrule), "Pappus"}});
  const double ring = 2 * kPi * kPi * 12.2 * 1.6 * 1.6;
  const int gel = set.define({"Gel ring", torus({0, 0, 0}, {1, 0, 0}, 12.2, 1.6), kGel, {ring, "2 pi^2 R r^2"}});
  Node rings{"Gel rings", -1, gp_Trsf(), {}};
  rings.children.push_back({"Gel ring rear", gel, translation(24, 0, 0), {}});
  rings.children.push_back({"Gel ring front", gel, translation(72, 0, 0), {}});
  set.root.children.push_back(rings);
  set.overlaps = {{0, 3, {kPi * kShankRadius * kShankRadius * (kCoreEnd - kShankBegin), "cylinder inside the core"}},
                  {1, 5, {ring, "the ring lies within the cover"}},
                  {1, 6, {ring, "the ring lies within the cover"}}};
  return set;
}

}  // namespace lamella::datasets
