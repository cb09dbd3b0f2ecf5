#include "model/step/raw_structure.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <unordered_map>

#include "core/error.h"
#include "model/step/entity_label.h"

namespace lamella::step {
namespace {

std::string line_of(const std::string& path, int line) { return path + ", line " + std::to_string(line); }

/// Whether the import follows references of such entities by recursion.
bool is_followed(const std::string& keyword) {
  static constexpr std::array kWords = {
      "CURVE", "SURFACE", "LINE",  "CIRCLE", "ELLIPSE", "PLANE",  "FACE",      "EDGE",           "LOOP",
      "SHELL", "BREP",    "SOLID", "VERTEX", "MAPPED",  "_MAP",   "PLACEMENT", "TRANSFORMATION", "SHAPE_REPRESENTATION",
      "UNIT",  "POINT",   "SET",   "BOUND",  "PRODUCT", "BOOLEAN"};
  return std::any_of(kWords.begin(), kWords.end(),
                     [&keyword](const char* word) { return keyword.find(word) != std::string::npos; });
}

/// Depth-first search for cycles, without recursion.
class CycleSearch {
 public:
  using Successors = std::vector<int>;

  /// `successors(n)` lists what n leads to. Returns a cycle through nodes reachable from `start`, in order, or
  /// nothing. Nodes already searched are not searched again.
  template <class Function>
  Successors find(int start, const Function& successors) {
    if (state_[start] != State::fresh) return {};
    push(start, successors(start));
    while (!stack_.empty()) {
      Frame& frame = stack_.back();
      if (frame.next == frame.successors.size()) {
        state_[frame.node] = State::done;
        stack_.pop_back();
        continue;
      }
      const int node = frame.successors[frame.next++];
      const State state = state_[node];
      if (state == State::open) return cycle_from(node);
      if (state == State::fresh) push(node, successors(node));
    }
    return {};
  }

 private:
  enum class State : char { fresh, open, done };
  struct Frame {
    int node;
    Successors successors;
    std::size_t next = 0;
  };

  void push(int node, Successors successors) {
    state_[node] = State::open;
    stack_.push_back({node, std::move(successors)});
  }

  /// The nodes on the stack from `node` on. The search goes on behind it, so the stack stays.
  [[nodiscard]] Successors cycle_from(int node) {
    Successors cycle;
    for (const Frame& frame : stack_) {
      if (!cycle.empty() || frame.node == node) cycle.push_back(frame.node);
    }
    for (const Frame& frame : stack_) state_[frame.node] = State::done;
    stack_.clear();
    return cycle;
  }

  std::unordered_map<int, State> state_;
  std::vector<Frame> stack_;
};

std::string describe(const Part21& file, const std::vector<int>& cycle) {
  constexpr std::size_t kShown = 6;
  std::string text;
  for (std::size_t i = 0; i < std::min(cycle.size(), kShown); ++i) {
    text += label_of(cycle[i]) + " " + file.keyword_of(cycle[i]) + " -> ";
  }
  if (cycle.size() > kShown) text += "... -> ";
  return text + label_of(cycle.front());
}

[[noreturn]] void throw_cycle(const Part21& file, const std::string& path, const std::vector<int>& cycle,
                              const std::string& what) {
  const Entity* entity = file.find(cycle.front());
  throw InputError(what + ": " + describe(file, cycle), line_of(path, entity == nullptr ? 0 : entity->line),
                   "the file is damaged; export it again");
}

/// What leads from one product definition, or shape representation, to the next in the assembly.
std::unordered_map<int, std::vector<int>> structure_links(const Part21& file) {
  std::unordered_map<int, std::vector<int>> links;
  for (const int number : file.with_keyword("NEXT_ASSEMBLY_USAGE_OCCURRENCE")) {
    const Part usage = file.part(number);
    links[usage[3].ref()].push_back(usage[4].ref());
  }
  return links;
}

}  // namespace

void require_acyclic(const Part21& file, const std::string& path, const Progress& progress) {
  CycleSearch references;
  const auto of_entity = [&file](int number) {
    const Entity* entity = file.find(number);
    return entity == nullptr ? std::vector<int>() : file.references(*entity);
  };
  std::size_t count = 0;
  for (const Entity& entity : file.entities()) {
    if (++count % 4096 == 0) progress.throw_if_cancelled();
    const std::vector<int> cycle = references.find(entity.number, of_entity);
    const bool fatal =
        std::any_of(cycle.begin(), cycle.end(), [&file](int n) { return is_followed(file.keyword_of(n)); });
    if (fatal) throw_cycle(file, path, cycle, "entities refer to each other in a circle");
  }
  const auto links = structure_links(file);
  CycleSearch products;
  const auto of_product = [&links](int number) {
    const auto found = links.find(number);
    return found == links.end() ? std::vector<int>() : found->second;
  };
  for (const auto& [product, parts] : links) {
    const std::vector<int> cycle = products.find(product, of_product);
    if (!cycle.empty()) throw_cycle(file, path, cycle, "an assembly contains itself");
  }
}

namespace {

/// Whether the import takes it for granted that all such an entity refers to is there: geometry, the places of parts in
/// an assembly, colours.
bool is_piece_of_geometry(const std::string& keyword) {
  static constexpr std::array kWhole = {"VECTOR",
                                        "LINE",
                                        "CIRCLE",
                                        "ELLIPSE",
                                        "PARABOLA",
                                        "HYPERBOLA",
                                        "PLANE",
                                        "DIRECTION",
                                        "VERTEX_POINT",
                                        "VERTEX_LOOP",
                                        "CARTESIAN_POINT",
                                        "EDGE_CURVE",
                                        "FACE_BOUND",
                                        "FACE_OUTER_BOUND",
                                        "ORIENTED_EDGE",
                                        "ORIENTED_FACE",
                                        "BREP_WITH_VOIDS",
                                        "MANIFOLD_SOLID_BREP",
                                        "FACETED_BREP",
                                        "ORIENTED_CLOSED_SHELL",
                                        "ADVANCED_FACE",
                                        "FACE_SURFACE",
                                        "EDGE_LOOP",
                                        "SURFACE_CURVE",
                                        "SEAM_CURVE",
                                        "INTERSECTION_CURVE",
                                        "TRIMMED_CURVE",
                                        "COMPOSITE_CURVE",
                                        "PCURVE",
                                        "DEFINITIONAL_REPRESENTATION",
                                        "SHAPE_DEFINITION_REPRESENTATION"};
  static constexpr std::array kFamilies = {"AXIS1_PLACEMENT",
                                           "AXIS2_PLACEMENT",
                                           "_SURFACE",
                                           "B_SPLINE",
                                           "SURFACE_OF_",
                                           "OFFSET_",
                                           "REPRESENTATION_RELATIONSHIP",
                                           "ITEM_DEFINED_TRANSFORMATION",
                                           "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION",
                                           "SURFACE_SIDE_STYLE",
                                           "SURFACE_STYLE_",
                                           "PRESENTATION_STYLE",
                                           "FILL_AREA_STYLE",
                                           "CURVE_STYLE",
                                           "STYLED_ITEM"};
  return std::find(kWhole.begin(), kWhole.end(), keyword) != kWhole.end() ||
         std::any_of(kFamilies.begin(), kFamilies.end(),
                     [&keyword](const char* word) { return keyword.find(word) != std::string::npos; });
}

}  // namespace

namespace {

/// The entities that are pieces of geometry, in the file's order.
std::vector<const Entity*> pieces_of_geometry(const Part21& file) {
  std::vector<bool> is_piece(file.entities().size());
  for (const auto& [keyword, positions] : file.by_keyword()) {
    if (!is_piece_of_geometry(keyword)) continue;
    for (const std::uint32_t position : positions) is_piece[position] = true;
  }
  std::vector<const Entity*> pieces;
  for (std::size_t i = 0; i < is_piece.size(); ++i) {
    if (is_piece[i]) pieces.push_back(&file.entities()[i]);
  }
  return pieces;
}

/// A point or direction in the plane that the entity refers to; 0 if there is none.
int flat_reference(const Part21& file, const Entity& entity) {
  for (const int number : file.references(entity)) {
    const Part part = file.part(number);
    const bool spatial = part[1].items.size() == 3;
    if ((part.keyword == "CARTESIAN_POINT" || part.keyword == "DIRECTION") && !spatial) return number;
  }
  return 0;
}

/// A look that costs little before the entity is parsed.
bool may_hold_an_empty_list(std::string_view text) {
  for (std::size_t at = text.find('('); at != std::string_view::npos; at = text.find('(', at + 1)) {
    const std::size_t next = text.find_first_not_of(" \t\r\n", at + 1);
    if (next != std::string_view::npos && text[next] == ')') return true;
  }
  return false;
}

/// Points and directions of which no coordinate is stated.
void add_empty_points(const Part21& file, std::map<int, std::string>& broken) {
  for (const char* keyword : {"CARTESIAN_POINT", "DIRECTION"}) {
    for (const int number : file.with_keyword(keyword)) {
      const Entity& entity = *file.find(number);
      if (!may_hold_an_empty_list(file.text().substr(entity.begin, entity.size))) continue;
      if (file.part(number, keyword)[1].items.empty()) broken.emplace(number, "it has no coordinates");
    }
  }
}

/// The lists of lists among an entity's attributes: control points and weights of a surface.
std::vector<const Value*> nets_of(const std::vector<Part>& parts) {
  std::vector<const Value*> nets;
  for (const Part& part : parts) {
    for (const Value& value : part.values) {
      if (value.is(Value::Kind::list) && !value.items.empty() && value.items.front().is(Value::Kind::list)) {
        nets.push_back(&value);
      }
    }
  }
  return nets;
}

/// Whether all nets of a surface have as many rows, and all their rows as many items.
bool are_grids_alike(const std::vector<const Value*>& nets) {
  for (const Value* net : nets) {
    if (net->items.size() != nets.front()->items.size()) return false;
    for (const Value& row : net->items) {
      if (row.items.size() != nets.front()->items.front().items.size()) return false;
    }
  }
  return true;
}

/// Whether each list of multiplicities is as long as its knots: the lists before the last attribute, all of the former
/// before all of the latter.
bool have_knots_multiplicities(const Part& part) {
  std::vector<std::size_t> sizes;
  for (std::size_t i = part.values.size(); i-- > 0;) {
    const bool is_last = i + 1 == part.values.size();
    if (is_last) continue;
    if (!part[i].is(Value::Kind::list)) break;
    sizes.push_back(part[i].items.size());
  }
  const std::size_t half = sizes.size() / 2;
  return std::equal(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(half),
                    sizes.begin() + static_cast<std::ptrdiff_t>(half), sizes.end());
}

/// Size of the list that is the attribute `i` of a part, if the entity has that part.
std::optional<std::size_t> list_size(const std::vector<Part>& parts, const char* keyword, std::size_t i) {
  for (const Part& part : parts) {
    if (part.keyword == keyword) return part[i].items.size();
  }
  return std::nullopt;
}

/// What is wrong with the lists of a B-spline, empty if nothing: the import takes them for as long as each other.
std::string spline_fault(const std::vector<Part>& parts) {
  const std::vector<const Value*> nets = nets_of(parts);
  if (!are_grids_alike(nets)) return "its control points or weights are no grid";
  const auto poles = list_size(parts, "B_SPLINE_CURVE", 1);
  const auto weights = list_size(parts, "RATIONAL_B_SPLINE_CURVE", 0);
  if (poles && weights && *poles != *weights) return "it has not a weight for each control point";
  for (const Part& part : parts) {
    const bool has_empty_list = std::any_of(part.values.begin(), part.values.end(), [](const Value& value) {
      return value.is(Value::Kind::list) && value.items.empty();
    });
    if (has_empty_list) return "one of its lists is empty";
    const bool has_knots = part.keyword.find("WITH_KNOTS") != std::string::npos;
    if (has_knots && !have_knots_multiplicities(part)) return "it has not a multiplicity for each knot";
  }
  return {};
}

}  // namespace

std::vector<RefusedEntity> broken_geometry(const Part21& file, const std::vector<RefusedEntity>& refused) {
  std::map<int, std::string> broken;
  const std::vector<const Entity*> pieces = pieces_of_geometry(file);
  for (const RefusedEntity& entity : refused) {
    if (!is_about_a_name(entity.reason) && is_piece_of_geometry(file.keyword_of(entity.number)))
      broken.emplace(entity.number, entity.reason);
  }
  for (const char* spatial : {"VERTEX_POINT", "AXIS2_PLACEMENT_3D"}) {
    for (const int number : file.with_keyword(spatial)) {
      const int flat = flat_reference(file, *file.find(number));
      if (flat != 0) broken.emplace(number, "it needs three coordinates and " + label_of(flat) + " has others");
    }
  }
  add_empty_points(file, broken);
  for (const auto& [keyword, positions] : file.by_keyword()) {
    if (keyword.find("B_SPLINE") == std::string::npos) continue;
    for (const std::uint32_t position : positions) {
      const Entity& spline = file.entities()[position];
      if (std::string fault = spline_fault(file.parts(spline)); !fault.empty()) broken.emplace(spline.number, fault);
    }
  }
  for (bool grown = true; grown;) {
    grown = false;
    for (const Entity* piece : pieces) {
      if (broken.contains(piece->number)) continue;
      for (const int needed : file.references(*piece)) {
        if (file.find(needed) != nullptr && !broken.contains(needed)) continue;
        broken.emplace(piece->number, "it needs " + label_of(needed) + ", which the file lacks");
        grown = true;
        break;
      }
    }
  }
  std::vector<RefusedEntity> result;
  for (const auto& [number, reason] : broken) result.push_back({number, reason});
  return result;
}

void require_step_text(const Part21& file, const std::string& path) {
  if (!file.recognised()) {
    throw InputError("not a STEP file: it doesn't begin with ISO-10303-21", path, "give a .step or .stp file");
  }
  if (!file.faults().empty() && (file.entities().empty() || !file.complete())) {
    const SyntaxFault& fault = file.faults().front();
    const std::string entity = fault.entity > 0 ? " in " + label_of(fault.entity) : "";
    throw InputError("syntax error" + entity + ": " + fault.what, line_of(path, fault.line),
                     "the file is damaged; export it again");
  }
  if (!file.complete()) {
    throw InputError("the file ends in the middle: ENDSEC or END-ISO-10303-21 is missing", line_of(path, file.lines()),
                     "the file is cut short; copy or export it again");
  }
  // The import takes such values for anything, or never ends.
  if (const SyntaxFault& fault = file.unreadable(); fault.entity != 0) {
    throw InputError(label_of(fault.entity) + " " + file.keyword_of(fault.entity) + ": " + fault.what,
                     line_of(path, fault.line), "the file is damaged; export it again");
  }
  if (file.entities().empty()) throw InputError("the STEP file holds no entity", path, "export it again");
}

namespace {

/// The first entity that has one of the keywords, 0 if there is none.
template <std::size_t N>
int first_of(const Part21& file, const std::array<const char*, N>& keywords) {
  for (const char* keyword : keywords) {
    if (const auto found = file.with_keyword(keyword); !found.empty()) return found.front();
  }
  return 0;
}

struct Diagnosis {
  int entity = 0;
  std::string what;
  std::string hint;
  bool by_attributes = false;  ///< entities that couldn't be read may be the cause
};

Diagnosis diagnose(const Part21& file) {
  static constexpr std::array kBreps = {"MANIFOLD_SOLID_BREP", "BREP_WITH_VOIDS", "FACETED_BREP",
                                        "SHELL_BASED_SURFACE_MODEL"};
  static constexpr std::array kTessellated = {"TESSELLATED_SOLID",        "TESSELLATED_SHELL",
                                              "TRIANGULATED_FACE",        "COMPLEX_TRIANGULATED_FACE",
                                              "TRIANGULATED_SURFACE_SET", "COMPLEX_TRIANGULATED_SURFACE_SET"};
  static constexpr std::array kHistory = {"CONSTRUCTION_HISTORY_SHAPE_REPRESENTATION",
                                          "OPERATION_SEQUENCE",
                                          "PARAMETRIC_EXTRUDED_FACE_SOLID",
                                          "EXTRUDED_AREA_SOLID",
                                          "REVOLVED_AREA_SOLID",
                                          "BOOLEAN_RESULT",
                                          "CSG_SOLID"};
  static constexpr std::array kExternal = {"DOCUMENT_FILE", "APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT",
                                           "EXTERNALLY_DEFINED_REPRESENTATION_ITEM"};
  const char* const kExact = "export exact boundary representation (AP203, AP214 or AP242 B-rep)";
  if (const int brep = first_of(file, kBreps)) {
    const bool product = file.has("SHAPE_DEFINITION_REPRESENTATION");
    const bool units = file.has("GLOBAL_UNIT_ASSIGNED_CONTEXT");
    const std::string missing = !product && !units ? "product structure and units"
                                : !product         ? "product structure"
                                : !units           ? "units"
                                                   : "a face that can be read";
    return {brep, "a boundary representation without " + missing, "export the part again, with its product and units",
            true};
  }
  if (const int tessellated = first_of(file, kTessellated)) {
    return {tessellated, "the file holds tessellated geometry only, no exact faces", kExact};
  }
  if (const int history = first_of(file, kHistory)) {
    return {history, "the file holds a construction history only, no resulting faces", kExact};
  }
  if (const int external = first_of(file, kExternal)) {
    return {external, "the geometry is in other files, which are never opened: " + file.keyword_of(external),
            "give the files of the parts themselves"};
  }
  const int first = file.entities().front().number;
  return {first,
          "the file holds no shape: " + std::to_string(file.entities().size()) + " entities, the first is " +
              file.keyword_of(first),
          kExact, true};
}

/// The names of external files for the message, at most four.
std::string external_names(const Part21& file) {
  std::string names;
  const auto documents = file.with_keyword("DOCUMENT_FILE");
  for (std::size_t i = 0; i < std::min<std::size_t>(documents.size(), 4); ++i) {
    names += (i > 0 ? ", " : " ") + decode_string(file.part(documents[i], "DOCUMENT_FILE")[0].text);
  }
  return names;
}

}  // namespace

void throw_nothing_readable(const Part21& file, const std::string& path, const std::vector<RefusedEntity>& refused) {
  Diagnosis diagnosis = diagnose(file);
  if (diagnosis.what.starts_with("the geometry is in other files")) diagnosis.what += external_names(file);
  const auto reason = std::find_if(refused.begin(), refused.end(),
                                   [&diagnosis](const RefusedEntity& r) { return r.number == diagnosis.entity; });
  const RefusedEntity* named = reason != refused.end() ? &*reason : refused.empty() ? nullptr : &refused.front();
  if (diagnosis.by_attributes && named != nullptr) {
    diagnosis.what += "; " + label_of(named->number) + " " + file.keyword_of(named->number) + ": " + named->reason;
  }
  const Entity* entity = file.find(diagnosis.entity);
  throw InputError("no solid can be read: " + diagnosis.what,
                   line_of(path, entity == nullptr ? 0 : entity->line) + ", " + label_of(diagnosis.entity),
                   diagnosis.hint);
}

}  // namespace lamella::step
