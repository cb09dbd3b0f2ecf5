#include "slicing/orient/face_choice.h"

#include <algorithm>
#include <charconv>
#include <functional>
#include <set>

#include "core/error.h"
#include "materials/glob.h"
#include "slicing/orient/flat_face.h"

namespace lamella {

namespace {

using Test = std::function<bool(const Solid&, const Shell&, const Face&)>;

std::vector<FaceId> faces_that(const Scene& scene, const Test& matches) {
  std::vector<FaceId> faces;
  for (const Solid& solid : scene.solids) {
    for (const ShellId shell : solid.shells) {
      for (const FaceId face : scene.shells[shell].faces) {
        if (matches(solid, scene.shells[shell], scene.faces[face])) faces.push_back(face);
      }
    }
  }
  return faces;
}

int parse_entity(const std::string& name, const char* option) {
  int number = 0;
  const char* end = name.data() + name.size();
  const auto [stop, fault] = std::from_chars(name.data() + 1, end, number);
  if (fault != std::errc() || stop != end || number <= 0)
    throw InputError("'" + name + "' is no STEP entity", option, "e.g. '#123', as in the file");
  return number;
}

std::string known_names(const Scene& scene) {
  constexpr std::size_t kMost = 12;
  std::set<std::string> names;
  for (const Face& face : scene.faces) {
    if (!face.name.empty()) names.insert(face.name);
  }
  if (names.empty()) {
    for (const Solid& solid : scene.solids) names.insert(solid.info.path);
  }
  std::string text;
  std::size_t count = 0;
  for (const std::string& name : names) {
    if (++count > kMost) return text + ", ... (" + std::to_string(names.size()) + ")";
    text += (text.empty() ? "" : ", ") + name;
  }
  return text;
}

}  // namespace

std::vector<FaceId> find_named_faces(const Scene& scene, const std::string& name, const char* option) {
  std::vector<FaceId> faces;
  if (name.starts_with("#")) {
    const int entity = parse_entity(name, option);
    faces = faces_that(scene, [&](const Solid& solid, const Shell& shell, const Face& face) {
      return face.step_entity == entity || shell.step_entity == entity || solid.info.step_entity == entity;
    });
  } else {
    if (const auto fault = glob_fault(name)) throw InputError(*fault, option, "a name, with * and ?");
    faces =
        faces_that(scene, [&](const Solid&, const Shell&, const Face& face) { return matches_glob(name, face.name); });
    if (faces.empty()) {
      faces = faces_that(scene, [&](const Solid& solid, const Shell&, const Face&) {
        return matches_glob(name, solid.info.name) || matches_glob(name, solid.info.path);
      });
    }
  }
  if (faces.empty()) {
    throw InputError("no face and no solid is called '" + name + "'", option,
                     "'#123' names a STEP entity; names here: " + known_names(scene));
  }
  return faces;
}

std::vector<Vec3> plane_normals(const Scene& scene, const std::vector<FaceId>& faces, const std::string& name,
                                const char* option) {
  constexpr double kSame = 1.0 - 1e-12;
  std::vector<Vec3> normals;
  for (const FaceId id : faces) {
    const auto flat = flat_normal(scene.faces[id]);
    if (!flat) continue;
    const Vec3 normal = *flat;
    const bool is_new =
        std::none_of(normals.begin(), normals.end(), [&](const Vec3& n) { return n.dot(normal) > kSame; });
    if (is_new) normals.push_back(normal);
  }
  if (normals.empty())
    throw InputError("no face called '" + name + "' is plane, so none can lie on the plate", option,
                     "name a plane face");
  return normals;
}

}  // namespace lamella
