#include <cmath>
#include <gp_Ax1.hxx>
#include <numbers>

#include "datasets/generator/catalog.h"
#include "datasets/generator/shapes.h"

namespace lamella::datasets {
namespace {

constexpr double kPi = std::numbers::pi;

/// A hook without any symmetry: a prism over a slanted outline with one bore.
Part bracket() {
  const std::vector<std::array<double, 2>> outline{{0, 0}, {26, 0}, {30, 6}, {30, 9}, {9, 9}, {6, 24}, {0, 24}};
  const TopoDS_Shape shape = cut(prism(outline, 0, 7), {cylinder({4, 19, -1}, {0, 0, 1}, 2, 9)});
  return {"Bracket",
          shape,
          {"AlMg3", 2.66, {0.66, 0.70, 0.76}, 0},
          {(polygon_area(outline) - kPi * 4) * 7, "shoelace area times thickness, less the bore"}};
}

Part pad() {
  const std::vector<std::array<double, 2>> outline{{0, 0}, {12, 0}, {12, 8}, {4, 8}};
  return {"Pad",
          prism(outline, 0, 3),
          {"NBR 60 Shore", 1.20, {0.16, 0.16, 0.18}, 0},
          {polygon_area(outline) * 3, "shoelace area times thickness"}};
}

Part rivet() {
  const std::vector<ProfilePoint> profile{{-1, 0}, {-1, 3.4}, {0, 3.4}, {0, 2}, {7, 2}, {8.5, 0.8}, {8.5, 0}};
  return {"Rivet",
          revolved_polygon(profile, 'z'),
          {"Copper", 8.94, {0.80, 0.46, 0.24}, 0},
          {revolved_polygon_volume(profile), "Pappus"}};
}

}  // namespace

DataSet mirrored_brackets() {
  DataSet set{"mirrored_brackets", "Left arm and its mirror image, nested and turned instances", "mm", {}, {}, {}};
  set.root.name = "Bracket pair";
  const int hook = set.define(bracket()), rubber = set.define(pad()), copper = set.define(rivet());
  // The rivet fills the bore; the damper stands on the plate, turned by 20 degrees and with its pad shifted again.
  Node damper{"Damper", -1, translation(12, 1.5, 7) * rotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), kPi / 9), {}};
  damper.children.push_back({"Lower pad", rubber, gp_Trsf(), {}});
  damper.children.push_back({"Upper pad", rubber, translation(1.5, 0.5, 3), {}});
  Node arm{"Arm", -1, translation(5, 0, 0), {}};
  arm.children.push_back({"Hook", hook, gp_Trsf(), {}});
  arm.children.push_back({"Rivet 1", copper, translation(4, 19, 0), {}});
  arm.children.push_back(damper);
  arm.name = "Left arm";
  set.root.children.push_back(arm);
  arm.name = "Right arm";
  arm.placement = translation(-5, 0, 0);
  set.root.children.push_back(arm);
  set.mirrored = {{"Right arm", {-5, 0, 0}}};
  return set;
}

}  // namespace lamella::datasets
