#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "core/utf8.h"
#include "core/xml.h"
#include "materials/color.h"
#include "materials/material_rules.h"

namespace lamella {

namespace {

/// Why two solids share a material when nobody said so; sorted by how much the STEP file tells.
enum class Basis { step_material, color, name };

/// Solids with equal keys are made of the same.
struct Key {
  Basis basis = Basis::name;
  std::string value;
  std::optional<double> density;  ///< only where one STEP material comes with several densities

  auto operator<=>(const Key&) const = default;
};

/// What the solids of one key have in common.
struct Group {
  std::optional<double> density;
  std::set<std::string> colors;
  Color color{};
};

const char* word_of(Basis basis) {
  switch (basis) {
    case Basis::step_material:
      return "STEP material";
    case Basis::color:
      return "color";
    case Basis::name:
      break;
  }
  return "name";
}

/// One line that fits a material's name: what can't stand in XML is replaced, line breaks and outer blanks go.
std::string clean_name(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const CodePoint c = decode_utf8(text, at);
    const bool bad = c.length == 0 || !is_xml_character(c.value) || c.value < 0x20;
    out += bad ? " " : text.substr(at, c.length);
    at += c.length > 0 ? c.length : 1;
  }
  const std::size_t first = out.find_first_not_of(' ');
  if (first == std::string::npos) return "unnamed";
  return out.substr(first, out.find_last_not_of(' ') - first + 1);
}

/// The density the file states, unless it is beyond what any material has (a slip of units).
std::optional<double> credible_density(const SolidInfo& solid) {
  if (solid.step_density && *solid.step_density > 0.0 && *solid.step_density <= kMaxDensity) return solid.step_density;
  return std::nullopt;
}

/// Known densities of each STEP material; more than one means that one name stands for several materials.
using Densities = std::map<std::string, std::set<double>>;

Densities collect_densities(const Scene& scene) {
  Densities densities;
  for (const Solid& solid : scene.solids) {
    const auto density = credible_density(solid.info);
    if (!solid.info.step_material.empty() && density) densities[solid.info.step_material].insert(*density);
  }
  return densities;
}

Key key_of(const SolidInfo& solid, const Densities& densities) {
  if (!solid.step_material.empty()) {
    const auto known = densities.find(solid.step_material);
    const bool several = known != densities.end() && known->second.size() > 1;
    return {Basis::step_material, solid.step_material, several ? credible_density(solid) : std::nullopt};
  }
  if (solid.color) return {Basis::color, format_color(*solid.color), std::nullopt};
  return {Basis::name, solid.name, std::nullopt};
}

std::string name_of(const Key& key) {
  std::string name = key.basis == Basis::color ? color_word(*parse_color(key.value)) : clean_name(key.value);
  if (key.basis == Basis::color) name.append(" ").append(key.value);
  if (key.density) name.append(" ").append(format_double(*key.density)).append(" g/cm3");
  return name;
}

/// A name per key; where two keys would share one, the later says what it rests on.
std::map<std::string, Key> name_keys(const std::map<Key, Group>& groups) {
  std::map<std::string, Key> keys;
  for (const auto& [key, group] : groups) {
    std::string name = name_of(key);
    if (keys.contains(name)) name.append(" (").append(word_of(key.basis)).append(")");
    const std::string stem = name;
    for (int i = 2; keys.contains(name); ++i) name = stem + " " + std::to_string(i);
    keys.emplace(name, key);
  }
  return keys;
}

/// A material keeps the one colour its solids share in the file, unless an earlier material has it already.
void choose_colors(const std::map<std::string, Key>& names, std::map<Key, Group>& groups) {
  std::set<std::string> used;
  std::vector<Group*> undecided;
  for (const auto& [name, key] : names) {
    Group& group = groups.at(key);
    if (group.colors.size() == 1 && used.insert(*group.colors.begin()).second) {
      group.color = *parse_color(*group.colors.begin());
    } else {
      undecided.push_back(&group);
    }
  }
  std::size_t next = 0;
  for (Group* group : undecided) {
    do {
      group->color = distinct_color(next++);
    } while (!used.insert(format_color(group->color)).second);
  }
}

}  // namespace

MaterialTable assign_materials(const Scene& scene) {
  const Densities densities = collect_densities(scene);
  std::map<Key, Group> groups;
  for (const Solid& solid : scene.solids) {
    Group& group = groups[key_of(solid.info, densities)];
    if (const auto density = credible_density(solid.info)) group.density = density;
    if (solid.info.color) group.colors.insert(format_color(*solid.info.color));
  }
  const std::map<std::string, Key> names = name_keys(groups);
  choose_colors(names, groups);

  MaterialTable table;
  std::map<Key, MaterialId> ids;
  for (const auto& [name, key] : names) {
    const Group& group = groups.at(key);
    ids[key] = table.materials.push_back({name, group.density, group.color});
  }
  for (const Solid& solid : scene.solids) {
    const Key key = key_of(solid.info, densities);
    table.assignments.push_back({ids.at(key), 0, word_of(key.basis)});
  }
  return table;
}

}  // namespace lamella
