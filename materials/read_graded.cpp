#include "materials/read_graded.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "core/error.h"
#include "materials/expression_field.h"
#include "materials/position_field.h"
#include "materials/rule_fields.h"
#include "materials/stops.h"
#include "materials/vdb_field.h"

namespace lamella {

namespace {

/// More base materials than this no machine has.
constexpr std::size_t kMaxComponents = 64;

constexpr std::string_view kKinds = "axis, radial, distance, expression or grid";

/// The numbers of a list with blanks between.
std::vector<double> read_numbers(const XmlElement& element, const char* attribute) {
  const std::string text = element.attribute(attribute);
  std::vector<double> numbers;
  for (std::string_view rest = text;;) {
    rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r\n"), rest.size()));
    if (rest.empty()) return numbers;
    double number = 0.0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    const bool ends = rest.empty() || rest.find_first_of(" \t\r\n") == 0;
    if (error != std::errc{} || !ends || !std::isfinite(number)) {
      throw InputError(std::string(attribute) + "=\"" + text + "\" is no list of numbers", element.where(),
                       "write finite numbers with blanks between");
    }
    numbers.push_back(number);
  }
}

Vec3 read_vector(const XmlElement& element, const char* attribute, const Vec3& fallback) {
  if (!element.has(attribute)) return fallback;
  const std::vector<double> numbers = read_numbers(element, attribute);
  if (numbers.size() == 3) return {numbers[0], numbers[1], numbers[2]};
  throw InputError(std::string(attribute) + " needs three numbers", element.where(), "write \"x y z\", in mm");
}

Vec3 read_direction(const XmlElement& element) {
  const Vec3 direction = read_vector(element, "direction", Vec3::UnitZ());
  const double length = direction.norm();
  // What is a unit vector but for rounding is left as it is, so that it stays the same when it is written and read
  // again.
  if (std::abs(length - 1.0) <= 4.0 * std::numeric_limits<double>::epsilon()) return direction;
  if (length > 0.0 && std::isfinite(length)) return direction / length;
  throw InputError("a direction without length", element.where(), "write \"x y z\", not all zero");
}

/// What the readers of the kinds of fields share.
struct FieldContext {
  std::size_t components;
  const std::filesystem::path& folder;
  std::vector<std::filesystem::path>& files;

  /// The file that an attribute names.
  [[nodiscard]] std::filesystem::path file(const XmlElement& element, const char* attribute) const {
    files.push_back(folder / read_name(element, attribute));
    return files.back();
  }
};

Stops read_stops(const XmlElement& element, const FieldContext& context) {
  Stops stops(context.components);
  const std::vector<XmlElement> lines = element.children("stop");
  if (element.has("table") == !lines.empty()) {
    throw InputError("<" + std::string(element.name()) + "> needs either <stop>s or a table", element.where(),
                     "write <stop at=\"mm\" fractions=\"...\"/>, or table=\"file.csv\"");
  }
  if (element.has("table")) stops.read_csv(context.file(element, "table"));
  for (const XmlElement& line : lines) {
    line.allow_only({"at", "fractions"}, {});
    refuse_text(line);
    stops.add(line.number("at"), read_numbers(line, "fractions"), line.where());
  }
  return stops;
}

using Source = std::shared_ptr<const FieldSource>;

Source read_axis(const XmlElement& element, const FieldContext& context) {
  element.allow_only({"origin", "direction", "table"}, {"stop"});
  return make_axis_field(read_vector(element, "origin", Vec3::Zero()), read_direction(element),
                         read_stops(element, context));
}

Source read_radial(const XmlElement& element, const FieldContext& context) {
  element.allow_only({"origin", "direction", "table"}, {"stop"});
  std::optional<Vec3> direction;
  if (element.has("direction")) direction = read_direction(element);
  return make_radial_field(read_vector(element, "origin", Vec3::Zero()), direction, read_stops(element, context));
}

Source read_distance(const XmlElement& element, const FieldContext& context) {
  element.allow_only({"faces", "table"}, {"stop"});
  std::optional<std::string> faces;
  if (element.has("faces")) faces = read_glob(element, "faces");
  return make_distance_field(std::move(faces), read_stops(element, context), element.where());
}

/// The texts of the <fraction>s, or their attribute `grid`.
std::vector<XmlElement> read_fractions(const XmlElement& element) {
  std::vector<XmlElement> fractions = element.children("fraction");
  if (!fractions.empty()) return fractions;
  throw InputError("<" + std::string(element.name()) + "> needs <fraction>s", element.where(),
                   "give one for each component, or one less: the last component is what is left");
}

Source read_expression(const XmlElement& element, const FieldContext& context) {
  element.allow_only({"detail"}, {"fraction"});
  const double detail = element.number_or("detail", 0.0);
  if (!(detail >= 0.0)) {
    throw InputError("detail " + element.attribute("detail") + " is out of range", element.where(),
                     "give the size in mm of the finest detail of the formulas");
  }
  std::vector<Formula> formulas;
  for (const XmlElement& fraction : read_fractions(element)) {
    fraction.allow_only({}, {});
    formulas.push_back({fraction.text(), fraction.where()});
  }
  return make_expression_field(std::move(formulas), context.components, detail);
}

Source read_grid(const XmlElement& element, const FieldContext& context) {
  element.allow_only({"file"}, {"fraction"});
  std::vector<std::string> grids;
  for (const XmlElement& fraction : read_fractions(element)) {
    fraction.allow_only({"grid"}, {});
    refuse_text(fraction);
    grids.push_back(read_name(fraction, "grid"));
  }
  return make_vdb_field(context.file(element, "file"), grids, context.components, element.where());
}

struct FieldKind {
  const char* name;
  Source (*read)(const XmlElement&, const FieldContext&);
};
constexpr std::array<FieldKind, 5> kFieldKinds{{{"axis", read_axis},
                                                {"radial", read_radial},
                                                {"distance", read_distance},
                                                {"expression", read_expression},
                                                {"grid", read_grid}}};

MaterialId read_component(const XmlElement& element, const std::vector<Material>& library) {
  element.allow_only({"material"}, {});
  refuse_text(element);
  const std::string name = read_name(element, "material");
  const auto found =
      std::find_if(library.begin(), library.end(), [&](const Material& material) { return material.name == name; });
  if (found == library.end()) {
    throw InputError("material '" + name + "' isn't in the library above", element.where(),
                     "list it before what is mixed of it");
  }
  if (found->is_graded()) {
    throw InputError("'" + name + "' is graded itself", element.where(), "name the materials that it is mixed of");
  }
  return MaterialId{static_cast<std::size_t>(found - library.begin())};
}

std::vector<MaterialId> read_components(const XmlElement& element, const std::vector<Material>& library) {
  std::vector<MaterialId> components;
  for (const XmlElement& child : element.children("component")) {
    const MaterialId id = read_component(child, library);
    if (std::find(components.begin(), components.end(), id) != components.end()) {
      throw InputError("component '" + library[id.value()].name + "' is named twice", child.where(), "name it once");
    }
    components.push_back(id);
  }
  if (components.size() >= 2 && components.size() <= kMaxComponents) return components;
  throw InputError("a graded material of " + std::to_string(components.size()) + " components", element.where(),
                   "give 2 to 64 <component material=\"...\"/>");
}

/// <match>, then <component>, then the field, as the schema has it.
void check_order(const XmlElement& element) {
  int last = 0;
  for (const XmlElement& child : element.children()) {
    const int rank = child.name() == "match" ? 0 : child.name() == "component" ? 1 : 2;
    if (rank < last) {
      throw InputError("<" + std::string(child.name()) + "> in the wrong place", child.where(),
                       "write the <component>s, then the field");
    }
    last = rank;
  }
}

}  // namespace

Material read_graded(const XmlElement& element, const std::vector<Material>& library,
                     const std::filesystem::path& folder, std::vector<std::filesystem::path>& files) {
  element.allow_only({"name", "color", "priority", "deviation", "layer_min", "layer_max"},
                     {"match", "component", "axis", "radial", "distance", "expression", "grid"});
  refuse_text(element);
  check_order(element);
  Material material;
  material.components = read_components(element, library);
  for (const XmlElement& child : element.children()) {
    const auto kind = std::find_if(kFieldKinds.begin(), kFieldKinds.end(),
                                   [&](const FieldKind& k) { return child.name() == k.name; });
    if (kind == kFieldKinds.end()) continue;
    if (material.field) throw InputError("a graded material with two fields", child.where(), "leave one of them out");
    refuse_text(child);
    material.field = kind->read(child, {material.components.size(), folder, files});
  }
  if (!material.field) {
    throw InputError("a graded material without a field", element.where(), "add " + std::string(kKinds));
  }
  return material;
}

}  // namespace lamella
