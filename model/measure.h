#pragma once

#include "core/geometry.h"
#include "core/ids.h"
#include "core/progress.h"
#include "model/scene.h"

namespace lamella {

/// Exact integrals of one solid, by our own quadrature: divergence theorem over the faces, Green's theorem over the
/// trims, adaptive Gauss-Legendre until the estimated error is below `relative_error` of the result.
struct SolidMeasure {
  double volume = 0.0;                  ///< mm^3, positive for an outward-oriented closed solid
  double area = 0.0;                    ///< mm^2
  Box3 bounds;                          ///< exact bounds of the trimmed faces, not enlarged by any tolerance
  Vec3 abs_normal_area = Vec3::Zero();  ///< integrals of |n_x|, |n_y|, |n_z| over the surface, mm^2 (within 1 %)
  double volume_error = 0.0;            ///< estimated absolute error, mm^3
  bool converged = true;
};

[[nodiscard]] SolidMeasure measure_solid(const Scene& scene, SolidId solid, double relative_error = 1e-8);

/// All solids, in parallel. Shifted copies are measured once: their bounds differ by the shift, with its rounding.
[[nodiscard]] IdVector<SolidId, SolidMeasure> measure_solids(const Scene& scene, const Progress& progress = {},
                                                             int threads = 0);

/// Bounds of one trimmed face, exact to 1e-9 of its size.
[[nodiscard]] Box3 exact_bounds(const Scene& scene, FaceId face);

}  // namespace lamella
