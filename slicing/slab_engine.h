#pragma once

#include <functional>
#include <vector>

#include "core/error.h"
#include "core/progress.h"
#include "slicing/reference/reference_engine.h"
#include "slicing/slab.h"

namespace lamella {

/// An engine as the slicer uses it.
struct SlabEngine {
  SlabFunction cut;
  ContourFunction contours;  ///< empty for an engine that can't
  /// Layers a call: kSlabLayers, or 1 for an engine that carries nothing from layer to layer and takes any number.
  std::size_t slab_layers = kSlabLayers;
  std::function<std::vector<Finding>()> findings;  ///< what a user should know, asked after the last slab; may be empty
};

/// The spans of one solid on one horizontal ray, ties decided towards +z. Called from several threads at once; `out` is
/// reused and comes with the previous result in it.
using CastFunction = std::function<void(const Ray& ray, SolidId solid, SolidCast& out, CastCounters& counters)>;

/// A solid to cast rays at, and its finite bounds.
struct RayTarget {
  SolidId solid;
  Box3 bounds;
};

/// An engine that casts ray by ray, each at the targets whose box it meets. Rows of one layer are shared among the
/// threads of the loop that calls it. `cast` is copied, and what it refers to must outlive the engine.
[[nodiscard]] SlabEngine make_ray_engine(CastFunction cast, std::vector<RayTarget> targets,
                                         const Progress& progress = {});

/// An engine for the solids of two engines that have none in common. It makes no contours.
[[nodiscard]] SlabEngine join_engines(SlabEngine first, SlabEngine second);

/// Sorts the spans of a row as SpanRows wants them: by begin, then end, then solid.
void sort_spans(std::span<Span> row);

}  // namespace lamella
