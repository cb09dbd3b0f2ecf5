#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/progress.h"
#include "slicing/adaptive/layer_rules.h"
#include "slicing/adaptive/model_slants.h"
#include "slicing/layer_plan.h"

namespace lamella {

/// A flat feature and how layers meet it.
struct MetFeature {
  FlatFeature feature;
  double offset = 0.0;  ///< mm from it to the nearest border of layers, above it positive
  bool is_met = false;  ///< by at most half a quantum
};

struct MaterialDeviation {
  MaterialLayers asked;
  double largest = 0.0;  ///< bound over all layers, mm
  bool is_used = false;  ///< some solid has the material
};

/// Layers whose extruded sections stay within the tolerance of every solid's surface, and how they compare.
struct AdaptivePlan {
  double quantum = 0.0;              ///< mm; every thickness is a multiple of it
  Interval range;                    ///< mm, of the thicknesses that were allowed
  std::vector<LayerSpan> layers;     ///< ascending, contiguous
  std::vector<double> deviations;    ///< bound of each layer, mm
  std::vector<MetFeature> features;  ///< ascending
  IdVector<MaterialId, MaterialDeviation> materials;
  double largest_deviation = 0.0;            ///< mm
  double mean_deviation = 0.0;               ///< mm, over the height
  std::size_t missed = 0;                    ///< features that no border meets
  std::size_t sharp_edges = 0;               ///< of wedges whose tips recede by more than is allowed in whatever layers
  std::vector<ThinLoss> thin;                ///< of each face that has some the worst thin place that layers may lose
  std::optional<std::size_t> greedy_layers;  ///< of the greedy scheme, if it finds layers
  std::size_t greedy_missed = 0;
  std::optional<std::size_t> uniform_layers;  ///< of the thickest uniform layers with no larger deviation
  std::optional<double> uniform_thickness;    ///< mm
};

/// The fewest layers from `bottom` (mm) up over all solids whose deviation from the solids' surfaces is bounded by what
/// each material allows (docs/methods/adaptive-layers.md); among those that miss the fewest flat features by more than
/// half a quantum, horizontal faces and material changes before extrema. Same result for any number of threads.
/// Throws UsageError as layer_rules() does and when there are too many borders; InputError that names the materials and
/// the height where no layer suits; Cancelled when asked.
[[nodiscard]] AdaptivePlan plan_adaptive_layers(const Scene& scene, const MaterialTable& table,
                                                const IdVector<SolidId, SolidMeasure>& measures,
                                                std::span<const SolidId> solids, double bottom,
                                                const AdaptiveOptions& options, const Progress& progress = {},
                                                int threads = 0);

/// Replaces the layers of `plan`; the grid's pitch along z becomes the mean thickness.
void set_layers(LayerPlan& plan, const std::vector<LayerSpan>& layers);

}  // namespace lamella
