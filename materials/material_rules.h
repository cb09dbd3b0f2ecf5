#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
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

/// What of a solid may say what it is made of.
enum class MaterialSource { step_material, layer, color, name, path };

/// The words for them in materials.xml.
inline constexpr std::array<std::pair<MaterialSource, const char*>, 5> kMaterialSources{
    {{MaterialSource::step_material, "step_material"},
     {MaterialSource::layer, "layer"},
     {MaterialSource::color, "color"},
     {MaterialSource::name, "name"},
     {MaterialSource::path, "path"}}};

/// What a library says that one of its materials stands for.
struct LibraryMatch {
  std::size_t material = 0;  ///< in MaterialRules::library
  MaterialSource source = MaterialSource::step_material;
  std::string pattern;         ///< glob; not of MaterialSource::color
  std::optional<Color> color;  ///< of MaterialSource::color
  std::string where;           ///< file:line
};

/// One solid's own line, which goes before every rule.
struct SolidOverride {
  std::string path;  ///< the whole of it, no pattern
  std::string material;
  std::optional<int> priority;
  std::string where;  ///< file:line
};

/// The contents of materials.xml. A solid gets its material from the override with its path, else from the first rule
/// that matches, else from the first source for which a library material stands, else it gets the default.
struct MaterialRules {
  std::vector<Material> library;
  std::vector<int> priorities;        ///< one per library entry, the default of its solids
  std::vector<LibraryMatch> matches;  ///< in the order of the library
  std::vector<SolidOverride> overrides;
  std::vector<MaterialRule> rules;
  std::vector<MaterialSource> sources;       ///< in the order in which they are asked; empty: none is
  std::optional<std::string> fallback;       ///< material of solids that no rule covers
  std::string source;                        ///< file name, for messages
  std::vector<std::filesystem::path> files;  ///< that it names: included libraries, tables, grids
};

/// Reads materials.xml (schemas/materials.xsd). Throws InputError with file, line and hint.
[[nodiscard]] MaterialRules read_material_rules(const std::filesystem::path& path);

/// Applies the rules. Throws InputError that lists every solid nothing covers, unless a default is named; or that names
/// the solid for which two library materials stand by the same source.
[[nodiscard]] MaterialTable assign_materials(const Scene& scene, const MaterialRules& rules);

/// Without a file: one material per STEP material, else per colour ("steel blue #4682b4"), else per name.
/// Materials are sorted by name, so that ids don't depend on the order of the solids; every colour is used once.
[[nodiscard]] MaterialTable assign_materials(const Scene& scene);

/// Warnings on rules and overrides that decide about no solid, because none matches or an earlier one takes them all.
[[nodiscard]] std::vector<Finding> find_unused_rules(const Scene& scene, const MaterialRules& rules);

/// Whether every selector that the rule sets matches.
[[nodiscard]] bool rule_matches(const MaterialRule& rule, const SolidInfo& solid);

/// A materials.xml that reproduces `table` on `scene`, one rule a solid group, for the user to edit. Graded materials
/// keep components and field, all of them how thick layers may be. `beside` is the folder that the file is for: grids
/// are named from there.
[[nodiscard]] std::string starter_rules(const Scene& scene, const MaterialTable& table,
                                        const std::filesystem::path& beside = std::filesystem::current_path());

}  // namespace lamella
