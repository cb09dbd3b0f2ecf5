/// Casts a grid of rays through STEP files and prints what closing them took:
///   grid_study ROWS LAYERS [--solver certified|bisection|newton] FILE...
/// One line a file: solids, seconds to read, to prepare and to cast, and the counters of CastCounters.

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/error.h"
#include "model/measure.h"
#include "model/step/read_step.h"
#include "slicing/reference/reference_engine.h"

namespace {

using Clock = std::chrono::steady_clock;
using namespace lamella;

double seconds(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

void study(const std::filesystem::path& file, int rows, int layers, const ReferenceOptions& options) {
  const Clock::time_point start = Clock::now();
  const Scene scene = read_step(std::span(&file, 1));
  const Clock::time_point read = Clock::now();
  const ReferenceEngine engine(scene, options, {}, 1);
  const Clock::time_point prepared = Clock::now();
  CastCounters counters;
  double volume_error = 0.0;
  double measuring = 0.0;
  std::size_t worst = 0;
  for (const SolidId solid : scene.solids.ids()) {
    if (!scene.solids[solid].info.closed) continue;
    const Clock::time_point before_measure = Clock::now();
    const SolidMeasure measure = measure_solid(scene, solid, 1e-6);
    measuring += seconds(before_measure, Clock::now());
    const Box3& box = measure.bounds;
    const double dy = box.sizes().y() / rows;
    const double dz = box.sizes().z() / layers;
    double volume = 0.0;
    SolidCast cast;
    for (int k = 0; k < layers; ++k) {
      for (int j = 0; j < rows; ++j) {
        const Vec3 origin(box.min().x() - 1.0, box.min().y() + (j + 0.5) * dy, box.min().z() + (k + 0.5) * dz);
        const CastCounters before = counters;
        engine.cast({origin, Vec3::UnitX()}, Vec3::UnitZ(), solid, cast, counters);
        for (const Span& span : cast.spans) volume += (span.end - span.begin) * dy * dz;
        if (std::getenv("VERBOSE") != nullptr &&
            (counters.repaired_rays + counters.unclosed_rays > before.repaired_rays + before.unclosed_rays)) {
          std::printf("# bad ray: solid %u y %.17g z %.17g\n", solid.value(), origin.y(), origin.z());
        }
      }
    }
    const double error =
        std::abs(volume - measure.volume) / (measure.abs_normal_area.y() * dy + measure.abs_normal_area.z() * dz);
    if (error > volume_error) {
      volume_error = error;
      worst = solid.value();
    }
  }
  const Clock::time_point end = Clock::now();
  std::printf(
      "%-44s solids %3zu faces %4zu read %5.1f prep %5.2f cast %6.2f rays %7llu hits %7llu tie %6llu tol %6llu rep "
      "%4llu "
      "uncl %4llu uncert %4llu cand %9llu iter %9llu vol %.3f (%zu)\n",
      file.filename().c_str(), scene.solids.size(), scene.faces.size(), seconds(start, read), seconds(read, prepared),
      seconds(prepared, end) - measuring, (unsigned long long)counters.rays, (unsigned long long)counters.hits,
      (unsigned long long)counters.tie_rays, (unsigned long long)counters.tolerance_rays,
      (unsigned long long)counters.repaired_rays, (unsigned long long)counters.unclosed_rays,
      (unsigned long long)counters.uncertain_hits, (unsigned long long)counters.candidates,
      (unsigned long long)counters.iterations, volume_error, worst);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: grid_study ROWS LAYERS [--solver certified|bisection|newton] FILE...\n");
    return 1;
  }
  ReferenceOptions options;
  const int rows = std::stoi(argv[1]);
  const int layers = std::stoi(argv[2]);
  for (int k = 3; k < argc; ++k) {
    const std::string argument = argv[k];
    if (argument == "--solver") {
      const std::string name = argv[++k];
      options.solver = name == "bisection" ? Solver::bisection : name == "newton" ? Solver::newton : Solver::certified;
      continue;
    }
    try {
      study(argument, rows, layers, options);
    } catch (const std::exception& error) {
      std::printf("%-44s ERROR %s\n", std::filesystem::path(argument).filename().c_str(), error.what());
    }
  }
}
