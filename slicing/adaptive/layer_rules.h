#pragma once

#include <optional>
#include <string>
#include <vector>

#include "materials/machine.h"
#include "materials/material_table.h"

namespace lamella {

/// What `--adaptive` asks for.
struct AdaptiveOptions {
  double deviation = 0.0;         ///< mm: no layer's extruded section is farther than that from the surface
  std::optional<Interval> range;  ///< mm, of thicknesses; default: the machine's, else 2 to 20 steps
  std::optional<double> step;     ///< mm: thicknesses are multiples of it; default: the machine's, else by `deviation`
  std::optional<Machine> machine;
};

/// What one material asks of layers that have it.
struct MaterialLayers {
  double deviation = 0.0;  ///< mm
  Interval thickness;      ///< mm
};

/// Which thicknesses there are, all multiples of one quantum, and what materials make of them.
struct LayerRules {
  double quantum = 0.0;                  ///< mm
  std::vector<std::size_t> thicknesses;  ///< in quanta, ascending
  IdVector<MaterialId, MaterialLayers> materials;
};

/// Resolves options, the machine's steps and settings, and what the library says of each material: the narrowest range
/// of all counts. Throws UsageError when numbers make no sense or no thickness is left, InputError when a material's
/// range leaves none.
[[nodiscard]] LayerRules layer_rules(const MaterialTable& table, const AdaptiveOptions& options);

}  // namespace lamella
