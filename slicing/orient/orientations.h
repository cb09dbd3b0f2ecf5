#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slicing/orient/axis_scan.h"
#include "slicing/orient/judge.h"
#include "slicing/orient/least_width.h"

namespace lamella {

/// How much each figure counts, 0 or more; each figure is divided by OrientationJudge::scale() first. Of contact what
/// is missing counts.
struct OrientationWeights {
  double height = 0.0;
  double layers = 0.0;
  double support_area = 0.0;
  double support_volume = 0.0;
  double cusp = 0.0;
  double contact = 0.0;
  double tool_changes = 0.0;

  [[nodiscard]] double sum() const {
    return height + layers + support_area + support_volume + cusp + contact + tool_changes;
  }
};

/// What is asked of an orientation.
struct OrientationWishes {
  OrientationWeights weights;
  std::vector<Vec3> down;    ///< outward normals, one of which is to point down; empty: any direction
  std::optional<Vec3> room;  ///< mm, what the machine builds of the part along x, y, z
  std::size_t count = 5;     ///< candidates to hand out
};

/// One orientation and what speaks for it.
struct OrientationCandidate {
  Vec3 up = Vec3::UnitZ();  ///< in the present frame
  Lying lying;
  OrientationFigures figures;
  double score = 0.0;          ///< weighted mean of the scaled figures: less is better
  double support_error = 0.0;  ///< mm^3, of the sampled volume, about
  bool fits = true;            ///< into the room
  bool is_free = true;         ///< no support on or below the faces that are to be free of it
  std::string origin;          ///< "least height", "as it is", "axis scheme", "plane face down", "direction", "refined"
};

/// What was found, best first; no two candidates' directions are nearer than 5 degrees.
struct Orientations {
  std::vector<OrientationCandidate> candidates;
  std::size_t tried = 0;  ///< orientations that were judged
};

/// Judges the directions of least height, the present one, the machine's axes, what lets large plane faces lie down,
/// and 258 directions all around; climbs down from the best of them by the score. Candidates that fit and keep faces
/// free go before others. Throws Cancelled.
[[nodiscard]] Orientations find_orientations(const OrientationJudge& judge, const SupportFunction& support,
                                             const LeastWidth& least, const std::optional<AxisScanResult>& scan,
                                             const OrientationWishes& wishes, const Progress& progress = {},
                                             int threads = 0);

/// The score of some figures.
[[nodiscard]] double score_of(const OrientationFigures& figures, const OrientationFigures& scale,
                              const OrientationWeights& weights);

}  // namespace lamella
