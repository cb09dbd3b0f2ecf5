#pragma once

#include "model/scene.h"

namespace lamella::test {

/// One solid of a scene as a scene of its own, without the findings.
[[nodiscard]] Scene single_solid(const Scene& scene, SolidId solid);

/// Takes a face out of its shell; the scene's other faces keep their ids but the shell's last, which takes its place.
void delete_face(Scene& scene, FaceId face);

}  // namespace lamella::test
