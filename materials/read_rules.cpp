#include <algorithm>
#include <map>
#include <tuple>

#include "core/error.h"
#include "core/xml.h"
#include "materials/color.h"
#include "materials/glob.h"
#include "materials/material_rules.h"

namespace lamella {

namespace {

constexpr const char* kNamespace = "urn:lamella:materials:1";
constexpr long kMaxPriority = 1000000;

std::string in_quotes(const std::string& text) { return "'" + text + "'"; }

/// A name on one line, without blanks at its ends.
std::string read_name(const XmlElement& element, const char* attribute) {
  std::string name = element.attribute(attribute);
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
  const bool multiline = name.find_first_of("\r\n") != std::string::npos;
  if (name.empty() || multiline || blank(name.front()) || blank(name.back())) {
    throw InputError(std::string(attribute) + "=\"" + name + "\" is no name", element.where(),
                     "write one line, not empty, without blanks at its ends");
  }
  return name;
}

int read_priority(const XmlElement& element, int fallback) {
  const long priority = element.integer_or("priority", fallback);
  if (priority < -kMaxPriority || priority > kMaxPriority) {
    throw InputError("priority " + std::to_string(priority) + " is out of range", element.where(),
                     "use -1000000 to 1000000; the higher wins");
  }
  return static_cast<int>(priority);
}

Color read_color(const XmlElement& element) {
  const std::string text = element.attribute("color");
  if (const auto color = parse_color(text)) return *color;
  throw InputError("color=\"" + text + "\" is no colour", element.where(), "write it as #rrggbb, e.g. #e6325a");
}

double read_density(const XmlElement& element) {
  const double density = element.number("density");
  if (density > 0.0 && density <= kMaxDensity) return density;
  throw InputError("density " + element.attribute("density") + " is out of range", element.where(),
                   "give it in g/cm^3 (steel: 7.85), more than 0 and at most 100");
}

std::string read_glob(const XmlElement& element, const char* attribute) {
  std::string glob = element.attribute(attribute);
  if (glob.empty()) throw InputError(std::string(attribute) + " is empty", element.where(), "leave it out or fill it");
  if (const auto fault = glob_fault(glob)) {
    throw InputError("the pattern " + in_quotes(glob) + " can't be used: " + *fault, element.where(),
                     "see docs/formats/materials.md");
  }
  return glob;
}

void refuse_text(const XmlElement& element) {
  if (!element.text().empty()) throw InputError("unexpected text", element.where(), "remove it");
}

/// Reads one file step by step; later steps rely on the names the library defined.
class RulesReader {
 public:
  explicit RulesReader(const XmlElement& root) {
    root.allow_only({"version"}, {"library", "assignments"});
    check_head(root);
    const auto library = root.child("library");
    if (!library) throw InputError("no <library>", root.where(), "list the materials in it");
    read_library(*library);
    if (const auto assignments = root.child("assignments")) {
      if (assignments->line() < library->line()) {
        throw InputError("<assignments> comes before <library>", assignments->where(), "put the library first");
      }
      read_assignments(*assignments);
    }
  }

  [[nodiscard]] MaterialRules take() { return std::move(rules_); }

 private:
  static void check_head(const XmlElement& root) {
    if (root.attribute_or("xmlns", "") != kNamespace) {
      throw InputError("not a Lamella materials file", root.where(),
                       std::string("the root needs xmlns=\"") + kNamespace + "\"");
    }
    const std::string version = root.attribute("version");
    const bool digits =
        version.size() > 2 && version.size() < 7 && version.find_first_not_of("0123456789", 2) == std::string::npos;
    if (version.starts_with("1.") && digits) return;
    throw InputError("version " + in_quotes(version) + " isn't known", root.where(), "this program reads version 1.0");
  }

  void read_library(const XmlElement& library) {
    library.allow_only({}, {"material"});
    for (const XmlElement& element : library.children("material")) read_material(element);
    if (rules_.library.empty()) throw InputError("the library is empty", library.where(), "add a <material>");
  }

  void read_material(const XmlElement& element) {
    element.allow_only({"name", "density", "color", "priority"}, {});
    refuse_text(element);
    Material material;
    material.name = read_name(element, "name");
    const auto [first, added] = lines_.emplace(material.name, element.line());
    if (!added) {
      throw InputError("material " + in_quotes(material.name) + " is defined twice", element.where(),
                       "the first is in line " + std::to_string(first->second));
    }
    if (element.has("density")) material.density = read_density(element);
    material.color = element.has("color") ? read_color(element) : distinct_color(rules_.library.size());
    rules_.priorities.push_back(read_priority(element, 0));
    rules_.library.push_back(std::move(material));
  }

  void read_assignments(const XmlElement& assignments) {
    assignments.allow_only({"default"}, {"assign"});
    if (assignments.has("default")) rules_.fallback = read_reference(assignments, "default");
    for (const XmlElement& element : assignments.children("assign")) read_rule(element);
  }

  /// The name of a material that the library must have.
  std::string read_reference(const XmlElement& element, const char* attribute) const {
    std::string name = read_name(element, attribute);
    if (lines_.contains(name)) return name;
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
  std::map<std::string, int> lines_;
  std::map<Selector, std::string> selectors_;
};

}  // namespace

MaterialRules read_material_rules(const std::filesystem::path& path) {
  const XmlDocument document = XmlDocument::read(path);
  MaterialRules rules = RulesReader(document.root("materials")).take();
  rules.source = path.string();
  return rules;
}

}  // namespace lamella
