#include "apps/assembly.h"

#include "model/solid_status.h"
#include "slicing/slicer.h"

namespace lamella::apps {

Assembly read_assembly(const Session& session, const std::vector<std::string>& files,
                       const std::optional<std::string>& materials, StepShapes* shapes) {
  std::vector<StepPart> parts;
  for (const std::string& file : files) parts.push_back({file, {}});
  return read_assembly(session, parts, materials, shapes);
}

Assembly read_assembly(const Session& session, std::span<const StepPart> parts,
                       const std::optional<std::string>& materials, StepShapes* shapes) {
  std::optional<MaterialRules> rules;
  if (materials) rules = read_material_rules(*materials);
  Assembly assembly;
  assembly.scene = read_step_parts(parts, {}, session.progress(), shapes);
  assembly.findings = assembly.scene.findings;
  if (rules) {
    for (const std::filesystem::path& file : rules->files) assembly.material_files.push_back(file.string());
    const std::vector<Finding> unused = find_unused_rules(assembly.scene, *rules);
    assembly.findings.insert(assembly.findings.end(), unused.begin(), unused.end());
  }
  session.warn(assembly.findings);
  assembly.table = rules ? assign_materials(assembly.scene, *rules) : assign_materials(assembly.scene);
  return assembly;
}

void measure_assembly(const Session& session, Assembly& assembly) {
  assembly.measures = measure_solids(assembly.scene, session.progress(), session.threads());
}

bool has_bounds(const Assembly& assembly, SolidId id) {
  constexpr double kFarthest = 1e9;  // mm
  const Box3& box = assembly.measures[id].bounds;
  if (box.isEmpty() || !box.min().allFinite() || !box.max().allFinite()) return false;
  const double reach = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff();
  return reach <= kFarthest || is_sliceable(assembly.scene.solids[id].info);
}

Box3 bounds_of(const Assembly& assembly) {
  Box3 bounds;
  for (const SolidId id : assembly.scene.solids.ids()) {
    if (has_bounds(assembly, id)) bounds.extend(assembly.measures[id].bounds);
  }
  return bounds;
}

bool is_sliceable(const SolidInfo& solid) { return is_closed(solid) && solid.status != SolidStatus::empty; }

void require_solid(const Scene& scene, bool allow_open) {
  std::string paths;
  for (const Solid& solid : scene.solids) {
    const bool is_open_but_there = allow_open && solid.info.status != SolidStatus::empty;
    if (is_sliceable(solid.info) || is_open_but_there) return;
    paths += (paths.empty() ? "" : ", ") + solid.info.path + " (" + status_word(solid.info) + ")";
  }
  throw InputError("no closed solid to slice", paths, "repair the model, or slice open solids with --allow-open");
}

}  // namespace lamella::apps
