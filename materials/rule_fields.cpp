#include "materials/rule_fields.h"

#include "core/error.h"
#include "materials/color.h"
#include "materials/glob.h"
#include "materials/material_table.h"

namespace lamella {

namespace {

constexpr const char* kNamespace = "urn:lamella:materials:1";
constexpr long kMaxPriority = 1000000;
constexpr double kMinThickness = 1e-6;  // mm
constexpr double kMaxThickness = 1000.0;

}  // namespace

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

std::optional<double> read_thickness(const XmlElement& element, const char* attribute) {
  if (!element.has(attribute)) return std::nullopt;
  const double value = element.number(attribute);
  if (value >= kMinThickness && value <= kMaxThickness) return value;
  throw InputError(std::string(attribute) + "=\"" + element.attribute(attribute) + "\" is out of range",
                   element.where(), "give mm, 0.000001 to 1000");
}

void check_thicknesses(const XmlElement& element, const std::optional<double>& least,
                       const std::optional<double>& most) {
  if (!least || !most || *least <= *most) return;
  throw InputError("layer_min is more than layer_max", element.where(), "swap them");
}

std::string read_glob(const XmlElement& element, const char* attribute) {
  std::string glob = element.attribute(attribute);
  if (glob.empty()) throw InputError(std::string(attribute) + " is empty", element.where(), "leave it out or fill it");
  if (const auto fault = glob_fault(glob)) {
    throw InputError("the pattern '" + glob + "' can't be used: " + *fault, element.where(),
                     "see docs/formats/materials.md");
  }
  return glob;
}

void refuse_text(const XmlElement& element) {
  if (!element.text().empty()) throw InputError("unexpected text", element.where(), "remove it");
}

void check_materials_head(const XmlElement& root) { check_xml_head(root, kNamespace, "materials file"); }

}  // namespace lamella
