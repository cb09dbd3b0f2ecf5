#pragma once

#include "model/scene.h"

namespace lamella {

/// Whether solid `b` is `a` moved by `offset`, without a look at curves and surfaces: the same faces of the file in the
/// same order, used by the same loops, with vertices that agree but for rounding. What the reader says about instances
/// (SolidInfo::instance) holds only until somebody changes the scene; this tells.
[[nodiscard]] bool is_shifted(const Scene& scene, SolidId a, SolidId b, const Vec3& offset);

/// Whether one difference of ids leads from the faces of `a` to those of `b`, in their order. Both have as many shells,
/// of as many faces each.
[[nodiscard]] bool have_parallel_faces(const Scene& scene, SolidId a, SolidId b);

}  // namespace lamella
