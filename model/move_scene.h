#pragma once

#include "model/motion.h"
#include "model/scene.h"

namespace lamella {

/// The scene moved as a whole: every curve, surface and vertex by the motion, parameters as they were. Instances keep
/// their part's frame (SolidInfo::instance moves along), so that what is described in it moves along as well.
[[nodiscard]] Scene moved(Scene scene, const Motion& motion);

/// Whether `turn` is a rotation, to 1e-9.
[[nodiscard]] bool is_rotation(const Mat3& turn);

}  // namespace lamella
