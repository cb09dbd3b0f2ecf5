#include "slicing/reference/reference_engine.h"

#include <cmath>

#include "core/error.h"
#include "core/parallel.h"
#include "slicing/reference/closed_cast.h"
#include "slicing/reference/solid_model.h"

namespace lamella {

namespace {

reference::CastScratch& scratch_of_this_thread() {
  thread_local reference::CastScratch scratch;
  return scratch;
}

void check(const ReferenceOptions& options) {
  if (!(options.tolerance > 0.0 && std::isfinite(options.tolerance))) {
    throw UsageError("the solver's tolerance must be a positive number of mm", "--tolerance");
  }
  if (!(options.subdivision > 0.0 && std::isfinite(options.subdivision))) {
    throw UsageError("the subdivision factor must be a positive number of mm", "--subdivision");
  }
}

void check(const Ray& ray) {
  if (!ray.origin.allFinite() || !(std::abs(ray.direction.norm() - 1.0) < 1e-9)) {
    throw GeometryError("a ray needs a finite origin and a direction of unit length");
  }
}

std::vector<SolidId> all_solids(const Scene& scene) {
  std::vector<SolidId> solids;
  for (const SolidId solid : scene.solids.ids()) solids.push_back(solid);
  return solids;
}

}  // namespace

struct ReferenceEngine::Data {
  std::vector<std::unique_ptr<reference::SolidModel>> solids;  ///< by id; null for one that is empty or not asked for
};

ReferenceEngine::ReferenceEngine(const Scene& scene, const ReferenceOptions& options, const Progress& progress,
                                 int threads)
    : ReferenceEngine(scene, all_solids(scene), options, progress, threads) {}

ReferenceEngine::ReferenceEngine(const Scene& scene, std::span<const SolidId> solids, const ReferenceOptions& options,
                                 const Progress& progress, int threads) {
  check(options);
  auto data = std::make_unique<Data>();
  data->solids.resize(scene.solids.size());
  std::atomic<std::size_t> done = 0;
  parallel_for(
      solids.size(),
      [&](std::size_t index) {
        progress.throw_if_cancelled();
        const SolidId solid = solids[index];
        if (scene.solids[solid].info.status != SolidStatus::empty) {
          data->solids[solid.value()] = std::make_unique<reference::SolidModel>(scene, solid, options);
        }
        progress.report("refining", static_cast<double>(++done) / static_cast<double>(solids.size()));
      },
      threads);
  data_ = std::move(data);
}

ReferenceEngine::~ReferenceEngine() = default;
ReferenceEngine::ReferenceEngine(ReferenceEngine&&) noexcept = default;

void ReferenceEngine::find_hits(const Ray& ray, SolidId solid, std::vector<Hit>& hits, CastCounters& counters) const {
  check(ray);
  hits.clear();
  const reference::SolidModel* model = data_->solids[solid.value()].get();
  if (model == nullptr || !model->meets_box(ray)) return;
  ++counters.rays;
  reference::CastScratch& scratch = scratch_of_this_thread();
  model->find_crossings(ray, scratch, counters);
  for (const reference::Crossing& crossing : scratch.crossings) {
    hits.push_back({crossing.t, solid, model->face_id(crossing.face), crossing.sense, crossing.flags, crossing.uv});
  }
}

void ReferenceEngine::cast(const Ray& ray, const Vec3& up, SolidId solid, SolidCast& out,
                           CastCounters& counters) const {
  check(ray);
  const reference::SolidModel* model = data_->solids[solid.value()].get();
  if (model == nullptr) {
    out = {solid, {}, {}};
    return;
  }
  cast_closed(*model, solid, ray, up, scratch_of_this_thread(), out, counters);
}

void ReferenceEngine::cast_all(const Ray& ray, const Vec3& up, std::vector<SolidCast>& out,
                               CastCounters& counters) const {
  std::size_t used = 0;
  for (std::size_t index = 0; index < data_->solids.size(); ++index) {
    if (data_->solids[index] == nullptr || !data_->solids[index]->meets_box(ray)) continue;
    if (used == out.size()) out.emplace_back();
    cast(ray, up, SolidId{index}, out[used++], counters);
  }
  out.resize(used);
}

}  // namespace lamella
