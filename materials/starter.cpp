#include <array>
#include <map>
#include <vector>

#include "core/xml.h"
#include "materials/color.h"
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

std::string attribute(const char* name, const std::string& value) {
  return std::string(" ") + name + "=\"" + xml_escape(value) + "\"";
}

std::string material_line(const Material& material) {
  std::string line = "    <material" + attribute("name", material.name);
  if (material.density) line += attribute("density", format_double(*material.density));
  return line + attribute("color", format_color(material.color)) + "/>\n";
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
    lines_ += "    <assign" + attribute(kind.attribute, text);
    lines_ += attribute("material", table_.materials[wanted.material].name);
    if (wanted.priority != 0) lines_ += attribute("priority", std::to_string(wanted.priority));
    lines_ += "/>\n";
  }

  const Scene& scene_;
  const MaterialTable& table_;
  IdVector<SolidId, char> covered_;
  std::string lines_;
};

constexpr const char* kHead = R"(<?xml version="1.0" encoding="UTF-8"?>
<materials xmlns="urn:lamella:materials:1" version="1.0">
  <!-- density in g/cm^3; priority (higher wins where solids overlap) may be added to a material or an assign -->
  <library>
)";

constexpr const char* kMiddle = R"(  </library>
  <!-- the first assign that matches a solid wins; name, path, layer and step_material take * ? [..] -->
  <assignments>
)";

}  // namespace

std::string starter_rules(const Scene& scene, const MaterialTable& table) {
  std::string out = kHead;
  for (const Material& material : table.materials) out += material_line(material);
  out += kMiddle;
  out += RuleWriter(scene, table).run();
  return out + "  </assignments>\n</materials>\n";
}

}  // namespace lamella
