#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "materials/material_table.h"

namespace lamella {

/// One line of the assignment: all selectors that are set must match (globs with * ? and [..], as fnmatch(3)).
struct MaterialRule {
  std::optional<std::string> name;           ///< glob on the solid's name
  std::optional<std::string> path;           ///< glob on its path; * also matches '/'
  std::optional<std::string> layer;          ///< glob
  std::optional<std::string> step_material;  ///< glob
  std::optional<Color> color;                ///< matches within half a step of 8-bit colour
  std::string material;                      ///< name in the library
  std::optional<int> priority;
  std::string where;  ///< file:line, for reports
};

/// The contents of materials.xml: a library, rules of which the first that matches wins, and perhaps a default.
struct MaterialRules {
  std::vector<Material> library;
  std::vector<int> priorities;  ///< one per library entry, the default of its solids
  std::vector<MaterialRule> rules;
  std::optional<std::string> fallback;  ///< material of solids that no rule covers
  std::string source;                   ///< file name, for messages
};

/// Reads materials.xml (schemas/materials.xsd). Throws InputError with file, line and hint.
[[nodiscard]] MaterialRules read_material_rules(const std::filesystem::path& path);

/// Applies the rules. Throws InputError that lists every solid no rule covers, unless a default is named.
[[nodiscard]] MaterialTable assign_materials(const Scene& scene, const MaterialRules& rules);

/// Without a file: one material per STEP material, else per colour ("steel blue #4682b4"), else per name.
/// Materials are sorted by name, so that ids don't depend on the order of the solids; every colour is used once.
[[nodiscard]] MaterialTable assign_materials(const Scene& scene);

/// Warnings on rules that decide about no solid, because none matches or an earlier rule takes them all.
[[nodiscard]] std::vector<Finding> find_unused_rules(const Scene& scene, const MaterialRules& rules);

/// Whether every selector that the rule sets matches.
[[nodiscard]] bool rule_matches(const MaterialRule& rule, const SolidInfo& solid);

/// A materials.xml that reproduces `table` on `scene`, one rule a solid group, for the user to edit.
[[nodiscard]] std::string starter_rules(const Scene& scene, const MaterialTable& table);

}  // namespace lamella
