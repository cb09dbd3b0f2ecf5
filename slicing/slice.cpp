#include <memory>
#include <string>
#include <utility>
#include <vector>

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

/// Contours of the closed solids, and of each open one on a layer a finding that it has none: without a closed surface
/// its section has no inside that loops could bound, and rows alone don't make one.
ContourFunction contours_but_of(const Scene& scene, const IdVector<SolidId, SolidMeasure>& measures,
                                const std::vector<SolidId>& open, const ContourFunction& of_closed) {
  return [&scene, &measures, open, of_closed](std::span<const LayerRequest> slab, double chord_error,
                                              std::span<CutContours> out) {
    of_closed(slab, chord_error, out);
    for (const SolidId solid : open) {
      const Box3& bounds = measures[solid].bounds;
      for (std::size_t i = 0; i < slab.size(); ++i) {
        if (!(bounds.min().z() <= slab[i].z && slab[i].z <= bounds.max().z())) continue;
        Finding finding;
        finding.solid = scene.solids[solid].info.path;
        finding.what = "on layer " + std::to_string(slab[i].layer) + " it has rows, but no contours: the solid is open";
        finding.hint = "repair it; contours of others keep what it would take of them";
        out[i].findings.push_back(std::move(finding));
      }
    }
  };
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
  ContourFunction contours = contours_but_of(scene, measures, open, engine.contours);
  SlabEngine joined = join_engines(std::move(engine), make_reference_engine(scene, measures, open, options, progress));
  joined.contours = std::move(contours);
  return joined;
}

SliceReport slice(const Scene& scene, const MaterialTable& table, const IdVector<SolidId, SolidMeasure>& measures,
                  const LayerPlan& plan, const SliceOptions& options, LayerSink& sink, const Progress& progress) {
  const std::vector<SolidId> solids = choose_solids(scene, measures, options.allow_open);
  const SlabEngine engine = make_engine(scene, measures, solids, options, progress);
  return slice_with(engine, scene, table, measures, plan, options, sink, progress);
}

}  // namespace lamella
