#include <memory>
#include <utility>

#include "slicing/copied_engine.h"
#include "slicing/slicer.h"

namespace lamella {

namespace {

SlabEngine make_span_engine(const Scene& scene, std::span<const SolidId> solids, const SliceOptions& options,
                            const Progress& progress) {
  SpanOptions span = options.span;
  span.threads = options.threads;
  const auto engine = std::make_shared<const SpanEngine>(scene, solids, span, progress);
  return {[engine](std::span<const LayerRequest> slab, std::span<LayerSpans> out) { engine->cut(slab, out); },
          [engine](std::span<const LayerRequest> slab, double chord_error, std::span<CutContours> out) {
            engine->add_contours(slab, chord_error, out);
          },
          kSlabLayers, [engine] { return engine->findings(); }};
}

SlabEngine make_reference_engine(const Scene& scene, const IdVector<SolidId, SolidMeasure>& measures,
                                 std::span<const SolidId> solids, const SliceOptions& options,
                                 const Progress& progress) {
  const auto engine =
      std::make_shared<const ReferenceEngine>(scene, solids, options.reference, progress, options.threads);
  std::vector<RayTarget> targets;
  for (const SolidId solid : solids) targets.push_back({solid, measures[solid].bounds});
  const auto cast = [engine](const Ray& ray, SolidId solid, SolidCast& out, CastCounters& counters) {
    engine->cast(ray, Vec3::UnitZ(), solid, out, counters);
  };
  return make_ray_engine(cast, std::move(targets), progress);
}

}  // namespace

SlabEngine make_engine(const Scene& scene, const IdVector<SolidId, SolidMeasure>& measures,
                       std::span<const SolidId> solids, const SliceOptions& options, const Progress& progress) {
  std::vector<SolidId> closed;
  std::vector<SolidId> open;
  for (const SolidId solid : solids) {
    const bool is_for_spans = options.engine == EngineKind::span && is_closed(scene.solids[solid].info);
    (is_for_spans ? closed : open).push_back(solid);
  }
  if (closed.empty()) return make_reference_engine(scene, measures, open, options, progress);
  // An open solid is in no cluster that is copied, but may touch one: clusters are those of all solids.
  SlabEngine engine = make_copied_engine(
      scene, closed, find_copies(scene, measures, solids),
      [&](std::span<const SolidId> some) { return make_span_engine(scene, some, options, progress); });
  if (open.empty()) return engine;
  return join_engines(std::move(engine), make_reference_engine(scene, measures, open, options, progress));
}

SliceReport slice(const Scene& scene, const MaterialTable& table, const IdVector<SolidId, SolidMeasure>& measures,
                  const LayerPlan& plan, const SliceOptions& options, LayerSink& sink, const Progress& progress) {
  const std::vector<SolidId> solids = choose_solids(scene, measures, options.allow_open);
  const SlabEngine engine = make_engine(scene, measures, solids, options, progress);
  return slice_with(engine, scene, table, measures, plan, options, sink, progress);
}

}  // namespace lamella
