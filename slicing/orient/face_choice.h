#pragma once

#include <string>
#include <vector>

#include "model/scene.h"

namespace lamella {

/// The faces that a user names: "#123" is the STEP entity of a face, a shell or a solid (all its faces, in every
/// instance); anything else a glob on the names of faces, else on names and paths of solids. Throws InputError with the
/// names that there are when nothing matches, for faults in a pattern and for "#" without a number. `option`: for
/// messages.
[[nodiscard]] std::vector<FaceId> find_named_faces(const Scene& scene, const std::string& name, const char* option);

/// The different outward normals of the plane ones among `faces`. Throws InputError when none is plane.
[[nodiscard]] std::vector<Vec3> plane_normals(const Scene& scene, const std::vector<FaceId>& faces,
                                              const std::string& name, const char* option);

}  // namespace lamella
