#include <algorithm>
#include <cmath>
#include <vector>

#include "model/bounds.h"
#include "model/face_integration.h"
#include "model/topology_detail.h"

namespace lamella::topology {

namespace {

/// Good enough for a sign; shells thinner than this part of themselves aren't solids.
constexpr double kVolumeAccuracy = 1e-4;

struct ShellFacts {
  ShellId id;
  double volume = 0.0;   ///< signed, mm^3
  bool certain = false;  ///< the sign of the volume is
  Box3 box;
  int depth = 0;  ///< number of shells around it
};

std::vector<FaceId> faces_of(const Shell& shell) {
  std::vector<FaceId> faces;
  for (const FaceId face : shell.faces) faces.push_back(face);
  return faces;
}

void report_contradictory(const std::vector<FaceId>& faces, FaultLog& log) {
  for (const FaceId face : faces) {
    log.add(Fault::region_sense, SolidStatus::invalid, face, 0,
            "the loops run the wrong way round for the face's orientation, or don't enclose it",
            "repair the face's trimming curves in the CAD system");
  }
}

void report_unmeasured(const std::vector<FaceId>& faces, FaultLog& log) {
  for (const FaceId face : faces) {
    log.add(Fault::not_finite, SolidStatus::invalid, face, 0,
            "the face's geometry is not finite or beyond the limits of the exact model (degree, weights)",
            "repair or simplify the face in the CAD system");
  }
}

ShellFacts measure_shell(const Scene& scene, ShellId id, FaultLog& log) {
  ShellFacts facts;
  facts.id = id;
  const Shell& shell = scene.shells[id];
  const SurfaceSums sums = integrate_faces(scene, faces_of(shell), kVolumeAccuracy);
  report_contradictory(sums.contradictory, log);
  report_unmeasured(sums.unmeasured, log);
  facts.volume = sums.volume;
  facts.certain = sums.unmeasured.empty() && std::abs(sums.volume) > 10.0 * sums.volume_error && sums.volume != 0.0;
  if (!facts.certain && sums.unmeasured.empty()) {
    log.add(Fault::shell_unmeasured, SolidStatus::invalid, shell.faces.first, shell.step_entity,
            "the shell encloses no certain volume", "its surfaces cross or fold back; repair it in the CAD system");
  }
  return facts;
}

/// A point of the shell for the test whether it lies inside another one.
Vec3 point_of(const Scene& scene, const Shell& shell) {
  for (const FaceId face : shell.faces) {
    for (const LoopId loop : scene.faces[face].loops) {
      for (const HalfEdgeId id : scene.loops[loop].half_edges) {
        return scene.vertices[scene.edges[scene.half_edges[id].edge].start].point;
      }
    }
  }
  return Vec3::Zero();
}

/// Box first: a void among a hundred is asked about only one shell. A winding number in doubt (the point all but
/// touches the shell) leaves it at the boxes.
bool is_around(const Scene& scene, const ShellFacts& outer, const ShellFacts& inner) {
  if (!outer.box.contains(inner.box)) return false;
  const double winding =
      std::abs(winding_number(scene, faces_of(scene.shells[outer.id]), point_of(scene, scene.shells[inner.id])));
  return winding > 0.5 || std::abs(winding - 0.5) < 0.2;
}

void find_depths(const Scene& scene, std::vector<ShellFacts>& shells) {
  if (shells.size() < 2) return;
  for (ShellFacts& shell : shells) {
    for (const FaceId face : scene.shells[shell.id].faces) shell.box.extend(face_bounds(scene, face).box);
  }
  for (ShellFacts& inner : shells) {
    for (const ShellFacts& outer : shells) {
      if (outer.id != inner.id && is_around(scene, outer, inner)) ++inner.depth;
    }
  }
}

void turn(Scene& scene, ShellId id) {
  for (const FaceId face : scene.shells[id].faces) {
    scene.faces[face].same_sense = !scene.faces[face].same_sense;
    for (const LoopId loop : scene.faces[face].loops) {
      const IdRange<HalfEdgeId> chain = scene.loops[loop].half_edges;
      std::vector<HalfEdge> uses;
      for (const HalfEdgeId half_edge : chain) uses.push_back(scene.half_edges[half_edge]);
      for (const HalfEdgeId half_edge : chain) {
        HalfEdge& use = scene.half_edges[half_edge] = uses.back();
        use.forward = !use.forward;
        uses.pop_back();
      }
    }
  }
  pair_half_edges(scene, id, nullptr);
}

void turn_inverted(Scene& scene, SolidId solid, const ShellFacts& shell, FaultLog& log) {
  turn(scene, shell.id);
  std::string what = shell.depth % 2 == 1 ? "void " : "shell ";
  what += entity_text(scene.shells[shell.id].step_entity) + " was inside out and has been turned";
  log.add(Fault::shell_turned, SolidStatus::ok, scene.shells[shell.id].faces.first, scene.shells[shell.id].step_entity,
          what, "its faces pointed into the material; nothing to do if that's all");
  scene.solids[solid].info.healed.push_back(std::move(what));
}

/// Every second shell from outside bounds a void, and its volume counts negative.
void set_sense(Scene& scene, SolidId solid, const ShellFacts& shell, FaultLog& log) {
  Shell& entry = scene.shells[shell.id];
  const bool said_void = shell.id != scene.solids[solid].shells.first;
  entry.is_void = shell.depth % 2 == 1;
  const bool inverted = (shell.volume < 0.0) != entry.is_void;
  if (!inverted) return;
  if (said_void && shell.depth == 0) {
    entry.is_void = true;
    log.add(Fault::shell_nesting, SolidStatus::invalid, entry.faces.first, entry.step_entity,
            "a void lies outside its solid", "move or delete the void in the CAD system");
    return;
  }
  turn_inverted(scene, solid, shell, log);
}

/// The outer shell comes first, whatever the file's order.
void put_outer_first(Scene& scene, SolidId solid, std::vector<ShellFacts>& shells) {
  const ShellId first = scene.solids[solid].shells.first;
  const auto outer = std::max_element(shells.begin(), shells.end(), [](const ShellFacts& a, const ShellFacts& b) {
    if (a.depth != b.depth) return a.depth > b.depth;
    return std::abs(a.volume) < std::abs(b.volume);
  });
  const auto now_first = std::find_if(shells.begin(), shells.end(), [&](const ShellFacts& s) { return s.id == first; });
  if (outer == shells.end() || now_first == shells.end() || now_first->depth == 0) return;
  std::swap(scene.shells[first], scene.shells[outer->id]);
  std::swap(now_first->id, outer->id);
  for (const ShellId id : {now_first->id, outer->id}) {
    for (const FaceId face : scene.shells[id].faces) scene.faces[face].shell = id;
  }
}

}  // namespace

void orient_shells(Scene& scene, SolidId solid, FaultLog& log) {
  std::vector<ShellFacts> shells;
  for (const ShellId id : scene.solids[solid].shells) {
    if (scene.shells[id].closed) shells.push_back(measure_shell(scene, id, log));
  }
  std::erase_if(shells, [](const ShellFacts& s) { return !s.certain; });
  find_depths(scene, shells);
  put_outer_first(scene, solid, shells);
  for (const ShellFacts& shell : shells) set_sense(scene, solid, shell, log);
}

}  // namespace lamella::topology
