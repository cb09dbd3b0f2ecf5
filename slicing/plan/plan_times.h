#pragma once

#include <optional>

#include "materials/material_table.h"
#include "slicing/plan/layer_statistics.h"

namespace lamella {

/// What laying materials down takes on a machine (docs/methods/build-plan.md, Time).
class LayingTimes {
 public:
  /// `materials` are the build's; the machine must outlive it.
  LayingTimes(const Machine& machine, const IdVector<MaterialId, Material>& materials);

  /// s that the tool takes for one of the materials of a layer that was measured for this machine. The layer's overhead
  /// isn't in it.
  [[nodiscard]] double seconds(const LayerStatistics& layer, const MaterialStatistics& one, ToolId tool) const;

  [[nodiscard]] const MaterialSettings& settings(MaterialId material) const { return settings_[material]; }

 private:
  [[nodiscard]] double of_sweeps(const LayerStatistics& layer, const MaterialStatistics& one, ToolId tool) const;
  [[nodiscard]] double of_exposure(const LayerStatistics& layer, const MaterialStatistics& one) const;

  const Machine& machine_;
  IdVector<MaterialId, MaterialSettings> settings_;
  IdVector<MaterialId, Paces> paces_;
};

/// Price of a volume in mm^3; nothing when the price, or a density that it needs, is unknown.
[[nodiscard]] std::optional<double> price_of(double volume, const std::optional<double>& price, PriceUnit per,
                                             const std::optional<double>& density);

}  // namespace lamella
