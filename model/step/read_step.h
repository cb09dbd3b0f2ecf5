#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "core/progress.h"
#include "model/motion.h"
#include "model/scene.h"

namespace lamella {

class StepShapes;

struct StepOptions {
  bool heal = true;                              ///< let the import repair what it can; each repair is reported
  std::size_t max_bytes = std::size_t{4} << 30;  ///< larger files are refused
  std::size_t max_faces = 4'000'000;             ///< of all instances; larger assemblies are refused
};

/// A STEP file and where copies of what it holds are placed, in the file's own frame.
struct StepPart {
  std::filesystem::path file;
  std::string label;                  ///< first component of the solids' paths, copies numbered; may be empty
  std::vector<Motion> placements{1};  ///< one a copy
};

/// Copies of all parts together that are read at most.
inline constexpr std::size_t kMaxPlacements = 1'000'000;

/// Reads one or several STEP files (AP203, AP214, AP242) into one scene, solids in the order of the assembly walk and
/// of the files given, placements and units applied.
///
/// Throws InputError when a file can't be read, holds no solid at all, or is larger than allowed; Cancelled when asked.
/// Solids that are open, invalid or empty stay in the scene with their status and a finding that names solid, face and
/// STEP entity.
[[nodiscard]] Scene read_step(std::span<const std::filesystem::path> files, const StepOptions& options = {},
                              const Progress& progress = {});

/// The same with each file read once and placed as often as asked: solids in the order of the parts, then of the
/// placements, then of the walk. With a label the paths are "/label/...", of several copies "/label.1/...",
/// "/label.2/..."; without one the copies' paths get numbers at their ends. Throws InputError also for placements that
/// aren't finite, turn by no rotation or are too many. `shapes`, if given, gets OpenCASCADE's shapes of the solids.
[[nodiscard]] Scene read_step_parts(std::span<const StepPart> parts, const StepOptions& options = {},
                                    const Progress& progress = {}, StepShapes* shapes = nullptr);

}  // namespace lamella
