#include "slicing/adaptive/layer_costs.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/xml.h"

namespace lamella {

namespace {

constexpr double kTouch = 1e-9;  // mm, of heights

/// To a nanometre, in the fewest digits.
std::string number(double value) { return format_double(std::round(value * 1e6) / 1e6); }
std::string mm(double value) { return number(value) + " mm"; }

}  // namespace

double LayerCosts::deviation(MaterialId material, std::size_t border, std::size_t thickness) const {
  const auto& profile = slants_.profiles[material];
  return profile ? profile->layer_deviation(2 * border, 2 * (border + thickness)) : 0.0;
}

double LayerCosts::deviation(std::size_t border, std::size_t thickness) const {
  double most = 0.0;
  for (const MaterialId id : rules_.materials.ids()) most = std::max(most, deviation(id, border, thickness));
  return most;
}

bool LayerCosts::has(MaterialId material, std::size_t border, std::size_t thickness) const {
  const double bottom = height(border);
  const double top = height(border + thickness);
  double common = 0.0;
  for (const Interval& z : slants_.heights[material]) {
    common += std::max(0.0, std::min(top, z.hi) - std::max(bottom, z.lo));
  }
  return common > 0.5 * rules_.quantum + kTouch;
}

bool LayerCosts::accepts(MaterialId material, std::size_t border, std::size_t thickness) const {
  const MaterialLayers& asked = rules_.materials[material];
  const double own = static_cast<double>(thickness) * rules_.quantum;
  if (!asked.takes(own) && has(material, border, thickness)) return false;
  return deviation(material, border, thickness) <= asked.deviation + kTouch;
}

bool LayerCosts::accepts(std::size_t border, std::size_t thickness) const {
  for (const MaterialId id : rules_.materials.ids()) {
    if (!accepts(id, border, thickness)) return false;
  }
  return true;
}

/// "'Steel' takes 0.1 to 0.3 mm": what a material asks of layers on a border.
std::string LayerCosts::demand(MaterialId material, std::size_t border) const {
  const MaterialLayers& asked = rules_.materials[material];
  const std::string name = "'" + table_.materials[material].name + "'";
  std::string text = name + " takes " + thickness_text(asked);
  double most = 0.0;
  for (const std::size_t t : rules_.thicknesses) {
    if (deviation(material, border, t) <= asked.deviation + kTouch) most = static_cast<double>(t) * rules_.quantum;
  }
  const double least = static_cast<double>(rules_.thicknesses.front()) * rules_.quantum;
  if (most == 0.0) {
    return text + " and deviates by " + mm(deviation(material, border, rules_.thicknesses.front())) + " already at " +
           mm(least) + ", with " + mm(asked.deviation) + " allowed";
  }
  const double largest = static_cast<double>(rules_.thicknesses.back()) * rules_.quantum;
  if (most < largest) text += ", at most " + mm(most) + " there to deviate by no more than " + mm(asked.deviation);
  return text;
}

void LayerCosts::refuse_at(std::size_t border, const std::vector<MaterialId>& materials) const {
  const double z = height(border);
  std::string names;
  std::string demands;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    names += (i == 0 ? "'" : i + 1 == materials.size() ? " and '" : ", '") + table_.materials[materials[i]].name + "'";
    demands += (i == 0 ? "" : "; ") + demand(materials[i], border);
  }
  const char* what = materials.size() == 1 ? "no layer suits the material " : "no layer suits the materials ";
  const char* hint =
      materials.size() == 1
          ? "allow it a larger deviation or other thicknesses: deviation, layer_min and layer_max in the "
            "library, those of the machine's tools, --adaptive-range"
          : "give them a thickness in common: layer_min and layer_max in the library and of the machine's "
            "tools and materials, --adaptive-range";
  throw InputError(what + names + " from z = " + mm(z) + " on: " + demands,
                   "z = " + mm(z) + " to " + mm(height(border + rules_.thicknesses.back())), hint);
}

void LayerCosts::refuse(const std::vector<std::size_t>& reached) const {
  std::vector<MaterialId> all;
  for (const MaterialId id : rules_.materials.ids()) {
    if (slants_.profiles[id]) all.push_back(id);
  }
  const auto clashes = [&](std::size_t border, MaterialId a, MaterialId b) {
    return std::none_of(rules_.thicknesses.begin(), rules_.thicknesses.end(),
                        [&](std::size_t t) { return accepts(a, border, t) && accepts(b, border, t); });
  };
  const std::size_t border = reached.empty() ? 0 : reached.back();
  for (const MaterialId a : all) {
    if (clashes(border, a, a)) refuse_at(border, {a});
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      if (clashes(border, all[i], all[j])) refuse_at(border, {all[i], all[j]});
    }
  }
  refuse_at(border, all);
}

}  // namespace lamella
