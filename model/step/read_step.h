#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "core/progress.h"
#include "model/scene.h"

namespace lamella {

struct StepOptions {
  bool heal = true;                              ///< let the import repair what it can; each repair is reported
  std::size_t max_bytes = std::size_t{4} << 30;  ///< larger files are refused
  std::size_t max_faces = 4'000'000;             ///< of all instances; larger assemblies are refused
};

/// Reads one or several STEP files (AP203, AP214, AP242) into one scene, solids in the order of the assembly walk and
/// of the files given, placements and units applied.
///
/// Throws InputError when a file can't be read, holds no solid at all, or is larger than allowed; Cancelled when asked.
/// Solids that are open, invalid or empty stay in the scene with their status and a finding that names solid, face and
/// STEP entity.
[[nodiscard]] Scene read_step(std::span<const std::filesystem::path> files, const StepOptions& options = {},
                              const Progress& progress = {});

}  // namespace lamella
