#pragma once

#include <cstddef>
#include <vector>

#include "core/progress.h"
#include "model/support_function.h"

namespace lamella {

/// When the search for the least height over all orientations may stop.
struct LeastWidthLimits {
  double gap = 1e-7;                ///< relative: proved least height >= (1 - gap) found height
  std::size_t max_cells = 200'000;  ///< triangles of directions looked at; then the gap is what it is
};

/// The least height of some solids over all orientations: the minimum width of their convex hull.
struct LeastWidth {
  Vec3 direction = Vec3::UnitZ();  ///< unit vector that is to point up (or down: the height is the same)
  double height = 0.0;             ///< mm, at that direction, exact
  double proved = 0.0;             ///< mm: no orientation is lower than this, but for `accuracy`
  double accuracy = 0.0;           ///< mm, of heights (SupportFunction::accuracy())
  std::size_t cells = 0;           ///< triangles of directions looked at
  std::size_t heights = 0;         ///< exact heights computed
  bool converged = true;           ///< every search inside a face ended within its limits
  std::vector<Vec3> minima;        ///< directions of low height met on the way, lowest first, 5 degrees apart

  /// Relative: how much lower than `height` an orientation may be at most.
  [[nodiscard]] double gap() const { return height > 0.0 ? (height - proved) / height : 0.0; }
};

/// Searches all directions by branch and bound over spherical triangles with a rigorous bound for each
/// (docs/methods/orientation.md). `known`: directions to try first, unit vectors; they only save time.
/// The result doesn't depend on the machine's speed. Throws Cancelled.
[[nodiscard]] LeastWidth find_least_width(const SupportFunction& support, const LeastWidthLimits& limits = {},
                                          const std::vector<Vec3>& known = {}, const Progress& progress = {});

}  // namespace lamella
