#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/progress.h"
#include "model/scene.h"
#include "slicing/hit.h"

namespace lamella {

/// How the reference engine solves the paper's eq. (7) on a sub-patch.
enum class Solver { certified, bisection, newton };

struct ReferenceOptions {
  Solver solver = Solver::certified;
  double tolerance = 1e-2;    ///< mm, the paper's success criterion (eq. 9); the certified solver ignores it
  double subdivision = 1e-1;  ///< mm, the paper's subdivision factor: flatness at which refinement stops
};

/// The spans of one solid on one ray, with the hits they came from.
struct SolidCast {
  SolidId solid;
  std::vector<Hit> hits;    ///< ascending in t
  std::vector<Span> spans;  ///< disjoint, ascending; empty when the ray could not be closed
};

/// The 2003 paper's engine, steps 2 to 5: faces as rational B-splines, refined by the Oslo algorithm until flat, boxes
/// of the control nets in a tree, root finding on each sub-patch whose box the ray meets, trim test in (u, v), entry
/// and exit by the sign of N.d, solid by solid in sequence. Any line in space.
///
/// Immutable after construction; cast() may be called from several threads at once.
class ReferenceEngine {
 public:
  /// Prepares all solids of the scene, which must outlive the engine. Throws GeometryError for surfaces beyond the
  /// stated limits, Cancelled when asked.
  ReferenceEngine(const Scene& scene, const ReferenceOptions& options, const Progress& progress = {}, int threads = 0);
  /// Prepares some of them only; rays meet nothing of the others.
  ReferenceEngine(const Scene& scene, std::span<const SolidId> solids, const ReferenceOptions& options,
                  const Progress& progress = {}, int threads = 0);
  ~ReferenceEngine();
  ReferenceEngine(ReferenceEngine&&) noexcept;

  /// All crossings of the whole line with one solid, raw: as the solver and the trim test gave them, ascending in t, no
  /// tie broken and nothing closed.
  void find_hits(const Ray& ray, SolidId solid, std::vector<Hit>& hits, CastCounters& counters) const;

  /// Closed spans of one solid. Ties (a ray through an edge, a vertex or a tangency) are decided as if the ray ran an
  /// infinitesimal step to the side of `up`, then of up x direction: the half-open rule of
  /// docs/methods/reference-engine.md.
  void cast(const Ray& ray, const Vec3& up, SolidId solid, SolidCast& out, CastCounters& counters) const;

  /// All solids whose box the ray meets, in sequence.
  void cast_all(const Ray& ray, const Vec3& up, std::vector<SolidCast>& out, CastCounters& counters) const;

 private:
  struct Data;
  std::unique_ptr<const Data> data_;
};

}  // namespace lamella
