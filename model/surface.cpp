#include "model/surface.h"

namespace lamella {

const char* surface_type_name(const Surface& surface) {
  static constexpr const char* kNames[] = {"plane",     "cylinder",   "cone",    "sphere", "torus",
                                           "extrusion", "revolution", "bspline", "fitted"};
  static_assert(std::size(kNames) == std::variant_size_v<Surface>);
  return kNames[surface.index()];
}

}  // namespace lamella
