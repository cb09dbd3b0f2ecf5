#include "materials/read_library.h"

#include <algorithm>

#include "core/error.h"
#include "materials/color.h"
#include "materials/glob.h"
#include "materials/read_graded.h"
#include "materials/rule_fields.h"

namespace lamella {

namespace {

/// Nobody nests libraries deeper, or has more of them; files that do are made to exhaust a reader.
constexpr std::size_t kMaxDepth = 16;
constexpr std::size_t kMaxIncludes = 256;

/// The same file has one text, whichever way leads there.
std::filesystem::path resolved(const std::filesystem::path& path) {
  std::error_code failure;
  auto out = std::filesystem::weakly_canonical(path, failure);
  return failure ? path : out;
}

}  // namespace

LibraryReader::LibraryReader(MaterialRules& rules, const std::filesystem::path& file)
    : rules_(rules), open_{resolved(file)} {}

void LibraryReader::read(const XmlElement& library) {
  library.allow_only({}, {"include", "material", "graded"});
  refuse_text(library);
  for (const XmlElement& element : library.children()) {
    if (element.name() == "include") {
      read_include(element);
    } else if (element.name() == "graded") {
      read_graded_material(element);
    } else {
      read_material(element);
    }
  }
}

void LibraryReader::read_include(const XmlElement& element) {
  element.allow_only({"href"}, {});
  refuse_text(element);
  const std::filesystem::path file = resolved(open_.back().parent_path() / read_name(element, "href"));
  if (std::find(open_.begin(), open_.end(), file) != open_.end()) {
    throw InputError("the library includes itself", element.where(), "remove the <include> that closes the circle");
  }
  // Two libraries may build on a third.
  if (!included_.insert(file).second) return;
  if (open_.size() > kMaxDepth || included_.size() > kMaxIncludes) {
    throw InputError("too many included libraries", element.where(), "at most 256 in all, 16 within one another");
  }
  rules_.files.push_back(file);
  const XmlDocument document = XmlDocument::read(file);
  const XmlElement root = document.root("materials");
  check_materials_head(root);
  root.allow_only({"version"}, {"library"});
  const auto library = root.child("library");
  if (!library) throw InputError("no <library>", root.where(), "only files with materials can be included");
  open_.push_back(file);
  read(*library);
  open_.pop_back();
}

void LibraryReader::read_material(const XmlElement& element) {
  element.allow_only({"name", "density", "color", "priority", "deviation", "layer_min", "layer_max"}, {"match"});
  refuse_text(element);
  Material material;
  if (element.has("density")) material.density = read_density(element);
  add_material(element, std::move(material));
}

void LibraryReader::read_graded_material(const XmlElement& element) {
  add_material(element, read_graded(element, rules_.library, open_.back().parent_path(), rules_.files));
}

/// Adds what the element says of every kind of material.
void LibraryReader::add_material(const XmlElement& element, Material material) {
  material.name = read_name(element, "name");
  const auto [first, added] = places_.emplace(material.name, element.where());
  if (!added) {
    throw InputError("material '" + material.name + "' is defined twice", element.where(),
                     "the first is at " + first->second);
  }
  const std::size_t index = rules_.library.size();
  material.color = element.has("color") ? read_color(element) : distinct_color(index);
  rules_.priorities.push_back(read_priority(element, 0));
  rules_.library.push_back(std::move(material));
  read_layers(element, rules_.library.back().layers);
  match_own_name(element, index);
  for (const XmlElement& match : element.children("match")) read_match(match, index);
}

void LibraryReader::read_layers(const XmlElement& element, ThicknessLimits& layers) {
  layers.deviation = read_thickness(element, "deviation");
  layers.least = read_thickness(element, "layer_min");
  layers.most = read_thickness(element, "layer_max");
  check_thicknesses(element, layers.least, layers.most);
}

/// A material stands for what is called like it, and for what has the colour that is stated for it.
void LibraryReader::match_own_name(const XmlElement& element, std::size_t material) {
  const std::string exact = escape_glob(rules_.library[material].name);
  for (const MaterialSource source : {MaterialSource::step_material, MaterialSource::layer, MaterialSource::name}) {
    rules_.matches.push_back({material, source, exact, {}, element.where()});
  }
  if (!element.has("color")) return;
  rules_.matches.push_back({material, MaterialSource::color, {}, rules_.library[material].color, element.where()});
}

void LibraryReader::read_match(const XmlElement& element, std::size_t material) {
  element.allow_only({"step_material", "layer", "color", "name", "path"}, {});
  refuse_text(element);
  std::size_t selectors = 0;
  for (const auto& [source, word] : kMaterialSources) {
    if (!element.has(word)) continue;
    ++selectors;
    LibraryMatch match{material, source, {}, {}, element.where()};
    if (source == MaterialSource::color) {
      match.color = read_color(element);
    } else {
      match.pattern = read_glob(element, word);
    }
    rules_.matches.push_back(std::move(match));
  }
  if (selectors == 1) return;
  throw InputError("<match> needs one of step_material, layer, color, name and path", element.where(),
                   "write one <match> for each");
}

}  // namespace lamella
