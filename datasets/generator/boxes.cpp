#include <cmath>
#include <gp_Ax1.hxx>
#include <numbers>

#include "datasets/generator/catalog.h"
#include "datasets/generator/shapes.h"

namespace lamella::datasets {
namespace {

constexpr double kPi = std::numbers::pi;

Part block(const std::string& name, const PartMaterial& material, const Point& low, const Point& high) {
  const double volume = (high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]);
  return {name, box(low[0], low[1], low[2], high[0], high[1], high[2]), material, {volume, "edge lengths"}};
}

}  // namespace

DataSet touching_boxes() {
  DataSet set{
      "touching_boxes", "Blocks that share faces, edges and corners; again turned by 30 degrees", "mm", {}, {}, {}};
  set.root.name = "Touching boxes";
  const PartMaterial oak{"Oak", 0.71, {0.62, 0.44, 0.26}, 0}, cork{"Cork", 0.18, {0.86, 0.68, 0.46}, 0};
  const PartMaterial felt{"Wool felt", 0.30, {0.55, 0.62, 0.50}, 0}, slate{"Slate", 2.75, {0.30, 0.34, 0.40}, 0};
  Node group{"Stack", -1, gp_Trsf(), {}};
  const auto put = [&](Part part) { group.children.push_back({part.name, set.define(part), gp_Trsf(), {}}); };
  put(block("Oak block", oak, {0, 0, 0}, {10, 8, 6}));
  put(block("Cork block", cork, {10, 0, 0}, {16, 8, 6}));
  put(block("Felt pad", felt, {0, 0, 6}, {16, 8, 7.5}));
  put(block("Slate block", slate, {2, 1, 7.5}, {14, 7, 12}));
  put(block("Oak block at an edge", oak, {16, 8, 0}, {20, 12, 6}));
  put(block("Oak block at a corner", oak, {-3, -3, 7.5}, {0, 0, 10}));
  set.root.children.push_back(group);
  group.name = "Stack turned 30°";
  group.placement = translation(30, 0, 0) * rotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), kPi / 6);
  set.root.children.push_back(group);
  return set;
}

DataSet interpenetrating_bodies() {
  DataSet set{"interpenetrating_bodies", "Pairs of bodies whose common volume is known", "mm", {}, {}, {}};
  set.root.name = "Interpenetrating bodies";
  const PartMaterial red{"ABS red", 1.04, {0.80, 0.18, 0.16}, 10}, white{"ABS white", 1.04, {0.93, 0.93, 0.90}, 5};
  const PartMaterial blue{"ABS blue", 1.04, {0.12, 0.32, 0.70}, 0};
  const double r = 4.0, length = 24.0;
  const double rod = kPi * r * r * length;
  set.add({"Rod along x", cylinder({-12, 0, 0}, {1, 0, 0}, r, length), red, {rod, "pi r^2 h"}});
  set.add({"Rod along y", cylinder({0, -12, 0}, {0, 1, 0}, r, length), white, {rod, "pi r^2 h"}});
  set.add(block("Cube", blue, {20, -6, -6}, {32, 6, 6}));
  set.add({"Ball at the cube's corner", sphere({32, 6, 6}, 5), red, {4.0 / 3 * kPi * 125, "4/3 pi r^3"}});
  set.add({"Ball left", sphere({45, 0, 0}, 6), white, {4.0 / 3 * kPi * 216, "4/3 pi r^3"}});
  set.add({"Ball right", sphere({52, 0, 0}, 5), blue, {4.0 / 3 * kPi * 125, "4/3 pi r^3"}});
  const double d = 7.0, ra = 6.0, rb = 5.0;
  const double lens = kPi * std::pow(ra + rb - d, 2) *
                      (d * d + 2 * d * rb - 3 * rb * rb + 2 * d * ra + 6 * ra * rb - 3 * ra * ra) / (12 * d);
  set.overlaps = {{0, 1, {16.0 / 3 * r * r * r, "Steinmetz solid 16/3 r^3"}},
                  {2, 3, {kPi * 125 / 6, "an eighth of the ball"}},
                  {4, 5, {lens, "lens of two balls"}}};
  return set;
}

}  // namespace lamella::datasets
