#include "slicing/accuracy/accuracy_study.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/xml.h"
#include "slicing/accuracy/exact_side.h"
#include "slicing/accuracy/process.h"
#include "slicing/accuracy/stl_side.h"
#include "slicing/slicer.h"

namespace lamella::accuracy {

namespace {

/// Rays of the finest lattice to integrate on that is chosen unasked.
constexpr double kMostRays = 2e6;
/// And of one that was asked for: a few minutes.
constexpr double kMostRaysAsked = 1e8;

Box3 bounds_of(const IdVector<SolidId, SolidMeasure>& measures, const std::vector<SolidId>& solids) {
  Box3 bounds;
  for (const SolidId solid : solids) bounds.extend(measures[solid].bounds);
  return bounds;
}

/// A lattice of one pitch along y and z; x is scanned exactly and its pitch means nothing.
LayerPlan plan_of_pitch(const Box3& bounds, double pitch) {
  PlanOptions options;
  options.layer_height = pitch;
  options.pitch = Vec2(std::max(pitch, bounds.sizes().x() / 1e6), pitch);
  return plan_layers(bounds, options);
}

std::uint64_t file_bytes(const Scene& scene) {
  std::uint64_t bytes = 0;
  for (const SourceFile& file : scene.files) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file.path, error);
    if (!error) bytes += size;
  }
  return bytes;
}

void describe(const Scene& scene, const IdVector<SolidId, SolidMeasure>& measures, StudyResult& result) {
  for (const SolidId solid : result.solids) {
    result.volume += measures[solid].volume;
    result.area += measures[solid].area;
    result.file_tolerance = std::max(result.file_tolerance, scene.solids[solid].info.max_tolerance);
  }
  result.size = bounds_of(measures, result.solids).sizes();
  result.step_bytes = file_bytes(scene);
}

/// 1, 2 and 5 times powers of ten from a twentieth of the size down, five of them, as far as they can be had.
std::vector<double> choose_pitches(const Vec3& size) {
  std::vector<double> pitches;
  const double largest = size.tail<2>().maxCoeff();
  double pitch = std::pow(10.0, std::floor(std::log10(largest / 20.0)));
  for (int count = 0; count < 5; ++count) {
    if (!(pitch > 0.0) || size.y() / pitch * size.z() / pitch > kMostRays) break;
    pitches.push_back(pitch);
    // 10 5 2 1
    const double mantissa = pitch / std::pow(10.0, std::floor(std::log10(pitch * 1.0000001)));
    pitch /= mantissa > 4.0 && mantissa < 6.0 ? 2.5 : 2.0;
  }
  return pitches;
}

LatticeResult integrate_at(const SlabEngine& engine, const IdVector<SolidId, SolidMeasure>& measures,
                           const std::vector<SolidId>& solids, double pitch, const Progress& progress, int threads) {
  const LayerPlan plan = plan_of_pitch(bounds_of(measures, solids), pitch);
  LatticeResult result;
  result.pitch = pitch;
  result.rays = static_cast<std::uint64_t>(plan.grid.size[1]) * plan.layers.size();
  result.surface_bound = 0.5 * std::sqrt(3.0) * pitch;
  const Stopwatch watch;
  const std::vector<double> volumes = integrate(engine, plan, solids, progress, threads);
  result.seconds = watch.seconds();
  for (std::size_t s = 0; s < solids.size(); ++s) {
    const SolidMeasure& measure = measures[solids[s]];
    result.volume_error += std::abs(volumes[s] - measure.volume);
    result.volume_bound += pitch * (measure.abs_normal_area.y() + measure.abs_normal_area.z());
  }
  return result;
}

/// From coarse to fine.
std::vector<LatticeResult> integrate_all(const SlabEngine& engine, const IdVector<SolidId, SolidMeasure>& measures,
                                         const std::vector<SolidId>& solids, std::vector<double> pitches,
                                         const Progress& progress, int threads) {
  std::sort(pitches.begin(), pitches.end(), std::greater<>());
  std::vector<LatticeResult> results;
  for (const double pitch : pitches) {
    progress.report("integrating", static_cast<double>(results.size()) / static_cast<double>(pitches.size()));
    results.push_back(integrate_at(engine, measures, solids, pitch, progress, threads));
  }
  return results;
}

/// Refuses lattices that would take hours, before long work starts.
void check_pitches(const std::vector<double>& pitches, const Vec3& size) {
  for (const double pitch : pitches) {
    const double rays = std::max(1.0, size.y() / pitch) * std::max(1.0, size.z() / pitch);
    if (rays <= kMostRaysAsked) continue;
    throw UsageError("a lattice of pitch " + format_double(pitch) + " mm has more than 1e8 rays on this model",
                     "--pitches", "give coarser ones");
  }
}

/// The pitch that gives about as many rays as asked for over the box.
double pitch_of_rays(const Vec3& size, std::size_t rays) {
  const double area = size.y() * size.z();
  const double along = std::max(size.y(), size.z()) / static_cast<double>(rays);  // all in one row or layer
  return std::max(along, std::sqrt(area / static_cast<double>(rays)));
}

}  // namespace

StudyResult run_study(const Scene& scene, const IdVector<SolidId, SolidMeasure>& measures, StepShapes& shapes,
                      const StudyOptions& options, const Progress& progress) {
  StudyResult result;
  result.solids = choose_solids(scene, measures, false);
  describe(scene, measures, result);
  const std::vector<double> pitches = options.pitches.empty() ? choose_pitches(result.size) : options.pitches;
  check_pitches(pitches, result.size);
  const Box3 bounds = bounds_of(measures, result.solids);
  result.pitch = pitch_of_rays(result.size, options.rays);
  const LayerPlan plan = plan_of_pitch(bounds, result.pitch);

  progress.report("preparing", 0.0);
  SliceOptions slice;
  slice.threads = options.threads;
  Stopwatch prepare;
  const SlabEngine engine = make_engine(scene, measures, result.solids, slice, progress);
  result.direct.prepare_seconds = prepare.seconds();

  progress.report("slicing directly", 0.0);
  Exact exact{scene, measures, result.solids, lattice_of(plan), {}, {}};
  result.rows = exact.lattice.y.size();
  result.layers = exact.lattice.z.size();
  result.direct.rays = exact.lattice.rays();
  Stopwatch cut;
  exact.crossings = cut_exactly(engine, plan, result.solids, result.direct.counters, progress, options.threads);
  result.direct.slice_seconds = cut.seconds();
  for (const Crossings& crossings : exact.crossings) result.direct.hits += crossings.size();

  ask_oracle(scene, measures, result.solids, exact.lattice, exact.crossings, options.oracle_rays, progress,
             options.threads, result.direct);
  ask_occt(shapes, measures, result.solids, exact.lattice, exact.crossings, options, progress, result.direct);
  result.lattices = integrate_all(engine, measures, result.solids, pitches, progress, options.threads);
  exact.areas = exact_section_areas(scene, measures, result.solids, exact.lattice.z, progress, options.threads);
  result.stl = study_stl(exact, shapes, options, progress);
  return result;
}

}  // namespace lamella::accuracy
