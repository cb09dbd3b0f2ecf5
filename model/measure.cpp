#include "model/measure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <tuple>
#include <vector>

#include "core/parallel.h"
#include "model/bounds.h"
#include "model/face_integration.h"
#include "model/instances.h"

namespace lamella {

namespace {

std::vector<FaceId> faces_of(const Scene& scene, const Solid& solid) {
  std::vector<FaceId> faces;
  for (const ShellId shell : solid.shells) {
    for (const FaceId face : scene.shells[shell].faces) faces.push_back(face);
  }
  return faces;
}

Vec3 offset_between(const Scene& scene, SolidId from, SolidId to) {
  return scene.solids[to].info.instance->shift - scene.solids[from].info.instance->shift;
}

/// For each solid the one that it is a shifted copy of, itself if none. Which of the copies that is depends on where
/// they lie, not on ids.
std::vector<SolidId> originals(const Scene& scene) {
  using Body = std::tuple<std::size_t, std::size_t, std::array<double, 9>>;
  std::map<Body, std::vector<SolidId>> bodies;
  std::vector<SolidId> original;
  for (const SolidId id : scene.solids.ids()) {
    original.push_back(id);
    const SolidInfo& info = scene.solids[id].info;
    if (!info.instance) continue;
    std::array<double, 9> turn{};
    std::copy_n(info.instance->turn.data(), turn.size(), turn.begin());
    bodies[{info.file, info.instance->body, turn}].push_back(id);
  }
  const auto place = [&](SolidId id) {
    const Vec3& shift = scene.solids[id].info.instance->shift;
    return std::tuple(shift.z(), shift.y(), shift.x());
  };
  for (const auto& [body, solids] : bodies) {
    const SolidId first =
        *std::min_element(solids.begin(), solids.end(), [&](SolidId a, SolidId b) { return place(a) < place(b); });
    for (const SolidId id : solids) {
      if (is_shifted(scene, first, id, offset_between(scene, first, id))) original[id.value()] = first;
    }
  }
  return original;
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
  const std::vector<SolidId> original = originals(scene);
  std::vector<SolidId> to_measure;
  for (const SolidId id : scene.solids.ids())
    if (original[id.value()] == id) to_measure.push_back(id);
  std::atomic<std::size_t> done{0};
  parallel_for(
      to_measure.size(),
      [&](std::size_t i) {
        progress.throw_if_cancelled();
        measures[to_measure[i]] = measure_solid(scene, to_measure[i]);
        progress.report("measuring", static_cast<double>(++done) / static_cast<double>(to_measure.size()));
      },
      threads);
  for (const SolidId id : scene.solids.ids()) {
    const SolidId from = original[id.value()];
    if (from == id) continue;
    measures[id] = measures[from];
    if (!measures[id].bounds.isEmpty()) measures[id].bounds.translate(offset_between(scene, from, id));
  }
  return measures;
}

}  // namespace lamella
