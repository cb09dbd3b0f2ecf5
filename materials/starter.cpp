#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "core/xml.h"
#include "materials/color.h"
#include "materials/field.h"
#include "materials/glob.h"
#include "materials/material_rules.h"

namespace lamella {

namespace {

/// What a rule could select a solid by, empty when the solid lacks it; two solids with the same text are selected
/// alike.
using Selector = std::string (*)(const SolidInfo&);

std::string select_step_material(const SolidInfo& solid) { return escape_glob(solid.step_material); }
std::string select_color(const SolidInfo& solid) { return solid.color ? format_color(*solid.color) : std::string(); }
std::string select_name(const SolidInfo& solid) { return escape_glob(solid.name); }
std::string select_path(const SolidInfo& solid) { return escape_glob(solid.path); }

/// One way to select, and the attribute it is written as.
struct SelectorKind {
  const char* attribute;
  Selector selector;
};

constexpr std::array kSelectors{SelectorKind{"step_material", select_step_material},
                                SelectorKind{"color", select_color}, SelectorKind{"name", select_name},
                                SelectorKind{"path", select_path}};

std::string limits_text(const ThicknessLimits& limits) {
  std::string text;
  if (limits.deviation) text += attribute_text("deviation", format_double(*limits.deviation));
  if (limits.least) text += attribute_text("layer_min", format_double(*limits.least));
  if (limits.most) text += attribute_text("layer_max", format_double(*limits.most));
  return text;
}

/// A graded material with its components and its field, a plain one on a line.
std::string material_lines(const Material& material, const MaterialTable& table, const std::filesystem::path& beside) {
  const bool is_graded = material.is_graded() && material.field != nullptr;
  std::string lines =
      std::string("    <") + (is_graded ? "graded" : "material") + attribute_text("name", material.name);
  if (material.density && !is_graded) lines += attribute_text("density", format_double(*material.density));
  lines += attribute_text("color", format_color(material.color)) + limits_text(material.layers);
  if (!is_graded) return lines + "/>\n";
  lines += ">\n";
  for (const MaterialId component : material.components) {
    lines += "      <component" + attribute_text("material", table.materials[component].name) + "/>\n";
  }
  return lines + material.field->element("      ", beside) + "    </graded>\n";
}

/// Files of plain materials are read by every program that reads version 1.0.
const char* version_for(const MaterialTable& table) {
  const bool is_plain = std::all_of(table.materials.begin(), table.materials.end(), [](const Material& material) {
    return !material.is_graded() && limits_text(material.layers).empty();
  });
  return is_plain ? "1.0" : "1.3";
}

/// Writes rules until every solid is covered by one that gives it the table's material and priority. Paths are unique,
/// so the last kind of selector covers what is left.
class RuleWriter {
 public:
  RuleWriter(const Scene& scene, const MaterialTable& table)
      : scene_(scene), table_(table), covered_(scene.solids.size(), 0) {}

  std::string run() {
    for (const SelectorKind& kind : kSelectors) add_rules(kind);
    return std::move(lines_);
  }

 private:
  void add_rules(const SelectorKind& kind) {
    std::map<std::string, std::vector<SolidId>> groups;
    for (const SolidId solid : scene_.solids.ids()) {
      if (covered_[solid]) continue;
      const std::string text = kind.selector(scene_.solids[solid].info);
      if (!text.empty()) groups[text].push_back(solid);
    }
    for (const auto& [text, solids] : groups) add_rule(kind, text, solids);
  }

  void add_rule(const SelectorKind& kind, const std::string& text, const std::vector<SolidId>& solids) {
    const Assignment& wanted = table_.assignments[solids.front()];
    for (const SolidId solid : solids) {
      const Assignment& has = table_.assignments[solid];
      if (has.material != wanted.material || has.priority != wanted.priority) return;
    }
    for (const SolidId solid : solids) covered_[solid] = 1;
    lines_ += "    <assign" + attribute_text(kind.attribute, text);
    lines_ += attribute_text("material", table_.materials[wanted.material].name);
    if (wanted.priority != 0) lines_ += attribute_text("priority", std::to_string(wanted.priority));
    lines_ += "/>\n";
  }

  const Scene& scene_;
  const MaterialTable& table_;
  IdVector<SolidId, char> covered_;
  std::string lines_;
};

constexpr const char* kHead = R"(<?xml version="1.0" encoding="UTF-8"?>
<materials xmlns="urn:lamella:materials:1" version=")";

constexpr const char* kLibrary = R"(">
  <!-- density in g/cm^3; priority (higher wins where solids overlap) may be added to a material or an assign -->
  <library>
)";

constexpr const char* kMiddle = R"(  </library>
  <!-- the first assign that matches a solid wins; name, path, layer and step_material take * ? [..] -->
  <assignments>
)";

}  // namespace

std::string starter_rules(const Scene& scene, const MaterialTable& table, const std::filesystem::path& beside) {
  std::string out = std::string(kHead) + version_for(table) + kLibrary;
  for (const Material& material : table.materials) out += material_lines(material, table, beside);
  out += kMiddle;
  out += RuleWriter(scene, table).run();
  return out + "  </assignments>\n</materials>\n";
}

}  // namespace lamella
