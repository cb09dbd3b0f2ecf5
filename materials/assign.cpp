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

bool stands_for(const LibraryMatch& match, const SolidInfo& solid) {
  switch (match.source) {
    case MaterialSource::step_material:
      return matches_glob(match.pattern, solid.step_material);
    case MaterialSource::layer:
      return matches_glob(match.pattern, solid.layer);
    case MaterialSource::name:
      return matches_glob(match.pattern, solid.name);
    case MaterialSource::path:
      return matches_glob(match.pattern, solid.path);
    case MaterialSource::color:
      return match.color && solid.color && same_color(*match.color, *solid.color);
  }
  return false;
}

/// The match in the user's words: "metals.xml:12 step_material=AISI 3*".
std::string describe(const LibraryMatch& match) {
  const std::string value = match.color ? format_color(*match.color) : match.pattern;
  for (const auto& [source, word] : kMaterialSources) {
    if (source == match.source) return match.where + " " + word + "=" + value;
  }
  return match.where;
}

/// What the library knows of a solid by one source; two materials that both stand for it are a mistake in it.
const LibraryMatch* find_match(const SolidInfo& solid, const MaterialRules& rules, MaterialSource source) {
  const LibraryMatch* found = nullptr;
  for (const LibraryMatch& match : rules.matches) {
    if (match.source != source || !stands_for(match, solid)) continue;
    if (found == nullptr) found = &match;
    if (found->material == match.material) continue;
    throw InputError("two materials of the library stand for the solid '" + solid.path + "': '" +
                         rules.library[found->material].name + "' and '" + rules.library[match.material].name + "'",
                     describe(*found) + " and " + describe(match),
                     "narrow one of them, or give the solid a line of its own: <solid path=...>");
  }
  return found;
}

std::optional<Assignment> assign_by_override(const SolidInfo& solid, const MaterialRules& rules) {
  for (const SolidOverride& own : rules.overrides) {
    if (own.path != solid.path) continue;
    const MaterialId material = find_material(rules, own.material, own.where);
    return Assignment{material, own.priority.value_or(priority_of(rules, material)), own.where + " path=" + own.path};
  }
  return std::nullopt;
}

std::optional<Assignment> assign_by_rule(const SolidInfo& solid, const MaterialRules& rules) {
  for (const MaterialRule& rule : rules.rules) {
    if (!rule_matches(rule, solid)) continue;
    const MaterialId material = find_material(rules, rule.material, rule.where);
    return Assignment{material, rule.priority.value_or(priority_of(rules, material)), describe(rule)};
  }
  return std::nullopt;
}

std::optional<Assignment> assign_by_source(const SolidInfo& solid, const MaterialRules& rules) {
  for (const MaterialSource source : rules.sources) {
    const LibraryMatch* match = find_match(solid, rules, source);
    if (match == nullptr) continue;
    const MaterialId material{match->material};
    return Assignment{material, priority_of(rules, material), describe(*match)};
  }
  return std::nullopt;
}

/// Nothing when not even a default covers the solid.
std::optional<Assignment> assign(const SolidInfo& solid, const MaterialRules& rules) {
  if (auto own = assign_by_override(solid, rules)) return own;
  if (auto ruled = assign_by_rule(solid, rules)) return ruled;
  if (auto known = assign_by_source(solid, rules)) return known;
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
      "add an <assign> for each, or name a default in <assignments default=\"...\">; lamella info FILE... shows what "
      "the file says of them");
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

namespace {

Finding unused(const std::string& rule, bool matches) {
  Finding finding;
  finding.what = "rule " + rule + " decides about no solid";
  finding.hint = matches ? "earlier rules take all that it matches" : "nothing matches it: see lamella info";
  return finding;
}

bool has_override(const SolidInfo& solid, const MaterialRules& rules) {
  return std::any_of(rules.overrides.begin(), rules.overrides.end(),
                     [&](const SolidOverride& own) { return own.path == solid.path; });
}

}  // namespace

std::vector<Finding> find_unused_rules(const Scene& scene, const MaterialRules& rules) {
  std::vector<bool> matches(rules.rules.size(), false);
  std::vector<bool> decides(rules.rules.size(), false);
  for (const Solid& solid : scene.solids) {
    bool decided = has_override(solid.info, rules);
    for (std::size_t r = 0; r < rules.rules.size(); ++r) {
      if (!rule_matches(rules.rules[r], solid.info)) continue;
      matches[r] = true;
      if (!decided) decides[r] = true;
      decided = true;
    }
  }
  std::vector<Finding> findings;
  for (const SolidOverride& own : rules.overrides) {
    const bool is_there = std::any_of(scene.solids.begin(), scene.solids.end(),
                                      [&](const Solid& solid) { return solid.info.path == own.path; });
    if (!is_there) findings.push_back(unused(own.where + " path=" + own.path, false));
  }
  for (std::size_t r = 0; r < rules.rules.size(); ++r) {
    if (!decides[r]) findings.push_back(unused(describe(rules.rules[r]), matches[r]));
  }
  return findings;
}

}  // namespace lamella
