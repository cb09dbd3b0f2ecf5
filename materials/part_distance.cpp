#include "materials/part_distance.h"

#include <set>
#include <vector>

#include "core/error.h"
#include "materials/glob.h"

namespace lamella {

namespace {

constexpr std::size_t kListedNames = 20;

std::string list_names(const std::set<std::string>& names) {
  std::string list;
  std::size_t count = 0;
  for (const std::string& name : names) {
    if (++count > kListedNames) return list + " and " + std::to_string(names.size() - kListedNames) + " more";
    list += (list.empty() ? "'" : ", '") + name + "'";
  }
  return list;
}

std::vector<FaceId> choose_faces(const Scene& scene, SolidId solid, const std::optional<std::string>& glob,
                                 const std::string& where) {
  std::vector<FaceId> faces = faces_of(scene, solid);
  if (!glob) return faces;
  std::set<std::string> names;
  for (const FaceId face : faces) {
    if (!scene.faces[face].name.empty()) names.insert(scene.faces[face].name);
  }
  std::erase_if(faces, [&](FaceId face) {
    const std::string& name = scene.faces[face].name;
    return name.empty() || !matches_glob(*glob, name);
  });
  if (!faces.empty()) return faces;
  throw InputError("no face of '" + scene.solids[solid].info.path + "' is called '" + *glob + "'", where,
                   names.empty() ? "its faces have no names; name them in the CAD system"
                                 : "its faces are called " + list_names(names));
}

}  // namespace

PartFrame part_frame(const SolidInfo& solid) {
  if (!solid.instance) return {};
  return {solid.instance->turn, solid.instance->shift};
}

PartDistance::PartDistance(const Scene& scene, SolidId solid, const std::optional<std::string>& faces,
                           const std::string& where)
    : frame_(part_frame(scene.solids[solid].info)), faces_(scene, choose_faces(scene, solid, faces, where)) {}

std::optional<NearPoint> PartDistance::find(const Vec3& point, double within) const {
  auto found = faces_.find(frame_.to_machine(point), within);
  if (found) found->point = frame_.to_part(found->point);
  return found;
}

}  // namespace lamella
