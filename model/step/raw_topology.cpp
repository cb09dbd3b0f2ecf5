#include "model/step/raw_topology.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "model/step/entity_label.h"

namespace lamella::step {
namespace {

constexpr std::array kSolidKinds = {"MANIFOLD_SOLID_BREP", "BREP_WITH_VOIDS", "FACETED_BREP"};
constexpr std::array kShellKinds = {"CLOSED_SHELL", "OPEN_SHELL"};
constexpr std::size_t kMaxFaults = 1000;

/// The attributes of an entity that follow its name, wherever a complex entity keeps them.
struct Attributes {
  std::string keyword;
  std::vector<Value> values;
};

/// The part of an entity that has one of the keywords; a simple entity's first attribute (its name) is left out, so
/// that simple and complex entities read alike.
template <std::size_t N>
Attributes attributes(const Part21& file, int number, const std::array<const char*, N>& keywords) {
  std::vector<Part> parts = file.parts(number);
  Attributes result;
  for (Part& part : parts) {
    if (std::find(keywords.begin(), keywords.end(), part.keyword) == keywords.end()) continue;
    if (!result.keyword.empty() && part.values.empty()) continue;
    result = {part.keyword, std::move(part.values)};
    if (parts.size() == 1 && !result.values.empty()) result.values.erase(result.values.begin());
  }
  return result;
}

const Value& at(const Attributes& attributes, std::size_t i) {
  static const Value kMissing;
  return i < attributes.values.size() ? attributes.values[i] : kMissing;
}

}  // namespace

RawTopology::RawTopology(const Part21& file, const Progress& progress) : file_(file) {
  std::set<int> seen;
  for (const char* kind : kSolidKinds) {
    for (const int number : file.with_keyword(kind)) {
      progress.throw_if_cancelled();
      if (seen.insert(number).second) read_solid(number);
    }
  }
  for (const char* kind : kShellKinds) {
    for (const int number : file.with_keyword(kind)) {
      progress.throw_if_cancelled();
      if (solid_of(number) != 0) continue;
      RawSolid lone;
      lone.number = number;
      lone.alone = true;
      read_shell(lone, number);
      solids_.push_back(std::move(lone));
    }
  }
}

int RawTopology::look_up(const std::unordered_map<int, int>& map, int key) {
  const auto found = map.find(key);
  return found == map.end() ? 0 : found->second;
}

void RawTopology::claim(int entity, int face) {
  if (entity != 0) face_of_.emplace(entity, face);
}

void RawTopology::add_fault(int solid, int face, int entity, bool breaks, std::string what) {
  if (faults_.size() < kMaxFaults) faults_.push_back({solid, face, entity, breaks, std::move(what)});
}

void RawTopology::read_solid(int number) {
  RawSolid solid;
  solid.number = number;
  std::vector<int> shells;
  for (const Part& part : file_.parts(number)) {
    // (name, outer shell [, void shells]); in a complex entity the shells stand without the name.
    for (const Value& value : part.values) {
      if (value.ref() != 0) shells.push_back(value.ref());
      for (const int shell : value.refs()) shells.push_back(shell);
    }
  }
  if (shells.empty()) add_fault(number, 0, number, true, "the solid has no shell");
  for (const int shell : shells) read_shell(solid, shell);
  solids_.push_back(std::move(solid));
}

void RawTopology::read_shell(RawSolid& solid, int number, int depth) {
  static constexpr std::array kKinds = {"CLOSED_SHELL", "OPEN_SHELL", "CONNECTED_FACE_SET", "ORIENTED_CLOSED_SHELL",
                                        "ORIENTED_OPEN_SHELL"};
  const Attributes shell = attributes(file_, number, kKinds);
  if (shell.keyword.starts_with("ORIENTED_") && depth == 0) {
    return read_shell(solid, at(shell, 1).ref(), depth + 1);
  }
  if (file_.find(number) == nullptr) {
    return add_fault(solid.number, 0, solid.number, true, "its shell " + label_of(number) + " isn't in the file");
  }
  RawShell result;
  result.number = number;
  result.declared_open = shell.keyword == "OPEN_SHELL";
  if (shell.values.empty() || shell.values.back().items.empty()) {
    add_fault(solid.number, 0, number, true, "the shell has no faces");
    return;
  }
  solid_of_.emplace(number, solid.number);
  Uses uses;
  result.faces = shell.values.back().refs();
  for (const int face : result.faces) read_face(solid.number, face, false, uses);
  check_uses(solid.number, result, uses);
  if (result.declared_open && !solid.alone) {
    add_fault(solid.number, 0, number, false, "the solid is bounded by an OPEN_SHELL where a CLOSED_SHELL must stand");
  }
  solid.shells.push_back(std::move(result));
}

void RawTopology::read_face(int solid, int number, bool turned, Uses& uses, int depth) {
  static constexpr std::array kKinds = {"ADVANCED_FACE", "FACE_SURFACE", "FACE", "ORIENTED_FACE"};
  const Attributes face = attributes(file_, number, kKinds);
  if (face.keyword == "ORIENTED_FACE" && depth == 0) {
    // (name, *, face, orientation)
    return read_face(solid, at(face, 1).ref(), turned != !at(face, 2).is_true(), uses, depth + 1);
  }
  if (face.values.empty()) {
    return add_fault(solid, number, number, true,
                     file_.find(number) == nullptr ? "the face isn't in the file" : "the face can't be read");
  }
  solid_of_.emplace(number, solid);
  claim(number, number);
  if (face.values.size() > 1) claim(face.values[1].ref(), number);
  for (const int bound : face.values.front().refs()) {
    static constexpr std::array kBounds = {"FACE_BOUND", "FACE_OUTER_BOUND"};
    const Attributes attributes_of_bound = attributes(file_, bound, kBounds);
    claim(bound, number);
    if (attributes_of_bound.values.empty())
      add_fault(solid, number, bound, true, "a bound of the face isn't in the file");
    read_loop(at(attributes_of_bound, 0).ref(), number, turned != !at(attributes_of_bound, 1).is_true(), uses);
  }
}

void RawTopology::read_loop(int loop, int face, bool turned, Uses& uses) {
  claim(loop, face);
  const Part edges = file_.part(loop, "EDGE_LOOP");
  if (edges.values.empty()) return;  // a vertex loop, a polygon, or nothing: the import says
  for (const int oriented : edges.values.back().refs()) {
    // (name, *, *, edge, orientation)
    const Part use = file_.part(oriented, "ORIENTED_EDGE");
    claim(oriented, face);
    const int edge = use[3].ref();
    if (edge == 0 || file_.find(edge) == nullptr) {
      add_fault(solid_of(face), face, oriented, true, "an edge of the face isn't in the file");
      continue;
    }
    claim(edge, face);
    claim(file_.part(edge, "EDGE_CURVE")[3].ref(), face);
    uses.push_back({edge, use[4].is_true() != turned, face});
  }
}

void RawTopology::check_uses(int solid, const RawShell& shell, const Uses& uses) {
  std::map<int, Uses> by_edge;
  for (const EdgeUse& use : uses) by_edge[use.edge].push_back(use);
  int free_edges = 0;
  int one_sense = 0;
  EdgeUse first_free;
  EdgeUse first_same;
  for (const auto& [edge, of_edge] : by_edge) {
    const auto forward = std::count_if(of_edge.begin(), of_edge.end(), [](const EdgeUse& u) { return u.forward; });
    if (2 * static_cast<std::size_t>(forward) == of_edge.size()) continue;
    const bool free = of_edge.size() % 2 == 1;
    if ((free ? free_edges : one_sense)++ == 0) (free ? first_free : first_same) = of_edge.front();
  }
  const auto count = [](int n, const char* what) { return std::to_string(n) + (n == 1 ? " edge " : " edges ") + what; };
  if (free_edges > 0 && !shell.declared_open) {
    add_fault(solid, first_free.face, first_free.edge, true,
              count(free_edges, "used by one face only: the shell ") + label_of(shell.number) + " is not closed");
  }
  if (one_sense > 0) {
    add_fault(solid, first_same.face, first_same.edge, true,
              count(one_sense, "run through twice in one sense: a face of shell ") + label_of(shell.number) +
                  " is turned round");
  }
  if (shell.declared_open && free_edges > 0) {
    add_fault(solid, first_free.face, first_free.edge, true,
              count(free_edges, "at the rim of the open shell ") + label_of(shell.number));
  }
}

}  // namespace lamella::step
