#pragma once

#include <string>
#include <utility>
#include <vector>

#include "materials/material_rules.h"
#include "model/scene.h"

namespace lamella::test {

/// A solid that has no geometry, only what rules look at.
struct BareSolid {
  std::string name;
  std::string step_material = {};
  std::optional<Color> color = std::nullopt;
  std::string layer = {};
  std::optional<double> density = std::nullopt;
};

/// A scene of such solids; paths are "/assembly/<name>" and the position where the name repeats.
inline Scene bare_scene(const std::vector<BareSolid>& solids) {
  Scene scene;
  for (const BareSolid& bare : solids) {
    Solid solid;
    solid.info.name = bare.name;
    solid.info.path = "/assembly/" + bare.name;
    for (const Solid& other : scene.solids) {
      if (other.info.path == solid.info.path) solid.info.path += "." + std::to_string(scene.solids.size());
    }
    solid.info.step_material = bare.step_material;
    solid.info.color = bare.color;
    solid.info.layer = bare.layer;
    solid.info.step_density = bare.density;
    scene.solids.push_back(std::move(solid));
  }
  return scene;
}

/// The material names of the solids, in order.
inline std::vector<std::string> material_names(const MaterialTable& table) {
  std::vector<std::string> names;
  for (const Assignment& a : table.assignments) names.push_back(table.materials[a.material].name);
  return names;
}

}  // namespace lamella::test
