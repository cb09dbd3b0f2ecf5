#pragma once

#include <vector>

#include "core/error.h"
#include "model/scene.h"

namespace lamella {

/// Checks the half-edge structure and names what fails before anything is sliced: edges not used exactly twice in
/// opposite senses, loops that don't close, vertices off their curves by more than the stated tolerance, shells turned
/// inside out (by signed volume), voids outside their solid. Sets `twin`, `Shell::closed`, `Shell::is_void` and the
/// solids' status and `closed`; turns inverted shells the right way round and says so in `SolidInfo::healed`.
void complete_topology(Scene& scene);

}  // namespace lamella
