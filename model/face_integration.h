#pragma once

#include <span>
#include <vector>

#include "model/scene.h"

namespace lamella {

/// Integrals over a set of faces; `volume` is that of a solid if they are all its faces.
struct SurfaceSums {
  double volume = 0.0;                  ///< mm^3, signed
  double area = 0.0;                    ///< mm^2
  Vec3 abs_normal_area = Vec3::Zero();  ///< mm^2
  double volume_error = 0.0;            ///< estimated, mm^3
  bool converged = true;                ///< every face finite, and the errors within what was asked
  std::vector<FaceId> unmeasured;       ///< faces left out: not finite or beyond the limits of the exact model
  std::vector<FaceId> contradictory;    ///< faces whose loops run the wrong way round for their orientation
};

/// Refines face by face until the estimated errors are below `relative_error` of the volume, below that or 1e-6 of the
/// area and 0.3 % of the |n| integrals, or the work per face is spent. A face whose integrals aren't finite, or whose
/// geometry is beyond the stated limits, counts for nothing and makes the result not converged.
[[nodiscard]] SurfaceSums integrate_faces(const Scene& scene, std::span<const FaceId> faces, double relative_error);

/// How often the shells' faces wind round `point`: near 1 inside a closed outward-oriented shell, 0 outside.
/// Good to a few hundredths unless the point all but touches the shell.
[[nodiscard]] double winding_number(const Scene& scene, std::span<const FaceId> faces, const Vec3& point);

/// Middle of the box of the faces' vertices; zero if there is none or it isn't finite.
[[nodiscard]] Vec3 middle_of(const Scene& scene, std::span<const FaceId> faces);

}  // namespace lamella
