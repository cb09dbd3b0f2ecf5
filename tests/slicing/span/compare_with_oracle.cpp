// The span engine against the certified reference engine on random rows.
//   compare_with_oracle FILE... [--rows N] [--layers N] [--angle DEGREES] [--samples N]
// One line a file: rays, hits, unclosed, doubtful, spans that differ, largest difference, hits a second.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "model/measure.h"
#include "model/step/read_step.h"
#include "slicing/reference/reference_engine.h"
#include "slicing/span/span_engine.h"

using namespace lamella;

namespace {

struct Options {
  std::vector<std::string> files;
  std::size_t rows = 1000;
  std::size_t layers = 100;
  double angle = 0.0;
  std::size_t samples = 200;
};

double seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::vector<std::pair<double, double>> merged(std::vector<std::pair<double, double>> spans, double slack) {
  std::sort(spans.begin(), spans.end());
  std::vector<std::pair<double, double>> out;
  for (const auto& s : spans) {
    if (s.second - s.first <= slack) continue;
    if (!out.empty() && s.first <= out.back().second + slack) {
      out.back().second = std::max(out.back().second, s.second);
    } else {
      out.push_back(s);
    }
  }
  return out;
}

void compare(const std::string& file, const Options& options) {
  const std::vector<std::filesystem::path> paths{file};
  const Scene scene = read_step(paths);
  std::vector<SolidId> solids;
  Box3 box;
  IdVector<SolidId, SolidMeasure> measures = measure_solids(scene);
  for (const SolidId id : scene.solids.ids()) {
    if (!scene.solids[id].info.closed || scene.solids[id].info.status != SolidStatus::ok) continue;
    solids.push_back(id);
    box.extend(measures[id].bounds);
  }
  if (solids.empty()) {
    std::printf("%s: no closed solid\n", file.c_str());
    return;
  }
  const auto start = seconds();
  const auto wall = std::chrono::steady_clock::now();
  const SpanEngine engine(scene, solids, {1e-7, 1});
  const double prepared = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count();
  (void)start;
  const double t = options.angle * kPi / 180.0;
  RowLattice lattice;
  if (options.angle != 0.0) {
    lattice.along = Vec2(std::cos(t), std::sin(t));
    lattice.across = Vec2(-std::sin(t), std::cos(t));
  }
  double lo = 1e300, hi = -1e300;
  for (int i = 0; i < 4; ++i) {
    const Vec2 corner(i & 1 ? box.max().x() : box.min().x(), i & 2 ? box.max().y() : box.min().y());
    lo = std::min(lo, lattice.across.dot(corner));
    hi = std::max(hi, lattice.across.dot(corner));
  }
  lattice.anchor = lo;
  lattice.spacing = (hi - lo) / static_cast<double>(options.rows);
  lattice.first_row = 0;
  lattice.last_row = static_cast<std::int64_t>(options.rows);
  std::vector<LayerRequest> requests;
  const double dz = box.sizes().z() / static_cast<double>(options.layers);
  for (std::size_t k = 0; k < options.layers; ++k) {
    requests.push_back({k, box.min().z() + (static_cast<double>(k) + 0.5) * dz, {lattice}});
  }
  std::vector<LayerSpans> out(requests.size());
  const int repeats = getenv("REPEAT") ? atoi(getenv("REPEAT")) : 1;
  double cpu = 1e9;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    for (auto& layer : out) layer = {};
    const double before = seconds();
    for (std::size_t k = 0; k < requests.size(); k += kSlabLayers) {
      const std::size_t n = std::min(kSlabLayers, requests.size() - k);
      engine.cut(std::span(requests).subspan(k, n), std::span(out).subspan(k, n));
    }
    cpu = std::min(cpu, seconds() - before);
  }
  CastCounters counters;
  IdVector<SolidId, double> volumes(scene.solids.size(), 0.0);
  for (const LayerSpans& layer : out) {
    counters += layer.cast;
    for (const Span& span : layer.lattices[0].spans)
      volumes[span.solid] += (span.end - span.begin) * lattice.spacing * dz;
  }
  double worst_volume = 0.0;
  for (const SolidId id : solids) {
    const SolidMeasure& m = measures[id];
    const double bound = lattice.spacing * m.abs_normal_area.head<2>().norm() + dz * m.abs_normal_area.z();
    worst_volume = std::max(worst_volume, std::abs(volumes[id] - m.volume) / bound);
  }
  std::printf(
      "%s: solids %zu prepare %.2fs cut %.3fs hits %zu (%.2f M/s) unclosed %zu doubtful %zu repaired %zu volume/bound "
      "%.3f",
      file.c_str() + file.rfind('/') + 1, solids.size(), prepared, cpu, static_cast<std::size_t>(counters.hits),
      counters.hits / cpu * 1e-6, static_cast<std::size_t>(counters.unclosed_rays),
      static_cast<std::size_t>(counters.uncertain_hits), static_cast<std::size_t>(counters.repaired_rays),
      worst_volume);
  std::fflush(stdout);
  if (options.samples > 0) {
    const ReferenceEngine oracle(scene, {}, {}, 2);
    std::mt19937_64 random(7);
    std::size_t solid_rays = 0, different = 0, zone = 0;
    double worst = 0.0;
    std::vector<SolidCast> casts;
    for (std::size_t i = 0; i < options.samples; ++i) {
      const std::size_t k = random() % requests.size();
      const auto row = static_cast<std::int64_t>(random() % options.rows);
      Ray ray;
      ray.origin << lattice.position(row) * lattice.across, requests[k].z;
      ray.direction << lattice.along, 0.0;
      for (const SolidId id : solids) {
        SolidCast cast;
        CastCounters c;
        oracle.cast(ray, Vec3::UnitZ(), id, cast, c);
        std::vector<std::pair<double, double>> a, b;
        for (const Span& s : cast.spans) a.emplace_back(s.begin, s.end);
        for (const Span& s : out[k].lattices[0].row(static_cast<std::size_t>(row))) {
          if (s.solid == id) b.emplace_back(s.begin, s.end);
        }
        a = merged(a, 1e-5);
        b = merged(b, 1e-5);
        if (a.empty() && b.empty()) continue;
        ++solid_rays;
        if (a.size() != b.size()) {
          if (c.tolerance_rays + c.uncertain_hits > 0) {
            ++zone;
            continue;
          }
          ++different;
          if (different <= 3) {
            std::printf("\n   differs: solid %u z %.9g y %.9g oracle %zu span %zu:", id.value(), requests[k].z,
                        lattice.position(row), a.size(), b.size());
            for (auto& s : a) std::printf(" o[%.6f %.6f]", s.first, s.second);
            for (auto& s : b) std::printf(" s[%.6f %.6f]", s.first, s.second);
          }
          continue;
        }
        for (std::size_t j = 0; j < a.size(); ++j) {
          const double e = std::max(std::abs(a[j].first - b[j].first), std::abs(a[j].second - b[j].second));
          if (e > worst && e > 1e-4)
            std::printf("\n   off %.3g: solid %u z %.9g y %.9g x %.9g %.9g", e, id.value(), requests[k].z,
                        lattice.position(row), b[j].first, b[j].second);
          worst = std::max(worst, e);
        }
      }
    }
    std::printf("\n   oracle: solid-rays %zu different %zu zone %zu worst x %.3g", solid_rays, different, zone, worst);
  }
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--rows")
      options.rows = std::stoul(argv[++i]);
    else if (word == "--layers")
      options.layers = std::stoul(argv[++i]);
    else if (word == "--angle")
      options.angle = std::stod(argv[++i]);
    else if (word == "--samples")
      options.samples = std::stoul(argv[++i]);
    else
      options.files.push_back(word);
  }
  for (const std::string& file : options.files) {
    try {
      compare(file, options);
    } catch (const std::exception& e) {
      std::printf("%s: %s\n", file.c_str(), e.what());
    }
    std::fflush(stdout);
  }
}
