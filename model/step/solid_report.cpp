#include "model/step/solid_report.h"

#include <cstdio>
#include <set>
#include <utility>

#include "core/tolerances.h"
#include "model/step/entity_label.h"

namespace lamella::step {
namespace {

const char* const kRepair = "repair it in the CAD system and export again";

std::string instances(std::size_t count) {
  if (count < 2) return {};
  return " (and in " + std::to_string(count - 1) + (count == 2 ? " more instance)" : " more instances)");
}

std::string times(int count) { return std::to_string(count) + " times"; }

int badness(SolidStatus status) { return static_cast<int>(status); }

std::string face_text(int face) { return face > 0 ? "face " + label_of(face) : std::string(); }

}  // namespace

SolidReport::SolidReport(Scene& scene, SolidId first, const RawTopology& topology)
    : scene_(scene), first_(first), topology_(topology) {
  for (std::size_t i = first.value(); i < scene.solids.size(); ++i) {
    const SolidId solid{i};
    solids_[scene.solids[solid].info.step_entity].push_back(solid);
  }
  solids_.erase(0);
}

std::vector<SolidId> SolidReport::solids_of(int solid_entity) const {
  const auto found = solids_.find(solid_entity);
  return found == solids_.end() ? std::vector<SolidId>() : found->second;
}

int SolidReport::solid_entity_of(int entity) const {
  if (solids_.contains(entity)) return entity;
  const int face = topology_.face_of(entity);
  return topology_.solid_of(face != 0 ? face : entity);
}

void SolidReport::add(Severity severity, const std::vector<SolidId>& solids, int face, int entity,
                      const std::string& what, const std::string& hint) {
  const std::string solid = solids.empty() ? std::string() : scene_.solids[solids.front()].info.path;
  scene_.findings.push_back(
      {severity, solid, face_text(face), label_of(entity), what + instances(solids.size()), hint});
}

void SolidReport::worsen(const std::vector<SolidId>& solids, SolidStatus status) {
  for (const SolidId solid : solids) {
    SolidInfo& info = scene_.solids[solid].info;
    if (badness(status) > badness(info.status)) info.status = status;
  }
}

void SolidReport::add_remarks(const std::vector<ImportRemark>& remarks) {
  Groups groups;
  for (const ImportRemark& remark : remarks) {
    if (remark.failure) {
      add(Severity::error, solids_of(solid_entity_of(remark.entity)), topology_.face_of(remark.entity), remark.entity,
          "the import failed here: " + remark.what, kRepair);
    } else {
      collect(groups, remark.entity, remark.what);
    }
  }
  for (const auto& [key, group] : groups) {
    const std::vector<SolidId> solids = solids_of(key.first);
    const std::string place = (group.count == 1 ? "at " : times(group.count) + ", first at ") + label_of(group.first);
    for (const SolidId solid : solids) {
      scene_.solids[solid].info.healed.push_back(key.second + " (" + place + ")");
    }
    add(Severity::note, solids, topology_.face_of(group.first), group.first,
        "the import reports: " + key.second + (group.count == 1 ? "" : ", " + times(group.count)), "");
  }
}

void SolidReport::add_refused(const std::vector<RefusedEntity>& refused) {
  Groups groups;
  for (const RefusedEntity& entity : refused) {
    if (solid_entity_of(entity.number) != 0) collect(groups, entity.number, entity.reason);
  }
  for (const auto& [key, group] : groups) {
    add(Severity::warning, solids_of(key.first), topology_.face_of(group.first), group.first,
        "an attribute is missing or wrong" + (group.count == 1 ? "" : ", " + times(group.count)) + ": " + key.second,
        kRepair);
  }
}

void SolidReport::collect(Groups& groups, int entity, const std::string& text) const {
  const int solid = solid_entity_of(entity);
  Group& group = groups[{solids_of(solid).empty() ? 0 : solid, text}];
  if (group.count++ == 0) group.first = entity;
}

void SolidReport::add_lost_faces() {
  std::map<int, std::set<int>> present;  // solid entity -> faces of its instances
  for (const auto& [entity, solids] : solids_) {
    for (const SolidId solid : solids) {
      for (const ShellId shell : scene_.solids[solid].shells) {
        for (const FaceId face : scene_.shells[shell].faces) present[entity].insert(scene_.faces[face].step_entity);
      }
    }
  }
  constexpr int kNamed = 8;
  for (const RawSolid& raw : topology_.solids()) {
    const std::vector<SolidId> solids = solids_of(raw.number);
    if (solids.empty()) continue;
    int lost = 0;
    for (const RawShell& shell : raw.shells) {
      for (const int face : shell.faces) {
        if (present[raw.number].contains(face) || ++lost > kNamed) continue;
        add(Severity::error, solids, face, face, "the face got lost in the import", kRepair);
      }
    }
    if (lost > kNamed) {
      add(Severity::error, solids, 0, raw.number, std::to_string(lost - kNamed) + " more faces got lost", kRepair);
    }
    if (lost > 0) worsen(solids, SolidStatus::invalid);
  }
}

void SolidReport::add_shape_faults(SolidId solid, const std::vector<ShapeFault>& faults) {
  if (faults.empty()) return;
  const int entity = scene_.solids[solid].info.step_entity;
  const std::vector<SolidId> known = solids_of(entity);
  const std::vector<SolidId> solids = known.empty() ? std::vector<SolidId>{solid} : known;
  constexpr std::size_t kNamed = 8;
  for (std::size_t i = 0; i < std::min(faults.size(), kNamed); ++i) {
    const ShapeFault& fault = faults[i];
    const std::string what = fault.face > 0 ? "the face is invalid: " : "the solid is invalid: ";
    add(Severity::error, solids, fault.face, fault.face > 0 ? fault.face : entity, what + fault.what, kRepair);
  }
  if (faults.size() > kNamed) {
    add(Severity::error, solids, 0, entity, std::to_string(faults.size() - kNamed) + " more faces are invalid",
        kRepair);
  }
  worsen(solids, SolidStatus::invalid);
}

void SolidReport::add_split(const std::vector<SolidId>& bodies) {
  if (bodies.size() < 2) return;
  const int entity = scene_.solids[bodies.front()].info.step_entity;
  const std::string what =
      "one solid of the file was split into " + std::to_string(bodies.size()) + ": its shells lie outside each other";
  for (const SolidId solid : bodies) scene_.solids[solid].info.healed.push_back(what + " (" + label_of(entity) + ")");
  add(Severity::warning, {bodies.front()}, 0, entity, what, "check that the voids are where they belong");
}

void SolidReport::add_wide_tolerances() {
  for (std::size_t i = first_.value(); i < scene_.solids.size(); ++i) {
    const Solid& solid = scene_.solids[SolidId{i}];
    if (!(solid.info.max_tolerance > tolerance::kAccurateEdge)) continue;
    const Face* worst_face = nullptr;
    double worst = 0.0;
    for (const ShellId shell : solid.shells) {
      for (const FaceId face : scene_.shells[shell].faces) {
        for (const LoopId loop : scene_.faces[face].loops) {
          for (const HalfEdgeId half_edge : scene_.loops[loop].half_edges) {
            const double tolerance = scene_.edges[scene_.half_edges[half_edge].edge].tolerance;
            if (tolerance <= worst) continue;
            worst = tolerance;
            worst_face = &scene_.faces[face];
          }
        }
      }
    }
    char text[96];
    std::snprintf(text, sizeof text, "the faces meet only within %.3g mm", solid.info.max_tolerance);
    const int face = worst_face == nullptr ? 0 : worst_face->step_entity;
    add(Severity::warning, {SolidId{i}}, face, face > 0 ? face : solid.info.step_entity, text,
        "expect errors of this size there, or repair it in the CAD system");
  }
}

void settle_raw_faults(Scene& scene, const PendingFaults& pending) {
  std::map<int, std::vector<SolidId>> solids;
  for (std::size_t i = pending.first.value(); i < pending.end.value(); ++i) {
    solids[scene.solids[SolidId{i}].info.step_entity].push_back(SolidId{i});
  }
  for (const RawFault& fault : pending.faults) {
    const std::vector<SolidId>& of_fault = solids[fault.solid];
    Finding finding{Severity::error, {}, face_text(fault.face), label_of(fault.entity), fault.what, kRepair};
    if (of_fault.empty()) {
      // The solid is not in the scene: loose geometry that is named as such, or nothing that a part uses.
      finding.severity = Severity::warning;
      finding.what += " (of " + label_of(fault.solid) + ", which is not sliced)";
      scene.findings.push_back(finding);
      continue;
    }
    const SolidInfo& info = scene.solids[of_fault.front()].info;
    finding.solid = info.path;
    const bool healed = info.closed && info.status == SolidStatus::ok;
    if (healed) {
      finding.severity = Severity::warning;
      finding.what += fault.breaks ? "; the import mended that without being asked" : "; its edges do close";
      for (const SolidId solid : of_fault) {
        scene.solids[solid].info.healed.push_back(fault.what + " (" + label_of(fault.entity) + ")");
      }
    }
    finding.what += instances(of_fault.size());
    scene.findings.push_back(finding);
  }
}

}  // namespace lamella::step
