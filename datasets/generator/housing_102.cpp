#include <cmath>

#include "datasets/generator/catalog.h"
#include "datasets/generator/terrace.h"

namespace lamella::datasets {
namespace {

constexpr Rectangle kGround{-50, 50, -36, 36};
constexpr double kGasket = 1.6;  // mm
constexpr std::array<std::array<double, 2>, 4> kPosts{{{29, 17}, {-29, 17}, {-29, -17}, {29, -17}}};
constexpr std::array<double, 2> kButton{14, -15};
const char* const kMethod = "Green's theorem over the plan with Gauss quadrature of the Bezier height fields";

SplineSurface underside() {
  return height_patch(kGround, 2, [](double x, double y) { return -0.0035 * x * x + 0.0012 * y * y + 0.02 * x; });
}
SplineSurface pocket_floor() {
  return height_patch(kGround, 3, [](double x, double y) { return 3.2 + 4.5 * std::sin(x / 20) * std::cos(y / 18); });
}
SplineSurface rim() {
  return height_patch(kGround, 2, [](double x, double y) { return 15 - 0.0016 * x * x + 2.4 * std::sin(y / 20); });
}
SplineSurface lid_top() {
  return height_patch(kGround, 3, [](double x, double y) {
    return 28.5 - 0.004 * x * x - 0.003 * y * y + 1.5 * std::sin((x + y) / 15);
  });
}

Plan outer() { return squircle({0, 0, 42, 28, 11, 2.0, 0.7}); }
Plan inner() { return squircle({0, 0, 38.5, 24.5, 9, 1.8, 1.0}); }
Plan window() { return squircle({-15, 2, 12, 8, 3.5, 0.8, 0.7}); }

Part part(const std::string& name, const Terrace& terrace, const PartMaterial& material) {
  return {name, build(terrace), material, {volume(terrace), kMethod}};
}

/// A dish with a rim and four domed posts on the pocket's floor.
Terrace tray() {
  Terrace t{{outer(), inner()},
            {underside(), rim(), pocket_floor()},
            {{0, false, 0, {}}, {1, true, 0, {1}}, {2, true, 1, {}}},
            {{0, 0, 1, true}, {1, 2, 1, false}}};
  for (const auto& [x, y] : kPosts) {
    const int plan = static_cast<int>(t.plans.size()), field = static_cast<int>(t.fields.size());
    t.plans.push_back(circle_plan(x, y, 4.2));
    t.fields.push_back(height_patch({x - 5, x + 5, y - 5, y + 5}, 2, [x = x, y = y](double px, double py) {
      return 12 - 0.05 * ((px - x) * (px - x) + (py - y) * (py - y));
    }));
    t.walls.push_back({plan, 2, field, true});
    t.roofs[2].holes.push_back(plan);
    t.roofs.push_back({field, true, plan, {}});
  }
  return t;
}

/// What goes through the lid: window, eye-shaped vents, button and microphone.
std::vector<Plan> openings() {
  std::vector<Plan> result{window(), circle_plan(kButton[0], kButton[1], 5.0), circle_plan(-4, -17, 1.3)};
  for (int i = 0; i < 5; ++i) result.push_back(eye(9 + 5.2 * i, 4 + 1.0 * i, 8.5, 1.4, 1.25));
  return result;
}

}  // namespace

DataSet housing_102() {
  DataSet set{
      "housing_102", "Hand-held housing of 102 NURBS surfaces: tray, gasket, lid, window, button", "mm", {}, {}, {}};
  set.root.name = "Housing";
  const SplineSurface seat = raised(rim(), kGasket);
  set.add(part("Wanne", tray(), {"PA12-GF30", 1.22, {0.24, 0.28, 0.34}, 0}));
  set.add(part("Dichtung", slab(outer(), rim(), seat, {inner()}), {"EPDM 70 Shore", 1.15, {0.80, 0.30, 0.26}, 0}));
  set.add(
      part("Deckel", slab(outer(), seat, lid_top(), openings()), {"PC Makrolon 2805", 1.20, {0.45, 0.62, 0.80}, 0}));
  set.add(part("Fenster", slab(window(), seat, lid_top()), {"PMMA", 1.19, {0.70, 0.88, 0.90}, 0}));
  const auto dome = height_patch(
      {kButton[0] - 6, kButton[0] + 6, kButton[1] - 6, kButton[1] + 6}, 2,
      [](double x, double y) { return 32 - 0.06 * (std::pow(x - kButton[0], 2) + std::pow(y - kButton[1], 2)); });
  set.add(part("Knopf", slab(circle_plan(kButton[0], kButton[1], 4.6), seat, dome),
               {"TPU 85A", 1.21, {0.96, 0.74, 0.20}, 0}));
  return set;
}

}  // namespace lamella::datasets
