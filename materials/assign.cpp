#include <algorithm>

#include "core/error.h"
#include "materials/color.h"
#include "materials/glob.h"
#include "materials/material_rules.h"

namespace lamella {

namespace {

bool glob_accepts(const std::optional<std::string>& pattern, const std::string& text) {
  return !pattern || matches_glob(*pattern, text);
}

/// The rule in the user's words: "materials.xml:12 name=Grip*".
std::string describe(const MaterialRule& rule) {
  std::string out = rule.where;
  const auto add = [&out](const char* key, const std::string& value) {
    out.append(" ").append(key).append("=" + value);
  };
  if (rule.name) add("name", *rule.name);
  if (rule.path) add("path", *rule.path);
  if (rule.layer) add("layer", *rule.layer);
  if (rule.step_material) add("step_material", *rule.step_material);
  if (rule.color) add("color", format_color(*rule.color));
  return out;
}

MaterialId find_material(const MaterialRules& rules, const std::string& name, const std::string& where) {
  const auto found = std::find_if(rules.library.begin(), rules.library.end(),
                                  [&name](const Material& material) { return material.name == name; });
  if (found != rules.library.end()) return MaterialId{static_cast<std::size_t>(found - rules.library.begin())};
  throw InputError("material '" + name + "' isn't in the library", where, "add it or correct the name");
}

int priority_of(const MaterialRules& rules, MaterialId material) {
  return material.value() < rules.priorities.size() ? rules.priorities[material.value()] : 0;
}

/// What the first matching rule, else the default, makes of a solid; nothing when neither covers it.
std::optional<Assignment> assign(const SolidInfo& solid, const MaterialRules& rules) {
  for (const MaterialRule& rule : rules.rules) {
    if (!rule_matches(rule, solid)) continue;
    const MaterialId material = find_material(rules, rule.material, rule.where);
    return Assignment{material, rule.priority.value_or(priority_of(rules, material)), describe(rule)};
  }
  if (!rules.fallback) return std::nullopt;
  const MaterialId material = find_material(rules, *rules.fallback, rules.source);
  return Assignment{material, priority_of(rules, material), rules.source + " default"};
}

[[noreturn]] void refuse_uncovered(const std::vector<std::string>& paths, const std::string& source) {
  std::string list;
  for (const std::string& path : paths) list += (list.empty() ? "" : ", ") + path;
  const bool one = paths.size() == 1;
  throw InputError(
      (one ? "1 solid has no material: " : std::to_string(paths.size()) + " solids have no material: ") + list, source,
      "add an <assign> for each, or name a default in <assignments default=\"...\">");
}

}  // namespace

bool rule_matches(const MaterialRule& rule, const SolidInfo& solid) {
  const bool color_matches = !rule.color || (solid.color && same_color(*rule.color, *solid.color));
  return color_matches && glob_accepts(rule.name, solid.name) && glob_accepts(rule.path, solid.path) &&
         glob_accepts(rule.layer, solid.layer) && glob_accepts(rule.step_material, solid.step_material);
}

MaterialTable assign_materials(const Scene& scene, const MaterialRules& rules) {
  MaterialTable table;
  for (const Material& material : rules.library) table.materials.push_back(material);
  std::vector<std::string> uncovered;
  for (const Solid& solid : scene.solids) {
    auto assignment = assign(solid.info, rules);
    if (!assignment) uncovered.push_back(solid.info.path);
    table.assignments.push_back(assignment.value_or(Assignment{}));
  }
  if (!uncovered.empty()) refuse_uncovered(uncovered, rules.source);
  return table;
}

std::vector<Finding> find_unused_rules(const Scene& scene, const MaterialRules& rules) {
  std::vector<bool> matches(rules.rules.size(), false);
  std::vector<bool> decides(rules.rules.size(), false);
  for (const Solid& solid : scene.solids) {
    bool decided = false;
    for (std::size_t r = 0; r < rules.rules.size(); ++r) {
      if (!rule_matches(rules.rules[r], solid.info)) continue;
      matches[r] = true;
      if (!decided) decides[r] = true;
      decided = true;
    }
  }
  std::vector<Finding> findings;
  for (std::size_t r = 0; r < rules.rules.size(); ++r) {
    if (decides[r]) continue;
    Finding finding;
    finding.what = "rule " + describe(rules.rules[r]) + " decides about no solid";
    finding.hint = matches[r] ? "earlier rules take all that it matches" : "nothing matches it: see lamella info";
    findings.push_back(std::move(finding));
  }
  return findings;
}

}  // namespace lamella
