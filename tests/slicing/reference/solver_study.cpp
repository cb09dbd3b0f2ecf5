/// How often the paper's bisection and Newton's iteration miss or double a hit against the certified solver, by
/// tolerance and subdivision factor; run by hand:
///   solver_study RAYS FILE... > study.csv
/// Each row: solver, tolerance, subdivision (mm), certified hits, missed, doubled, invented, microseconds a solid-ray.
/// A hit is missed if the other solver has none of the same face and sense nearby (3 tolerances over |n.d|), doubled
/// if it has several, invented if the certified solver has none. Rays with a doubtful certified hit are left out.

#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "model/evaluate.h"
#include "model/measure.h"
#include "model/step/read_step.h"
#include "slicing/reference/reference_engine.h"

namespace {

using namespace lamella;
using Clock = std::chrono::steady_clock;

struct Tally {
  std::uint64_t hits = 0;
  std::uint64_t missed = 0;
  std::uint64_t doubled = 0;
  std::uint64_t invented = 0;
  std::uint64_t rays = 0;
  double seconds = 0.0;
};

struct Setting {
  Solver solver;
  double tolerance;
  double subdivision;
};

struct Sample {
  SolidId solid;
  Ray ray;
  std::vector<Hit> hits;
};

std::vector<Sample> certified_samples(const Scene& scene, int rays) {
  const ReferenceEngine engine(scene, {}, {}, 1);
  std::mt19937 random(17);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> normal;
  std::vector<Sample> samples;
  CastCounters counters;
  for (const SolidId solid : scene.solids.ids()) {
    const Box3 box = measure_solid(scene, solid, 1e-3).bounds;
    for (int k = 0; k < rays; ++k) {
      const Vec3 share(unit(random), unit(random), unit(random));
      const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
      Sample sample{solid, {box.min() + box.sizes().cwiseProduct(share), direction}, {}};
      engine.find_hits(sample.ray, solid, sample.hits, counters);
      bool certain = true;
      for (const Hit& hit : sample.hits) certain &= hit.flags == 0;
      if (certain) samples.push_back(std::move(sample));
    }
  }
  return samples;
}

double reach(const Scene& scene, const Hit& hit, const Ray& ray, double tolerance) {
  const Vec3 n = evaluate(scene.faces[hit.face].surface, hit.uv).normal().normalized();
  return 3.0 * tolerance / std::max(1e-3, std::abs(n.dot(ray.direction)));
}

void compare(const Scene& scene, const Sample& sample, const std::vector<Hit>& found, double tolerance, Tally& tally) {
  std::vector<bool> used(found.size(), false);
  for (const Hit& hit : sample.hits) {
    const double allowed = reach(scene, hit, sample.ray, tolerance);
    int matches = 0;
    for (std::size_t k = 0; k < found.size(); ++k) {
      const bool same = found[k].face == hit.face && found[k].sense == hit.sense;
      if (used[k] || !same || std::abs(found[k].t - hit.t) > allowed) continue;
      used[k] = true;
      ++matches;
    }
    ++tally.hits;
    tally.missed += matches == 0 ? 1 : 0;
    tally.doubled += matches > 1 ? 1 : 0;
  }
  for (const bool one : used) tally.invented += one ? 0 : 1;
}

void study(const Scene& scene, const std::vector<Sample>& samples, const Setting& setting, Tally& tally) {
  const ReferenceEngine engine(scene, {setting.solver, setting.tolerance, setting.subdivision}, {}, 1);
  std::vector<Hit> hits;
  CastCounters counters;
  for (const Sample& sample : samples) {
    const Clock::time_point start = Clock::now();
    engine.find_hits(sample.ray, sample.solid, hits, counters);
    tally.seconds += std::chrono::duration<double>(Clock::now() - start).count();
    ++tally.rays;
    compare(scene, sample, hits, setting.tolerance, tally);
  }
}

std::vector<Setting> settings() {
  std::vector<Setting> result;
  for (const Solver solver : {Solver::bisection, Solver::newton}) {
    for (const double tolerance : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
      for (const double subdivision : {1.0, 1e-1, 1e-2, 1e-3}) result.push_back({solver, tolerance, subdivision});
    }
  }
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: solver_study RAYS_PER_SOLID FILE...\n");
    return 1;
  }
  const std::vector<Setting> all = settings();
  std::vector<Tally> tallies(all.size());
  for (int k = 2; k < argc; ++k) {
    const std::filesystem::path file = argv[k];
    const Scene scene = read_step(std::span(&file, 1));
    const std::vector<Sample> samples = certified_samples(scene, std::stoi(argv[1]));
    for (std::size_t s = 0; s < all.size(); ++s) study(scene, samples, all[s], tallies[s]);
  }
  std::printf("solver,tolerance_mm,subdivision_mm,certified_hits,missed,doubled,invented,microseconds_per_ray\n");
  for (std::size_t s = 0; s < all.size(); ++s) {
    const Tally& tally = tallies[s];
    std::printf("%s,%g,%g,%llu,%llu,%llu,%llu,%.1f\n", all[s].solver == Solver::bisection ? "bisection" : "newton",
                all[s].tolerance, all[s].subdivision, static_cast<unsigned long long>(tally.hits),
                static_cast<unsigned long long>(tally.missed), static_cast<unsigned long long>(tally.doubled),
                static_cast<unsigned long long>(tally.invented), 1e6 * tally.seconds / static_cast<double>(tally.rays));
  }
}
