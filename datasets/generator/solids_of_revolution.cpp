#include <cmath>
#include <numbers>

#include "datasets/generator/catalog.h"
#include "datasets/generator/shapes.h"

namespace lamella::datasets {
namespace {

constexpr double kPi = std::numbers::pi;

double ball(double r) { return 4.0 / 3.0 * kPi * r * r * r; }

}  // namespace

DataSet nested_spheres() {
  DataSet set{"nested_spheres", "Concentric shells with an evacuated gap and an eccentric cavity", "mm", {}, {}, {}};
  set.root.name = "Nested spheres";
  const PartMaterial tungsten{"Tungsten", 19.25, {0.35, 0.37, 0.42}, 0};
  const PartMaterial epoxy{"Epoxy", 1.18, {0.93, 0.80, 0.42}, 0};
  const PartMaterial lead{"Lead", 11.34, {0.45, 0.50, 0.62}, 0};
  const PartMaterial glass{"Borosilicate glass", 2.23, {0.45, 0.75, 0.80}, 0};
  const char* shell = "4/3 pi (R^3 - r^3)";
  set.add({"Kernel", sphere({0, 0, 0}, 4), tungsten, {ball(4), "4/3 pi r^3"}});
  set.add({"Buffer", with_voids(sphere({0, 0, 0}, 7), {sphere({0, 0, 0}, 4)}), epoxy, {ball(7) - ball(4), shell}});
  // The gap from 7 to 8 stays empty: the shell's cavity is larger than what it holds.
  set.add({"Shield", with_voids(sphere({0, 0, 0}, 10), {sphere({0, 0, 0}, 8)}), lead, {ball(10) - ball(8), shell}});
  set.add({"Envelope",
           with_voids(sphere({1, 0.5, 0}, 14), {sphere({0, 0, 0}, 10), sphere({12.2, 2.5, 0}, 1.25)}),
           glass,
           {ball(14) - ball(10) - ball(1.25), "4/3 pi (R^3 - r1^3 - r2^3)"}});
  return set;
}

DataSet gradient_lens() {
  DataSet set{"gradient_lens", "Stepped-index lens of nested surfaces of revolution", "mm", {}, {}, {}};
  set.root.name = "Gradient lens";
  const std::vector<PartMaterial> glasses{{"N-LASF44", 4.44, {0.20, 0.32, 0.70}, 0},
                                          {"N-SF11", 3.22, {0.30, 0.50, 0.80}, 0},
                                          {"N-BAF10", 3.75, {0.42, 0.66, 0.85}, 0},
                                          {"N-BK7", 2.51, {0.58, 0.80, 0.88}, 0},
                                          {"N-FK51A", 3.68, {0.76, 0.90, 0.92}, 0}};
  // Lens-shaped bodies: the squared radius isn't polynomial, but the profile r(x) is, a quintic with poles on the axis.
  const auto profile = [](double half, double radius) {
    return graph_spline({-half, 0, half}, {0, 0.75 * radius, radius, 1.02 * radius, 0.8 * radius, 0}, 4);
  };
  TopoDS_Shape inner;
  double inner_volume = 0.0;
  for (std::size_t i = 0; i < glasses.size(); ++i) {
    const double half = 2.0 + 1.1 * static_cast<double>(i), radius = 5.0 + 2.6 * static_cast<double>(i);
    const SplineCurve curve = profile(half, radius);
    const TopoDS_Shape body = revolved_graph(curve, -half, half);
    const double volume = revolved_volume(curve, -half, half);
    set.add({"Zone " + std::to_string(i + 1),
             inner.IsNull() ? body : with_voids(body, {inner}),
             glasses[i],
             {volume - inner_volume, "pi * integral of the squared polynomial profile, less the zone inside"}});
    inner = body;
    inner_volume = volume;
  }
  return set;
}

}  // namespace lamella::datasets
