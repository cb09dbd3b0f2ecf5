#include "model/measure.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "core/parallel.h"
#include "model/bounds.h"
#include "model/face_integration.h"

namespace lamella {

namespace {

std::vector<FaceId> faces_of(const Scene& scene, const Solid& solid) {
  std::vector<FaceId> faces;
  for (const ShellId shell : solid.shells) {
    for (const FaceId face : scene.shells[shell].faces) faces.push_back(face);
  }
  return faces;
}

}  // namespace

SolidMeasure measure_solid(const Scene& scene, SolidId id, double relative_error) {
  const std::vector<FaceId> faces = faces_of(scene, scene.solids[id]);
  const SurfaceSums sums = integrate_faces(scene, faces, relative_error);
  SolidMeasure measure;
  measure.volume = sums.volume;
  measure.area = sums.area;
  measure.abs_normal_area = sums.abs_normal_area;
  measure.volume_error = sums.volume_error;
  measure.converged = sums.converged;
  for (const FaceId face : faces) {
    const FaceBounds bounds = face_bounds(scene, face);
    measure.bounds.extend(bounds.box);
    measure.converged = measure.converged && bounds.converged;
  }
  return measure;
}

IdVector<SolidId, SolidMeasure> measure_solids(const Scene& scene, const Progress& progress, int threads) {
  IdVector<SolidId, SolidMeasure> measures(scene.solids.size());
  std::atomic<std::size_t> done{0};
  parallel_for(
      scene.solids.size(),
      [&](std::size_t i) {
        progress.throw_if_cancelled();
        measures[SolidId{i}] = measure_solid(scene, SolidId{i});
        progress.report("measuring", static_cast<double>(++done) / static_cast<double>(scene.solids.size()));
      },
      threads);
  return measures;
}

}  // namespace lamella
