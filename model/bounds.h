#pragma once

#include "model/scene.h"

namespace lamella {

/// Bounds of a trimmed face and whether they are certain to 1e-9 of the face's size.
struct FaceBounds {
  Box3 box;
  bool converged = true;
};

/// As exact_bounds(scene, face), with the outcome of the search inside the face. Throws as TrimRegion does.
[[nodiscard]] FaceBounds face_bounds(const Scene& scene, FaceId face);

}  // namespace lamella
