#include "bench/curves.h"

#include <atomic>
#include <chrono>
#include <cstdio>
#include <limits>
#include <thread>

#include "bench/child.h"
#include "bench/exact_peers.h"
#include "core/parallel.h"

namespace lamella::bench {
namespace {

using Json = nlohmann::json;

constexpr std::int32_t kLayerCounts[] = {50, 100, 200, 500, 1000, 2000, 4000};
constexpr std::int32_t kRowCounts[] = {100, 200, 500, 1000, 2000, 4000, 8000};

struct Cost {
  double wall = std::numeric_limits<double>::max();
  double cpu = std::numeric_limits<double>::max();
  std::uint64_t hits = 0;
};

/// Cuts one slab and gives its crossings.
std::uint64_t cut_slab(const SlabFunction& cut, const Lattice& lattice, std::size_t slab) {
  std::vector<LayerRequest> requests;
  const std::size_t last = std::min((slab + 1) * kSlabLayers, static_cast<std::size_t>(lattice.layers));
  for (std::size_t layer = slab * kSlabLayers; layer < last; ++layer) {
    requests.push_back({layer, lattice.z(static_cast<std::int32_t>(layer)), {row_lattice(lattice)}});
  }
  std::vector<LayerSpans> spans(requests.size());
  cut(requests, spans);
  std::uint64_t hits = 0;
  for (const LayerSpans& layer : spans) hits += 2 * layer.lattices.front().spans.size();
  return hits;
}

/// The least of some repeats of the whole lattice.
Cost cut_all(const SlabFunction& cut, const Lattice& lattice, int threads, const CurveOptions& options) {
  const std::size_t slabs = (static_cast<std::size_t>(lattice.layers) + kSlabLayers - 1) / kSlabLayers;
  Cost least;
  for (int repeat = 0; repeat < options.repeats; ++repeat) {
    std::atomic<std::uint64_t> hits = 0;
    const auto cast = [&](std::size_t slab) { hits += cut_slab(cut, lattice, slab); };
    const double cpu = cpu_seconds();
    const auto start = std::chrono::steady_clock::now();
    if (threads == 1) {
      for (std::size_t slab = 0; slab < slabs; ++slab) cast(slab);
    } else {
      parallel_for(slabs, cast, threads);
    }
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    least.wall = std::min(least.wall, wall.count());
    least.cpu = std::min(least.cpu, cpu_seconds() - cpu);
    least.hits = hits;
    if (least.cpu * (repeat + 2) > options.budget) break;
  }
  return least;
}

Json point(const char* name, std::int32_t value, const Cost& cost) {
  return {
      {name, value}, {"wall_s", cost.wall}, {"cpu_s", cost.cpu}, {"hits", cost.hits}, {"peak_mib", peak_mebibytes()}};
}

/// One curve: the lattice of each value, on one thread, until a point is over the budget.
template <class MakeLattice>
Json curve(const SlabFunction& cut, const char* name, std::span<const std::int32_t> values, MakeLattice make,
           const CurveOptions& options) {
  Json points = Json::array();
  double last = 0.0;
  for (const std::int32_t value : values) {
    if (last > 0.5 * options.budget) break;  // the next has twice the work or more
    const Cost cost = cut_all(cut, make(value), 1, options);
    points.push_back(point(name, value, cost));
    last = cost.cpu;
  }
  return points;
}

Json curves_of(const ExactModel& model, const CurveOptions& options) {
  const double start = cpu_seconds();
  const SlabFunction cut = make_cutter(model);
  Json result;
  result["prepare_s"] = cpu_seconds() - start;
  result["layers"] = curve(
      cut, "layers", kLayerCounts, [&](std::int32_t n) { return make_lattice(model.bounds, options.rows, n); },
      options);
  result["rows"] = curve(
      cut, "rows", kRowCounts, [&](std::int32_t n) { return make_lattice(model.bounds, n, options.layers); }, options);
  result["threads"] = Json::array();
  const Lattice lattice = make_lattice(model.bounds, options.rows, options.layers);
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  for (int threads = 1; threads <= cores; ++threads) {
    result["threads"].push_back(point("threads", threads, cut_all(cut, lattice, threads, options)));
  }
  return result;
}

}  // namespace

Json measure_curves(const std::filesystem::path& file, const CurveOptions& options) {
  std::fprintf(stderr, "%s: curves\n", file.filename().c_str());
  const ExactModel model = read_model(file.string());
  Json report{{"file", file.filename().string()},
              {"solids", model.solids.size()},
              {"faces", model.scene.faces.size()},
              {"fixed_rows", options.rows},
              {"fixed_layers", options.layers}};
  // In a process of its own, which may start threads.
  if (const auto answer = run_in_child([&] { return curves_of(model, options).dump(); }, 0)) {
    report.update(Json::parse(*answer));
  } else {
    report["failed"] = true;
  }
  return report;
}

}  // namespace lamella::bench
