#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/progress.h"
#include "model/scene.h"

namespace lamella {

/// A point of the exact surface that stands for a piece of it.
struct SurfaceSample {
  Vec3 point;
  Vec3 normal;        ///< outward, unit
  double area = 0.0;  ///< mm^2 of the piece
  FaceId face;
};

/// The outside of some solids as samples.
struct SurfaceSamples {
  std::vector<SurfaceSample> samples;
  double area = 0.0;         ///< mm^2, of the samples together
  double buried_area = 0.0;  ///< mm^2, left out because another solid lies there
  std::vector<FaceId> unsampled;
};

/// Samples all faces, about `count` of them, at least a few a face, spread evenly over each face's parameters at the
/// same places in every run. The areas of a face's samples add up to its exact area. Where a solid lies against another
/// one (another solid holds the point 2e-5 of the solids' size out) there is no outside: such samples are left out.
/// Throws Cancelled.
[[nodiscard]] SurfaceSamples sample_surfaces(const Scene& scene, std::span<const SolidId> solids, std::size_t count,
                                             const Progress& progress = {}, int threads = 0);

}  // namespace lamella
