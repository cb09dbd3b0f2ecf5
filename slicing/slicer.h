#pragma once

#include <span>
#include <vector>

#include "core/progress.h"
#include "materials/material_table.h"
#include "model/measure.h"
#include "model/scene.h"
#include "slicing/layer_plan.h"
#include "slicing/layer_sink.h"
#include "slicing/reference/reference_engine.h"
#include "slicing/report.h"
#include "slicing/slab_engine.h"
#include "slicing/span/span_engine.h"

namespace lamella {

enum class EngineKind {
  span,      ///< scan conversion of exact sections; open solids by the reference engine
  reference  ///< ray by ray
};

struct SliceOptions {
  EngineKind engine = EngineKind::span;
  SpanOptions span;
  ReferenceOptions reference;
  int threads = 0;                      ///< 0: all cores
  bool allow_open = false;              ///< slice open solids too, by winding number
  std::optional<double> gap_tolerance;  ///< mm; default: the touching faces' own, at least kMinGap
  std::optional<Mat3> turn;             ///< by which the scene was turned before, for the record of the build
};

/// What begin() of every sink is told.
[[nodiscard]] BuildInfo make_build_info(const Scene& scene, const MaterialTable& table,
                                        const IdVector<SolidId, SolidMeasure>& measures, const LayerPlan& plan);

/// Whether the reader found the solid closed: what the span engine needs, and a run takes without being asked.
[[nodiscard]] bool is_closed(const SolidInfo& solid);

/// The solids to cut: those with faces and finite bounds that are closed, with `allow_open` the others of them too.
/// Throws InputError that names the solids when none is left.
[[nodiscard]] std::vector<SolidId> choose_solids(const Scene& scene, const IdVector<SolidId, SolidMeasure>& measures,
                                                 bool allow_open);

/// The engine that `options` ask for, prepared for `solids`; the scene must outlive it. Throws GeometryError for
/// surfaces beyond the stated limits, Cancelled when asked.
[[nodiscard]] SlabEngine make_engine(const Scene& scene, const IdVector<SolidId, SolidMeasure>& measures,
                                     std::span<const SolidId> solids, const SliceOptions& options,
                                     const Progress& progress = {});

/// The main job: cuts every layer of `plan`, labels the segments, and hands the layers to `sink` in increasing z.
/// Memory does not grow with the number of layers: two slabs a thread are in it. Same output for any number of threads.
/// Throws InputError when no solid is left to slice or when policy `error` meets an overlap; UsageError when the
/// overlap policy can't be kept on the hatch lattice or the engine can't make the plan's contours; Cancelled when
/// asked. After Cancelled the sink may keep what is finished; after any other error sink.abandon() has been called.
[[nodiscard]] SliceReport slice(const Scene& scene, const MaterialTable& table,
                                const IdVector<SolidId, SolidMeasure>& measures, const LayerPlan& plan,
                                const SliceOptions& options, LayerSink& sink, const Progress& progress = {});

/// The same with any engine that was made for the solids of choose_solids(); of `options` only `threads`,
/// `allow_open`, `gap_tolerance` and `turn` count.
[[nodiscard]] SliceReport slice_with(const SlabEngine& engine, const Scene& scene, const MaterialTable& table,
                                     const IdVector<SolidId, SolidMeasure>& measures, const LayerPlan& plan,
                                     const SliceOptions& options, LayerSink& sink, const Progress& progress = {});

}  // namespace lamella
