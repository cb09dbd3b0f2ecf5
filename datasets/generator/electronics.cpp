#include <gp_Ax1.hxx>
#include <numbers>

#include "datasets/generator/catalog.h"
#include "datasets/generator/shapes.h"

namespace lamella::datasets {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInch = 25.4;  // mm

double cubic(double cubic_inches) { return cubic_inches * kInch * kInch * kInch; }

TopoDS_Shape inch_box(const Point& low, const Point& high) {
  return box(low[0] * kInch, low[1] * kInch, low[2] * kInch, high[0] * kInch, high[1] * kInch, high[2] * kInch);
}

TopoDS_Shape inch_cylinder(double x, double y, double z, double radius, double height) {
  return cylinder({x * kInch, y * kInch, z * kInch}, {0, 0, 1}, radius * kInch, height * kInch);
}

gp_Trsf inch_shift(double x, double y, double z) { return translation(x * kInch, y * kInch, z * kInch); }

// --- connector: all lengths in inch until they enter a shape -------------------------------------------------------

constexpr double kPitch = 0.1, kPin = 0.025, kFloor = 0.12, kBarb = 0.004, kBarbHeight = 0.04;
constexpr int kPins = 5;

/// Bent pin as seen along x: (y, z) of the corners, tip up, foot towards -y, a barb on either side within the floor.
const std::vector<std::array<double, 2>> kPinOutline{
    {-0.0060, 0.33},        {-0.0125, 0.30},   {-0.0125, 0.08},  {-0.0125 - kBarb, 0.06}, {-0.0125, 0.04},
    {-0.0125, -0.035},      {-0.1200, -0.035}, {-0.1200, -0.06}, {0.0125, -0.06},         {0.0125, 0.04},
    {0.0125 + kBarb, 0.06}, {0.0125, 0.08},    {0.0125, 0.30},   {0.0060, 0.33}};

Part pin_part() {
  std::vector<std::array<double, 2>> outline;
  for (const auto& [y, z] : kPinOutline) outline.push_back({y * kInch, z * kInch});
  // The prism rises along z over (x, y); turning x -> y, y -> z, z -> x lays it into place.
  gp_Trsf turn;
  turn.SetValues(0, 0, 1, -kPin / 2 * kInch, 1, 0, 0, 0, 0, 1, 0, 0);
  const TopoDS_Shape shape = moved(prism(outline, 0, kPin * kInch), turn);
  const double volume = cubic(std::abs(polygon_area(kPinOutline)) * kPin);
  return {
      "Pin", shape, {"Phosphor bronze C51000", 8.86, {0.86, 0.66, 0.24}, 10}, {volume, "shoelace area times width"}};
}

Part housing_part() {
  std::vector<TopoDS_Shape> cuts{inch_box({0.03, 0.03, kFloor}, {0.53, 0.23, 0.4}),
                                 inch_box({0.24, -0.1, 0.22}, {0.32, 0.1, 0.4})};
  for (int i = 0; i < kPins; ++i)
    for (const double y : {0.08, 0.18})
      cuts.push_back(inch_box({0.08 + i * kPitch - kPin / 2, y - kPin / 2, -0.1},
                              {0.08 + i * kPitch + kPin / 2, y + kPin / 2, 0.2}));
  const TopoDS_Shape lug = cylinder({0.18 * kInch, 0.26 * kInch, 0.2 * kInch}, {1, 0, 0}, 0.05 * kInch, 0.2 * kInch);
  const TopoDS_Shape body = cut(inch_box({0, 0, 0}, {0.56, 0.26, 0.35}), cuts);
  const TopoDS_Shape latch = cut(lug, {inch_box({0, 0, 0}, {0.56, 0.26, 0.35})});
  const double volume = 0.56 * 0.26 * 0.35 - 0.5 * 0.2 * (0.35 - kFloor) - 0.08 * 0.03 * (0.35 - 0.22) -
                        2 * kPins * kPin * kPin * kFloor + 0.5 * kPi * 0.05 * 0.05 * 0.2;
  return {"Gehäuse",
          fuse({body, latch}),
          {"PBT-GF30", 1.53, {0.13, 0.15, 0.18}, 0},
          {cubic(volume), "boxes and half a cylinder"}};
}

}  // namespace

DataSet connector() {
  DataSet set{"connector", "Pin header: barbed bronze pins pressed into a glass-filled housing", "inch", {}, {}, {}};
  set.root.name = "Connector 2x5";
  set.add(housing_part());
  const int pin = set.define(pin_part());
  Node row{"Row A", -1, inch_shift(0.08, 0.08, 0), {}};
  for (int i = 0; i < kPins; ++i)
    row.children.push_back({"Pin " + std::to_string(i + 1), pin, inch_shift(i * kPitch, 0, 0), {}});
  set.root.children.push_back(row);
  row.name = "Row B";
  row.placement =
      inch_shift(0.08 + (kPins - 1) * kPitch, 0.18, 0) * rotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), kPi);
  set.root.children.push_back(row);
  const double barbs = cubic(2 * 0.5 * kBarb * kBarbHeight * kPin);
  for (std::size_t i = 1; i <= 2 * kPins; ++i)
    set.overlaps.push_back({0, i, {barbs, "the two barbs, triangles times the pin's width"}});
  return set;
}

namespace {

// --- printed circuit board -----------------------------------------------------------------------------------------

constexpr double kBoardX = 1.2, kBoardY = 0.8, kDrill = 0.012, kBore = 0.008, kTop = 0.0512;
constexpr std::array<std::array<double, 2>, 6> kVias{
    {{0.2, 0.2}, {0.2, 0.6}, {0.6, 0.14}, {0.6, 0.66}, {1.0, 0.2}, {1.0, 0.6}}};

/// A plate over the whole board with a round hole at each via.
Part plate(const std::string& name, const PartMaterial& material, double z0, double z1, double hole) {
  std::vector<TopoDS_Shape> holes;
  for (const auto& via : kVias) holes.push_back(inch_cylinder(via[0], via[1], z0 - 0.01, hole, z1 - z0 + 0.02));
  const TopoDS_Shape shape = cut(inch_box({0, 0, z0}, {kBoardX, kBoardY, z1}), holes);
  const double area = kBoardX * kBoardY - kPi * hole * hole * static_cast<double>(kVias.size());
  return {name, shape, material, {cubic(area * (z1 - z0)), "plate less round holes"}};
}

Part via_part(const PartMaterial& copper) {
  const double r0 = kBore * kInch, r1 = kDrill * kInch, pad = 0.02 * kInch, z = kTop * kInch, rim = 0.0014 * kInch;
  const std::vector<ProfilePoint> profile{{0, r0}, {z + rim, r0}, {z + rim, pad}, {z, pad}, {z, r1}, {0, r1}};
  return {"Via", revolved_polygon(profile, 'z'), copper, {revolved_polygon_volume(profile), "Pappus"}};
}

/// A solder ball flattened where it touches pad and package: the zone of a sphere between two planes.
Part solder_ball() {
  const double r = 0.02 * kInch, half = 0.015 * kInch;
  const TopoDS_Shape slab = box(-1, -1, -half, 1, 1, half);
  const double volume = 2 * kPi * half * (r * r - half * half / 3);
  return {"Solder ball",
          common(sphere({0, 0, 0}, r), slab),
          {"SAC305", 7.37, {0.80, 0.82, 0.84}, 5},
          {volume, "zone of a sphere, pi h (r^2 - h^2 / 12)"}};
}

}  // namespace

DataSet pcb_stack() {
  DataSet set{"pcb_stack", "Four-layer board piece: laminate, copper planes, plated vias, a ball-grid package",
              "inch",      {},
              {},          {}};
  set.root.name = "PCB stack";
  const PartMaterial copper{"Copper", 8.94, {0.80, 0.46, 0.24}, 10}, fr4{"FR-4", 1.85, {0.18, 0.46, 0.26}, 0};
  const PartMaterial prepreg{"Prepreg 2116", 1.80, {0.42, 0.62, 0.36}, 0};
  set.add(plate("Ground plane", copper, 0, 0.0014, kDrill));
  set.add(plate("Core", fr4, 0.0014, 0.0404, kDrill));
  set.add(plate("Power plane", copper, 0.0404, 0.0418, 0.03));  // antipads: a ring of air around each via
  set.add(plate("Prepreg", prepreg, 0.0418, kTop, kDrill));
  const int via = set.define(via_part(copper));
  Node vias{"Vias", -1, gp_Trsf(), {}};
  for (std::size_t i = 0; i < kVias.size(); ++i)
    vias.children.push_back({"Via " + std::to_string(i + 1), via, inch_shift(kVias[i][0], kVias[i][1], 0), {}});
  set.root.children.push_back(vias);
  Node package{"Package", -1, inch_shift(0.6, 0.4, kTop), {}};
  const int ball = set.define(solder_ball());
  for (const double x : {-0.1, 0.0, 0.1})
    for (const double y : {-0.1, 0.1})
      package.children.push_back(
          {"Ball " + std::to_string(package.children.size() + 1), ball, inch_shift(x, y, 0.015), {}});
  const int body = set.define({"Package body",
                               inch_box({-0.16, -0.15, 0.03}, {0.16, 0.15, 0.09}),
                               {"Epoxy mould compound", 1.95, {0.10, 0.10, 0.12}, 0},
                               {cubic(0.32 * 0.30 * 0.06), "edge lengths"}});
  package.children.push_back({"Package body", body, gp_Trsf(), {}});
  set.root.children.push_back(package);
  return set;
}

}  // namespace lamella::datasets
