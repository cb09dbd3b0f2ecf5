#pragma once

#include <optional>
#include <string>
#include <vector>

#include "materials/machine.h"
#include "materials/material_table.h"

namespace lamella {

/// What `--adaptive` asks for.
struct AdaptiveOptions {
  double deviation = 0.0;         ///< mm, positive: no layer's extruded section is farther than that from the surface
  std::optional<Interval> range;  ///< mm, of thicknesses; default: the machine's, else 2 to 20 steps
  std::optional<double> step;     ///< mm: thicknesses are multiples of it; default: the machine's, else by `deviation`
  std::optional<Machine> machine;
};

/// What one material asks of layers that have it.
struct MaterialLayers {
  double deviation = 0.0;          ///< mm
  std::vector<Interval> ranges;    ///< mm, of thicknesses: ascending, apart; several where tools leave a gap
  std::vector<std::string> tools;  ///< of the machine that can hold it, if they are why there is no more

  /// From the least to the largest thickness, mm.
  [[nodiscard]] Interval thickness() const { return {ranges.front().lo, ranges.back().hi}; }
  [[nodiscard]] bool takes(double height) const;
};

/// "0.05 to 0.1 or 0.2 to 0.3 mm (tools 'fine', 'coarse')", to a nanometre.
[[nodiscard]] std::string thickness_text(const MaterialLayers& layers);

/// Which thicknesses there are, all multiples of one quantum, and what materials make of them.
struct LayerRules {
  double quantum = 0.0;                  ///< mm
  std::vector<std::size_t> thicknesses;  ///< in quanta, ascending
  IdVector<MaterialId, MaterialLayers> materials;
};

/// Resolves options, the machine's steps and settings, and what the library says of each material: the narrowest range
/// of all counts, within what the machine's tools that can hold the material lay (those that can hold each component of
/// a graded one). Throws UsageError when numbers make no sense or no thickness is left, InputError when a material that
/// some solid has is left none or no tool can hold it.
[[nodiscard]] LayerRules layer_rules(const MaterialTable& table, const AdaptiveOptions& options);

}  // namespace lamella
