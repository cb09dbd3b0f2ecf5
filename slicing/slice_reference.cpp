#include "slicing/slicer.h"

namespace lamella {

SliceReport slice(const Scene& scene, const MaterialTable& table, const IdVector<SolidId, SolidMeasure>& measures,
                  const LayerPlan& plan, const SliceOptions& options, LayerSink& sink, const Progress& progress) {
  const ReferenceEngine engine(scene, options.reference, progress, options.threads);
  const auto cast = [&engine](const Ray& ray, SolidId solid, SolidCast& out, CastCounters& counters) {
    engine.cast(ray, Vec3::UnitZ(), solid, out, counters);
  };
  return slice_with(cast, scene, table, measures, plan, options, sink, progress);
}

}  // namespace lamella
