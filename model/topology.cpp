#include "model/topology.h"

#include <cstdio>
#include <iterator>

#include "model/topology_detail.h"

namespace lamella {

namespace topology {

namespace {

/// How bad a status is; the worse one stays.
int rank(SolidStatus status) {
  switch (status) {
    case SolidStatus::ok:
      return 0;
    case SolidStatus::open:
      return 1;
    case SolidStatus::invalid:
      return 2;
    case SolidStatus::empty:
      return 3;
  }
  return 3;
}

void worsen(SolidInfo& info, SolidStatus status) {
  if (rank(status) > rank(info.status)) info.status = status;
}

std::string face_text(const Scene& scene, SolidId solid, FaceId face) {
  if (!face.valid()) return {};
  const FaceId first = scene.shells[scene.solids[solid].shells.first].faces.first;
  std::string text = "face " + std::to_string(face.value() - first.value() + 1);
  if (!scene.faces[face].name.empty()) text += " '" + scene.faces[face].name + "'";
  return text;
}

constexpr const char* kKindText[] = {
    "free edges",
    "edges run through twice in one sense",
    "edges used by more than two faces that can't be paired",
    "shells without a face",
    "loops that don't close",
    "loops that jump in (u, v)",
    "vertices off their edges",
    "pcurves off their edges",
    "faces with numbers that aren't finite",
    "faces whose loops contradict their orientation",
    "shells turned inside out",
    "shells that don't nest",
    "shells without a reliable volume",
};
static_assert(std::size(kKindText) == static_cast<std::size_t>(Fault::count));

}  // namespace

std::string entity_text(int entity) {
  if (entity <= 0) return {};
  std::string text = "#";
  text += std::to_string(entity);
  return text;
}

std::string length_text(double length) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g mm", length);
  return text.data();
}

void FaultLog::add(Fault kind, SolidStatus status, FaceId face, int entity, const std::string& what,
                   const std::string& hint) {
  SolidInfo& info = scene_.solids[solid_].info;
  worsen(info, status);
  if (counts_[static_cast<std::size_t>(kind)]++ >= kNamed) return;
  if (entity == 0 && face.valid()) entity = scene_.faces[face].step_entity;
  const Severity severity = status == SolidStatus::ok ? Severity::warning : Severity::error;
  scene_.findings.push_back({severity, info.path, face_text(scene_, solid_, face), entity_text(entity), what, hint});
}

void FaultLog::finish() {
  const SolidInfo& info = scene_.solids[solid_].info;
  for (std::size_t kind = 0; kind < counts_.size(); ++kind) {
    if (counts_[kind] <= kNamed) continue;
    const std::string what = std::to_string(counts_[kind] - kNamed) + " more " + kKindText[kind];
    scene_.findings.push_back({Severity::warning, info.path, {}, entity_text(info.step_entity), what, {}});
  }
}

}  // namespace topology

namespace {

using topology::Fault;
using topology::FaultLog;

bool has_faces(const Scene& scene, const Solid& solid) {
  for (const ShellId shell : solid.shells) {
    if (!scene.shells[shell].faces.empty()) return true;
  }
  return false;
}

void check_solid(Scene& scene, SolidId id) {
  FaultLog log(scene, id);
  const IdRange<ShellId> shells = scene.solids[id].shells;
  if (!has_faces(scene, scene.solids[id])) {
    log.add(Fault::no_face, SolidStatus::empty, {}, scene.solids[id].info.step_entity, "the solid has no face",
            "nothing of it survived the import; export it again as a B-rep solid");
    scene.solids[id].info.closed = false;
    log.finish();
    return;
  }
  bool closed = true;
  for (const ShellId shell : shells) {
    topology::pair_half_edges(scene, shell, &log);
    closed = closed && scene.shells[shell].closed;
    for (const FaceId face : scene.shells[shell].faces) topology::check_loops(scene, face, log);
  }
  topology::orient_shells(scene, id, log);
  SolidInfo& info = scene.solids[id].info;
  info.closed = info.closed && closed;
  log.finish();
}

}  // namespace

void complete_topology(Scene& scene) {
  for (const SolidId solid : scene.solids.ids()) check_solid(scene, solid);
}

}  // namespace lamella
