#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/assembly.h"
#include "apps/json.h"
#include "apps/outputs.h"
#include "slicing/accuracy/choose_lattice.h"
#include "slicing/layer_plan.h"
#include "slicing/report.h"

namespace lamella::apps {

/// Seconds of wall time. `slice` holds `write`: layers are written while others are cut.
struct Timing {
  double read = 0.0;
  double prepare = 0.0;
  double slice = 0.0;
  double write = 0.0;
  double total = 0.0;
};

/// What a run has to tell.
struct SliceOutcome {
  const Assembly& assembly;
  const LayerPlan& plan;
  const SliceReport& report;
  const std::vector<Output>& outputs;
  Timing timing;
  std::optional<accuracy::LatticeChoice> accuracy;  ///< what --accuracy chose
  Json adaptive;                                    ///< of --adaptive, else null
};

/// "lattice: 400 x 300 x 100 voxels of ..., 100 layers, 30000 rays"
[[nodiscard]] std::string lattice_text(const LayerPlan& plan);
/// {"origin","pitch","size"}
[[nodiscard]] Json grid_json(const Grid& grid);

/// The object of docs/command.md.
[[nodiscard]] Json slice_json(const SliceOutcome& outcome);
/// The same for people: solids, materials, overlaps, doubts, outputs.
[[nodiscard]] std::string slice_text(const SliceOutcome& outcome);
[[nodiscard]] Json timing_json(const Timing& timing);

/// Largest resident memory of this process so far, bytes.
[[nodiscard]] long long peak_memory();

}  // namespace lamella::apps
