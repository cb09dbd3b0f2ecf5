#pragma once

#include <array>
#include <string>

#include "core/error.h"
#include "model/scene.h"

/// Steps of complete_topology(); not for use elsewhere.
namespace lamella::topology {

enum class Fault {
  free_edge,
  same_sense_edge,
  crowded_edge,
  no_face,
  loop_open,
  loop_jump,
  vertex_off,
  pcurve_off,
  not_finite,
  region_sense,
  shell_turned,
  shell_nesting,
  shell_unmeasured,
  count
};

/// Names the faults of one solid. Of each kind the first few become findings, the rest one line with their number, so
/// that a hostile file can't flood the report.
class FaultLog {
 public:
  FaultLog(Scene& scene, SolidId solid) : scene_(scene), solid_(solid) {}

  /// `status` is the worst the fault makes of the solid (ok: none). `entity` 0 stands for the face's own, if it has
  /// one.
  void add(Fault kind, SolidStatus status, FaceId face, int entity, const std::string& what, const std::string& hint);
  /// Adds the lines for what was not named one by one.
  void finish();

 private:
  static constexpr int kNamed = 5;

  Scene& scene_;
  SolidId solid_;
  std::array<int, static_cast<std::size_t>(Fault::count)> counts_{};
};

/// "#12", or empty for 0.
[[nodiscard]] std::string entity_text(int entity);
/// A length for messages, in mm.
[[nodiscard]] std::string length_text(double length);

/// Sets the twins of a shell's half-edges and Shell::closed. Faults go to `log` unless it is null.
void pair_half_edges(Scene& scene, ShellId shell, FaultLog* log);

/// Chains of half-edges, vertices on their curves, pcurves on their edges.
void check_loops(const Scene& scene, FaceId face, FaultLog& log);

/// Signs and nesting of the closed shells of a solid by signed volume and winding number; turns what is inside out.
void orient_shells(Scene& scene, SolidId solid, FaultLog& log);

}  // namespace lamella::topology
