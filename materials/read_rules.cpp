#include <algorithm>
#include <map>
#include <sstream>
#include <tuple>

#include "core/error.h"
#include "core/xml.h"
#include "materials/material_rules.h"
#include "materials/read_library.h"
#include "materials/rule_fields.h"

namespace lamella {

namespace {

std::string in_quotes(const std::string& text) { return "'" + text + "'"; }

/// The sources that a list of words names, each once.
std::vector<MaterialSource> read_sources(const XmlElement& element) {
  std::vector<MaterialSource> sources;
  std::istringstream words(element.attribute("sources"));
  for (std::string word; words >> word;) {
    const auto known = std::find_if(kMaterialSources.begin(), kMaterialSources.end(),
                                    [&](const auto& source) { return word == source.second; });
    const bool is_new =
        known != kMaterialSources.end() && std::find(sources.begin(), sources.end(), known->first) == sources.end();
    if (!is_new) {
      throw InputError("sources=\"...\" has " + in_quotes(word) + (known == kMaterialSources.end() ? "" : " twice"),
                       element.where(), "list some of step_material, layer, color, name and path, each once");
    }
    sources.push_back(known->first);
  }
  if (sources.empty()) throw InputError("sources is empty", element.where(), "leave it out or fill it");
  return sources;
}

/// Reads one file step by step; later steps rely on the names the library defined.
class RulesReader {
 public:
  RulesReader(const XmlElement& root, const std::filesystem::path& file) : library_(rules_, file) {
    root.allow_only({"version"}, {"library", "assignments"});
    check_materials_head(root);
    const auto library = root.child("library");
    if (!library) throw InputError("no <library>", root.where(), "list the materials in it");
    library_.read(*library);
    if (rules_.library.empty()) throw InputError("the library is empty", library->where(), "add a <material>");
    if (const auto assignments = root.child("assignments")) {
      if (assignments->line() < library->line()) {
        throw InputError("<assignments> comes before <library>", assignments->where(), "put the library first");
      }
      read_assignments(*assignments);
    }
  }

  [[nodiscard]] MaterialRules take() { return std::move(rules_); }

 private:
  void read_assignments(const XmlElement& assignments) {
    assignments.allow_only({"default", "sources"}, {"solid", "assign"});
    if (assignments.has("default")) rules_.fallback = read_reference(assignments, "default");
    if (assignments.has("sources")) rules_.sources = read_sources(assignments);
    for (const XmlElement& element : assignments.children()) {
      if (element.name() == "solid") {
        read_override(element);
      } else {
        read_rule(element);
      }
    }
  }

  void read_override(const XmlElement& element) {
    element.allow_only({"path", "material", "priority"}, {});
    refuse_text(element);
    if (!rules_.rules.empty()) {
      throw InputError("<solid> comes after an <assign>", element.where(), "put it first: it goes before every rule");
    }
    SolidOverride own{read_name(element, "path"), read_reference(element, "material"), {}, element.where()};
    if (element.has("priority")) own.priority = read_priority(element, 0);
    for (const SolidOverride& earlier : rules_.overrides) {
      if (earlier.path != own.path) continue;
      throw InputError("the solid " + in_quotes(own.path) + " has two lines", own.where,
                       "the first is at " + earlier.where);
    }
    rules_.overrides.push_back(std::move(own));
  }

  /// The name of a material that the library must have.
  std::string read_reference(const XmlElement& element, const char* attribute) const {
    std::string name = read_name(element, attribute);
    if (library_.contains(name)) return name;
    std::string known;
    for (const Material& material : rules_.library) known += (known.empty() ? "" : ", ") + material.name;
    throw InputError("material " + in_quotes(name) + " isn't in the library", element.where(), "known: " + known);
  }

  void read_rule(const XmlElement& element) {
    element.allow_only({"name", "path", "layer", "step_material", "color", "material", "priority"}, {});
    refuse_text(element);
    MaterialRule rule;
    const auto glob = [&element](const char* name, std::optional<std::string>& out) {
      if (element.has(name)) out = read_glob(element, name);
    };
    glob("name", rule.name);
    glob("path", rule.path);
    glob("layer", rule.layer);
    glob("step_material", rule.step_material);
    if (element.has("color")) rule.color = read_color(element);
    rule.material = read_reference(element, "material");
    if (element.has("priority")) rule.priority = read_priority(element, 0);
    rule.where = element.where();
    if (!rule.name && !rule.path && !rule.layer && !rule.step_material && !rule.color) {
      throw InputError("<assign> selects nothing", element.where(),
                       "give it name, path, layer, step_material or color; for all the rest use default");
    }
    refuse_conflict(rule);
    rules_.rules.push_back(std::move(rule));
  }

  /// Of two rules that select the same, the second could never apply: whoever wrote it meant something else.
  void refuse_conflict(const MaterialRule& rule) {
    const auto [first, added] =
        selectors_.emplace(std::tuple{rule.name, rule.path, rule.layer, rule.step_material, rule.color}, rule.where);
    if (added) return;
    throw InputError("conflicting rules: this <assign> selects the same as an earlier one", rule.where,
                     "the earlier is at " + first->second + "; the first that matches wins");
  }

  using Selector = std::tuple<std::optional<std::string>, std::optional<std::string>, std::optional<std::string>,
                              std::optional<std::string>, std::optional<Color>>;

  MaterialRules rules_;
  LibraryReader library_;
  std::map<Selector, std::string> selectors_;
};

}  // namespace

MaterialRules read_material_rules(const std::filesystem::path& path) {
  const XmlDocument document = XmlDocument::read(path);
  MaterialRules rules = RulesReader(document.root("materials"), path).take();
  rules.source = path.string();
  return rules;
}

}  // namespace lamella
