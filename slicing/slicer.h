#pragma once

#include <functional>

#include "core/progress.h"
#include "materials/material_table.h"
#include "model/measure.h"
#include "model/scene.h"
#include "slicing/layer_plan.h"
#include "slicing/layer_sink.h"
#include "slicing/reference/reference_engine.h"
#include "slicing/report.h"

namespace lamella {

struct SliceOptions {
  ReferenceOptions reference;
  int threads = 0;          ///< 0: all cores
  bool allow_open = false;  ///< slice open solids too, by winding number
};

/// What begin() of every sink is told.
[[nodiscard]] BuildInfo make_build_info(const Scene& scene, const MaterialTable& table,
                                        const IdVector<SolidId, SolidMeasure>& measures, const LayerPlan& plan);

/// What an engine does for the slicer: the spans of one solid on one horizontal ray, ties decided towards +z.
/// Called from several threads at once; `out` is reused and comes with the previous result in it.
using CastFunction = std::function<void(const Ray& ray, SolidId solid, SolidCast& out, CastCounters& counters)>;

/// The main job: cuts every layer of `plan`, labels the segments, and hands the layers to `sink` in increasing z.
/// Memory does not grow with the number of layers. Same output for any number of threads.
/// Throws InputError when no solid is left to slice or when policy `error` meets an overlap; UsageError when the
/// overlap policy can't be kept on the hatch lattice; Cancelled when asked. After Cancelled the sink may keep what is
/// finished; after any other error sink.abandon() has been called.
[[nodiscard]] SliceReport slice(const Scene& scene, const MaterialTable& table,
                                const IdVector<SolidId, SolidMeasure>& measures, const LayerPlan& plan,
                                const SliceOptions& options, LayerSink& sink, const Progress& progress = {});

/// The same with any engine.
[[nodiscard]] SliceReport slice_with(const CastFunction& cast, const Scene& scene, const MaterialTable& table,
                                     const IdVector<SolidId, SolidMeasure>& measures, const LayerPlan& plan,
                                     const SliceOptions& options, LayerSink& sink, const Progress& progress = {});

}  // namespace lamella
