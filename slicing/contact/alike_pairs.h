#pragma once

#include <span>
#include <utility>
#include <vector>

#include "core/ids.h"
#include "model/scene.h"

namespace lamella {

/// Two solids that come near one another. The first has the higher rank.
using SolidPair = std::pair<SolidId, SolidId>;

/// A pair, and all of `like`, which lie to one another and to all that is near them as it does, each shifted in the
/// plane.
struct AlikePairs {
  std::size_t first = 0;          ///< its place among the pairs
  std::vector<std::size_t> like;  ///< places of the others
};

/// Sorts pairs of instances into those that are alike, by what the reader says about instances (SolidInfo::instance)
/// and is_shifted() confirms; places agree to 1e-8 mm. `pairs` are all that there are, so that they say who is near
/// whom. Of what is alike, the one that lies lowest along y, then along x, comes first, neither ids nor the order of
/// the file deciding. One difference of ids leads from the faces of a solid to those of its like
/// (have_parallel_faces()).
[[nodiscard]] std::vector<AlikePairs> find_alike_pairs(const Scene& scene, std::span<const SolidPair> pairs);

/// mm in the plane, from one solid to another that find_alike_pairs() took to be alike.
[[nodiscard]] Vec3 shift_between(const Scene& scene, SolidId from, SolidId to);

}  // namespace lamella
