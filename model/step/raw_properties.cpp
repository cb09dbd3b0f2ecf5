#include "model/step/raw_properties.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "model/step/entity_label.h"
#include "model/step/text.h"

namespace lamella::step {
namespace {

std::string upper(std::string text) {
  for (char& c : text) {
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  }
  return text;
}

std::string text_of(const Value& value) {
  return value.is(Value::Kind::text) ? clean_name(decode_string(value.text)) : std::string();
}

/// SI prefixes by their name in the standard.
std::optional<double> si_factor(std::string_view prefix) {
  static const std::map<std::string, double, std::less<>> kFactors = {
      {"", 1.0},       {"EXA", 1e18},  {"PETA", 1e15},  {"TERA", 1e12},   {"GIGA", 1e9},   {"MEGA", 1e6},
      {"KILO", 1e3},   {"HECTO", 1e2}, {"DECA", 1e1},   {"DECI", 1e-1},   {"CENTI", 1e-2}, {"MILLI", 1e-3},
      {"MICRO", 1e-6}, {"NANO", 1e-9}, {"PICO", 1e-12}, {"FEMTO", 1e-15}, {"ATTO", 1e-18}};
  const auto found = kFactors.find(upper(std::string(prefix)));
  return found == kFactors.end() ? std::nullopt : std::optional(found->second);
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return result;
}

const Part* find_part(const std::vector<Part>& parts, std::string_view keyword) {
  const auto found =
      std::find_if(parts.begin(), parts.end(), [keyword](const Part& p) { return p.keyword == keyword; });
  return found == parts.end() ? nullptr : &*found;
}

/// A named unit as a multiple of its SI base (metre, gram), with a bound on chains of conversions.
struct Unit {
  std::string name;
  double factor = 1.0;
};
std::optional<Unit> read_unit(const Part21& file, int number, int depth = 0) {
  constexpr int kMaxChain = 8;
  if (depth > kMaxChain) return std::nullopt;
  const std::vector<Part> parts = file.parts(number);
  if (const Part* si = find_part(parts, "SI_UNIT")) {
    const std::size_t at =
        si->values.size() > 2 ? si->values.size() - 2 : 0;  // (dimensions, prefix, name) if not complex
    const std::string_view prefix = (*si)[at].is(Value::Kind::enumeration) ? (*si)[at].text : std::string_view();
    const auto factor = si_factor(prefix);
    if (!factor) return std::nullopt;
    return Unit{lower(prefix) + lower((*si)[at + 1].text), *factor};
  }
  const Part* conversion = find_part(parts, "CONVERSION_BASED_UNIT");
  if (conversion == nullptr || conversion->values.size() < 2) return std::nullopt;
  const Value& name = (*conversion)[conversion->values.size() - 2];
  const Value& measure = conversion->values.back();
  for (const Part& part : file.parts(measure.ref())) {
    if (part.values.size() < 2) continue;
    const double value = part[0].real_or(0.0);
    const auto base = read_unit(file, part[1].ref(), depth + 1);
    if (!base || !(value > 0.0) || !std::isfinite(value * base->factor)) return std::nullopt;
    return Unit{text_of(name), value * base->factor};
  }
  return std::nullopt;
}

bool has_part(const Part21& file, int number, std::string_view keyword) {
  const std::vector<Part> parts = file.parts(number);
  return find_part(parts, keyword) != nullptr;
}

/// Contexts in which shapes are given, those of boundary representations first.
std::vector<int> shape_contexts(const Part21& file) {
  static constexpr std::array kKinds = {
      "ADVANCED_BREP_SHAPE_REPRESENTATION",    "FACETED_BREP_SHAPE_REPRESENTATION",
      "MANIFOLD_SURFACE_SHAPE_REPRESENTATION", "GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION",
      "TESSELLATED_SHAPE_REPRESENTATION",      "SHAPE_REPRESENTATION"};
  std::vector<int> contexts;
  std::set<int> seen;
  for (const char* kind : kKinds) {
    for (const int number : file.with_keyword(kind)) {
      for (const Part& part : file.parts(number)) {
        const int context = part[2].ref();
        if (context != 0 && seen.insert(context).second) contexts.push_back(context);
      }
    }
  }
  if (contexts.empty()) contexts = file.with_keyword("GLOBAL_UNIT_ASSIGNED_CONTEXT");
  return contexts;
}

}  // namespace

std::string application_protocol(const std::string& schema) {
  static constexpr std::array<std::pair<const char*, const char*>, 10> kKnown = {{
      {"CONFIG_CONTROL_DESIGN", "AP203"},
      {"AP203", "AP203"},
      {"AUTOMOTIVE_DESIGN", "AP214"},
      {"CORE_DATA_FOR_AUTOMOTIVE", "AP214"},
      {"AP214", "AP214"},
      {"AP242", "AP242"},
      {"AP209", "AP209"},
      {"STRUCTURAL_ANALYSIS_DESIGN", "AP209"},
      {"AP238", "AP238"},
      {"INTEGRATED_CNC_SCHEMA", "AP238"},
  }};
  const std::string word = upper(schema);
  for (const auto& [begin, name] : kKnown) {
    if (word.starts_with(begin)) return name;
  }
  return clean_name(schema);
}

std::vector<LengthUnit> length_units(const Part21& file) {
  std::vector<LengthUnit> units;
  for (const int context : shape_contexts(file)) {
    const Part assigned = file.part(context, "GLOBAL_UNIT_ASSIGNED_CONTEXT");
    for (const int number : assigned.values.empty() ? std::vector<int>() : assigned.values.back().refs()) {
      if (!has_part(file, number, "LENGTH_UNIT")) continue;
      const auto unit = read_unit(file, number);
      if (!unit) continue;
      const LengthUnit length{unit->name, unit->factor * 1e3, number};
      const auto same = [&length](const LengthUnit& known) { return known.in_mm == length.in_mm; };
      if (std::none_of(units.begin(), units.end(), same)) units.push_back(length);
    }
  }
  return units;
}

namespace {

/// The density in g/cm^3 of a MEASURE_REPRESENTATION_ITEM(name, value, unit).
std::optional<double> read_density(const Part21& file, const Part& item) {
  const double value = item[1].real_or(std::nan(""));
  double mass = 1.0;    // g
  double length = 1.0;  // cm
  double mass_exponent = 0.0;
  double length_exponent = 0.0;
  for (const int element : file.part(item[2].ref(), "DERIVED_UNIT")[0].refs()) {
    const Part part = file.part(element, "DERIVED_UNIT_ELEMENT");
    const auto unit = read_unit(file, part[0].ref());
    if (!unit) return std::nullopt;
    const bool is_mass = has_part(file, part[0].ref(), "MASS_UNIT");
    (is_mass ? mass : length) = is_mass ? unit->factor : unit->factor * 1e2;
    (is_mass ? mass_exponent : length_exponent) = part[1].real_or(0.0);
  }
  // Exporters that leave the unit out mean g/cm^3, and so does OpenCASCADE's writer with its exponents 3 and 2. Others
  // forget the minus: mass times volume is no density either.
  const bool unstated = mass_exponent == 0.0 && length_exponent == 0.0;
  const bool known_slip = mass_exponent == 3.0 && length_exponent == 2.0;
  if (unstated) return value;
  if (!known_slip && !(mass_exponent == 1.0 && std::abs(length_exponent) == 3.0)) return std::nullopt;
  return value * mass / (length * length * length);
}

/// The PRODUCT_DEFINITION that a property is about, directly or by its shape; 0 for anything else.
int product_of(const Part21& file, int definition) {
  for (const Part& part : file.parts(definition)) {
    if (part.keyword.starts_with("PRODUCT_DEFINITION") && part.keyword != "PRODUCT_DEFINITION_SHAPE") return definition;
    if (part.keyword != "PRODUCT_DEFINITION_SHAPE") continue;
    const int inner = part[2].ref();
    for (const Part& product : file.parts(inner)) {
      if (product.keyword.starts_with("PRODUCT_DEFINITION") && product.keyword != "PRODUCT_DEFINITION_SHAPE")
        return inner;
    }
  }
  return 0;
}

void read_item(const Part21& file, int number, bool about_density, StepMaterial& material,
               std::vector<Finding>& findings) {
  const Part item = file.part(number);
  if (item.keyword == "DESCRIPTIVE_REPRESENTATION_ITEM" && !about_density) {
    const std::string name = text_of(item[0]);
    material.name = name.empty() || upper(name) == "MATERIAL NAME" ? text_of(item[1]) : name;
  }
  if (item.keyword != "MEASURE_REPRESENTATION_ITEM" || !about_density) return;
  // Lightest aerogel to osmium, with room on both sides. Written so that NaN fails.
  constexpr double kLightest = 1e-4;
  constexpr double kHeaviest = 50.0;
  const auto density = read_density(file, item);
  if (density && *density >= kLightest && *density <= kHeaviest) {
    material.density = density;
    return;
  }
  findings.push_back({Severity::warning,
                      {},
                      {},
                      label_of(number),
                      "a material's density can't be right and is not used",
                      "state the density in the material file"});
}

}  // namespace

std::map<int, StepMaterial> materials(const Part21& file, std::vector<Finding>& findings) {
  std::map<int, StepMaterial> result;
  for (const int number : file.with_keyword("PROPERTY_DEFINITION_REPRESENTATION")) {
    const Part link = file.part(number);
    const Part property = file.part(link[0].ref());
    if (property.keyword != "PROPERTY_DEFINITION") continue;
    if (lower(text_of(property[0])) != "material property") continue;
    const int product = product_of(file, property[2].ref());
    if (product == 0) continue;
    const Part representation = file.part(link[1].ref());
    const bool about_density = lower(text_of(representation[0])).find("density") != std::string::npos ||
                               lower(text_of(property[1])).find("density") != std::string::npos;
    for (const int item : representation[1].refs()) read_item(file, item, about_density, result[product], findings);
  }
  return result;
}

}  // namespace lamella::step
