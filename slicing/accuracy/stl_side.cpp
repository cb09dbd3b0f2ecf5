#include "slicing/accuracy/stl_side.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "core/atomic_file.h"
#include "core/parallel.h"
#include "core/xml.h"
#include "model/nearest_point.h"
#include "slicing/accuracy/mesh_caster.h"
#include "slicing/accuracy/process.h"
#include "slicing/accuracy/stl_file.h"

namespace lamella::accuracy {

namespace {

/// OpenCASCADE's mesher was measured to take up to 1.6 kB a triangle on fine meshes of the shipped data sets.
constexpr double kBytesPerTriangle = 2500.0;
constexpr double kFreeBytes = 1e9;  ///< and that much besides

/// The first mesh to predict others from is this part of the model's size coarse.
constexpr double kFirstProbe = 50.0;
constexpr double kLeastStep = 2.0;  ///< nearer to what is asked for, another mesh tells nothing new

/// What part of the time allowed a mesh may take that is only made to predict another.
constexpr double kProbeTime = 0.25;

/// What is known of a mesh, to predict finer ones.
struct Known {
  double deflection = 0.0;
  double triangles = 0.0;
  double seconds = 0.0;

  /// How many times finer a mesh may be at least within limits: surfaces that bend in both directions have as many
  /// times more triangles, and the mesher's time was measured to grow with up to their square.
  [[nodiscard]] double allowed_ratio(double most_triangles, double most_seconds) const {
    return std::min(most_triangles / std::max(1.0, triangles), std::sqrt(most_seconds / std::max(1e-3, seconds)));
  }
};

std::string millions(double count) {
  return count < 1e5 ? format_double(std::round(count)) : format_double(std::round(count / 1e4) / 100.0) + " million";
}

/// Two digits, for messages.
double round_to_digits(double value) {
  if (!(value > 0.0)) return 0.0;
  const double unit = std::pow(10.0, 1.0 - std::floor(std::log10(value)));
  return std::round(value * unit) / unit;
}

class StlStudy {
 public:
  StlStudy(const Exact& exact, StepShapes& shapes, const StudyOptions& options, const Progress& progress)
      : exact_(exact), shapes_(shapes), options_(options), progress_(progress), nearest_(exact.solids.size()) {
    Box3 box;
    for (const SolidId solid : exact.solids) box.extend(exact.measures[solid].bounds);
    size_ = box.diagonal().norm();
    if (!options.stl) scratch_.emplace();
  }

  StlResult run(double deflection) {
    StlResult result;
    result.deflection = deflection;
    if (reason_.empty()) probe_for(deflection);
    if (reason_.empty()) measure(result);
    result.skipped = reason_;
    return result;
  }

 private:
  [[nodiscard]] Tessellation tessellate(double deflection) const {
    TessellationOptions options;
    options.deflection = deflection;
    options.angle = options_.angle;
    options.in_parallel = count_threads(options_.threads) > 1;
    options.max_triangles = options_.max_triangles;
    options.max_seconds = options_.max_seconds;
    options.max_bytes = kFreeBytes + kBytesPerTriangle * static_cast<double>(options_.max_triangles);
    return shapes_.tessellate(exact_.solids, options, progress_);
  }

  [[nodiscard]] std::string over_triangles(const std::string& more) const {
    return "over " + millions(static_cast<double>(options_.max_triangles)) + " triangles" + more;
  }

  /// Sets the reason if a tessellation was stopped, else learns from it.
  void note(const Tessellation& mesh, double deflection) {
    if (mesh.stopped == "time") {
      reason_ = "tessellating takes over " + format_double(options_.max_seconds) + " s";
    } else if (mesh.stopped == "memory") {
      reason_ = "tessellating takes over " + format_double(kBytesPerTriangle) + " bytes for each of " +
                millions(static_cast<double>(options_.max_triangles)) + " triangles";
    } else if (!mesh.stopped.empty()) {
      reason_ = over_triangles("");
    } else {
      known_ = {deflection, static_cast<double>(mesh.triangles), mesh.seconds};
    }
  }

  /// Makes sure that a tessellation stays within the limits before it is begun, since the mesher rarely asks while it
  /// is busy with one face: by coarser meshes, as few as possible. Sets the reason if it might not.
  void probe_for(double deflection) {
    const auto most = static_cast<double>(options_.max_triangles);
    if (known_.deflection == 0.0) {
      const double first = size_ / kFirstProbe;
      if (deflection >= first) return;
      note(tessellate(first), first);
    }
    while (reason_.empty()) {
      const double ratio = known_.deflection / deflection;
      if (ratio <= known_.allowed_ratio(most, options_.max_seconds)) return;
      const double step = std::min(std::sqrt(ratio), known_.allowed_ratio(most, kProbeTime * options_.max_seconds));
      if (ratio < kLeastStep || step < std::sqrt(kLeastStep)) {
        reason_ = fear();
        return;
      }
      const double middle = known_.deflection / step;
      note(tessellate(middle), middle);
    }
  }

  /// Why a finer mesh than the known one isn't begun.
  [[nodiscard]] std::string fear() const {
    const std::string so_far = " feared: at " + format_double(round_to_digits(known_.deflection)) + " mm there are " +
                               millions(known_.triangles) + " triangles in " +
                               format_double(round_to_digits(known_.seconds)) + " s";
    const bool by_number = static_cast<double>(options_.max_triangles) / known_.triangles <
                           std::sqrt(options_.max_seconds / std::max(1e-3, known_.seconds));
    if (by_number) return over_triangles(so_far);
    return "over " + format_double(options_.max_seconds) + " s of tessellating" + so_far;
  }

  void measure(StlResult& result) {
    const PeakMemory peak;
    Tessellation mesh = tessellate(result.deflection);
    note(mesh, result.deflection);
    if (!reason_.empty()) return;
    result.tessellate_seconds = mesh.seconds;
    result.triangles = mesh.triangles;
    result.faces_without = mesh.faces_without;
    SolidCrossings found(exact_.solids.size());
    std::vector<double> area_errors(exact_.lattice.z.size(), 0.0);
    for (std::size_t s = 0; s < exact_.solids.size(); ++s) {
      progress_.throw_if_cancelled();
      const std::vector<StlTriangle> triangles = through_file(std::exchange(mesh.solids[s], {}), s, result);
      Stopwatch watch;
      MeshCast cast = cast_at_mesh(triangles, exact_.lattice, progress_, options_.threads);
      result.slice_seconds += watch.seconds();
      result.unclosed_rays += cast.unclosed_rays;
      result.errors += compare_crossings(exact_.crossings[s], cast.crossings);
      found[s] = std::move(cast.crossings);
      const double volume = exact_.measures[exact_.solids[s]].volume;
      result.volume_error += std::abs(std::abs(enclosed_volume(triangles)) - volume);
      const auto areas = mesh_section_areas(triangles, exact_.lattice.z, progress_, options_.threads);
      for (std::size_t k = 0; k < areas.size(); ++k)
        area_errors[k] += std::abs(std::abs(areas[k]) - exact_.areas[s][k]);
    }
    result.peak_bytes = peak.bytes();
    sum_areas(area_errors, result);
    measure_distances(found, result);
  }

  /// Writes a solid's mesh and reads it back.
  std::vector<StlTriangle> through_file(const TriangleMesh& mesh, std::size_t solid, StlResult& result) const {
    std::filesystem::path file;
    if (options_.stl) {
      const std::filesystem::path folder = *options_.stl / (format_double(result.deflection) + "mm");
      make_folder(folder);
      file = folder / ("solid_" + std::to_string(exact_.solids[solid].value()) + ".stl");
    } else {
      file = scratch_->path() / "solid.stl";
    }
    Stopwatch watch;
    AtomicFile target(file);
    write_stl(mesh, target.temporary());
    target.commit();
    std::vector<StlTriangle> triangles = read_stl(file);
    result.file_seconds += watch.seconds();
    result.bytes += stl_bytes(triangles.size());
    return triangles;
  }

  void sum_areas(const std::vector<double>& errors, StlResult& result) const {
    double squares = 0.0;
    double exact_squares = 0.0;
    for (std::size_t k = 0; k < errors.size(); ++k) {
      double exact = 0.0;
      for (const std::vector<double>& areas : exact_.areas) exact += areas[k];
      squares += errors[k] * errors[k];
      exact_squares += exact * exact;
      result.area.largest = std::max(result.area.largest, errors[k]);
    }
    const auto layers = static_cast<double>(errors.size());
    result.area.rms = std::sqrt(squares / layers);
    result.section_area = std::sqrt(exact_squares / layers);
  }

  struct Sample {
    std::size_t solid;
    Vec3 point;
  };

  /// Every n-th crossing of all solids.
  [[nodiscard]] std::vector<Sample> choose_samples(const SolidCrossings& found) const {
    std::size_t total = 0;
    for (const Crossings& crossings : found) total += crossings.size();
    std::vector<Sample> samples;
    if (options_.distance_samples == 0) return samples;
    const std::size_t step = std::max<std::size_t>(1, total / options_.distance_samples);
    std::size_t number = step / 2;
    for (std::size_t s = 0; s < found.size(); ++s) {
      for (const Crossing& crossing : found[s]) {
        if (number++ % step != 0) continue;
        samples.push_back(
            {s, Vec3(crossing.x, exact_.lattice.ray_y(crossing.ray), exact_.lattice.ray_z(crossing.ray))});
      }
    }
    return samples;
  }

  void measure_distances(const SolidCrossings& found, StlResult& result) {
    const std::vector<Sample> samples = choose_samples(found);
    for (const Sample& sample : samples) {
      auto& nearest = nearest_[sample.solid];
      if (!nearest) {
        const SolidId solid = exact_.solids[sample.solid];
        nearest = std::make_unique<NearestPoint>(exact_.scene, faces_of(exact_.scene, solid));
      }
    }
    std::vector<double> distances(samples.size());
    parallel_for(
        samples.size(),
        [&](std::size_t i) {
          progress_.throw_if_cancelled();
          const NearestPoint& nearest = *nearest_[samples[i].solid];
          auto near = nearest.find(samples[i].point, 4.0 * result.deflection);
          if (!near) near = nearest.find(samples[i].point);
          distances[i] = near ? near->distance : 0.0;
        },
        options_.threads);
    double squares = 0.0;
    for (const double distance : distances) {
      result.distance.largest = std::max(result.distance.largest, distance);
      squares += distance * distance;
    }
    result.distance_samples = samples.size();
    if (!samples.empty()) result.distance.rms = std::sqrt(squares / static_cast<double>(samples.size()));
  }

  const Exact& exact_;
  StepShapes& shapes_;
  const StudyOptions& options_;
  const Progress& progress_;
  std::optional<ScratchFolder> scratch_;
  std::vector<std::unique_ptr<NearestPoint>> nearest_;
  double size_ = 0.0;
  Known known_;
  std::string reason_;  ///< why this deflection and finer ones are skipped
};

}  // namespace

std::vector<StlResult> study_stl(const Exact& exact, StepShapes& shapes, const StudyOptions& options,
                                 const Progress& progress) {
  std::vector<double> deflections = options.deflections;
  std::sort(deflections.begin(), deflections.end(), std::greater<>());
  deflections.erase(std::unique(deflections.begin(), deflections.end()), deflections.end());
  StlStudy study(exact, shapes, options, progress);
  std::vector<StlResult> results;
  for (const double deflection : deflections) results.push_back(study.run(deflection));
  return results;
}

}  // namespace lamella::accuracy
