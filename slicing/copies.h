#pragma once

#include <span>
#include <vector>

#include "model/measure.h"
#include "model/scene.h"

namespace lamella {

/// Solids that touch or overlap one another, directly or by way of others, and none else.
struct Cluster {
  std::vector<SolidId> solids;
  Box3 bounds;  ///< mm
};

/// Clusters of the same instances at the same heights, shifted in the plane. solids[i] of each has the faces of
/// solids[i] of the first, in the same order.
struct CopiedCluster {
  std::vector<Cluster> copies;
  std::vector<Vec2> offsets;  ///< mm, of each from the first, whose is 0
};

/// The clusters of `solids` that come more than once, by what the reader says about instances. Which of the copies is
/// the first depends on where they lie, neither on ids nor on the order of the file.
///
/// What holds for a cluster holds for its copies: no other solid is so near that a difference in the last bits could
/// tell (docs/methods/layers.md).
[[nodiscard]] std::vector<CopiedCluster> find_copies(const Scene& scene,
                                                     const IdVector<SolidId, SolidMeasure>& measures,
                                                     std::span<const SolidId> solids);

}  // namespace lamella
