#include "slicing/accuracy/exact_side.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <random>

#include "core/parallel.h"
#include "slicing/compensated_sum.h"
#include "slicing/reference/reference_engine.h"
#include "slicing/span/span_engine.h"

namespace lamella::accuracy {

namespace {

RowLattice row_lattice(const LayerPlan& plan) {
  RowLattice lattice;
  lattice.anchor = plan.grid.origin.y();
  lattice.spacing = plan.grid.pitch.y();
  lattice.last_row = plan.grid.size[1];
  return lattice;
}

constexpr const char* kOracleStage = "asking the certified engine";
constexpr const char* kOcctStage = "asking OpenCASCADE";

/// Place of each solid among those studied, or none.
std::vector<std::size_t> places_of(std::span<const SolidId> solids) {
  std::size_t most = 0;
  for (const SolidId solid : solids) most = std::max<std::size_t>(most, solid.value() + 1);
  std::vector<std::size_t> places(most, 0);
  for (std::size_t i = 0; i < solids.size(); ++i) places[solids[i].value()] = i;
  return places;
}

/// Cuts all layers of a plan, slabs in parallel; take(slab, layer, spans) is called for each layer, for those of one
/// slab in order.
void cut_slabs(const SlabEngine& engine, const LayerPlan& plan, const Progress& progress, int threads,
               const std::function<void(std::size_t, std::size_t, const LayerSpans&)>& take) {
  const RowLattice lattice = row_lattice(plan);
  const std::size_t layers = plan.layers.size();
  const std::size_t slabs = (layers + kSlabLayers - 1) / kSlabLayers;
  parallel_for(
      slabs,
      [&](std::size_t slab) {
        progress.throw_if_cancelled();
        const std::size_t first = slab * kSlabLayers;
        std::vector<LayerRequest> requests;
        for (std::size_t k = first; k < std::min(layers, first + kSlabLayers); ++k) {
          requests.push_back({k, plan.layers[k].z_sample, {lattice}});
        }
        std::vector<LayerSpans> out;
        make_layer_spans(requests, out);
        engine.cut(requests, out);
        for (std::size_t i = 0; i < out.size(); ++i) take(slab, first + i, out[i]);
      },
      threads);
}

std::size_t count_slabs(const LayerPlan& plan) { return (plan.layers.size() + kSlabLayers - 1) / kSlabLayers; }

/// Whether the ray along +x at (y, z) meets a box.
bool meets(const Box3& box, double y, double z) {
  return box.min().y() <= y && y <= box.max().y() && box.min().z() <= z && z <= box.max().z();
}

/// Appends a span to the crossings of its solid; one that begins where the last ended goes on with it.
void append(Crossings& crossings, std::uint32_t ray, double begin, double end) {
  if (!(begin < end)) return;
  if (!crossings.empty() && crossings.back().ray == ray && !(crossings.back().x < begin)) {
    crossings.back().x = std::max(crossings.back().x, end);
    return;
  }
  crossings.push_back({ray, begin});
  crossings.push_back({ray, end});
}

}  // namespace

SolidCrossings cut_exactly(const SlabEngine& engine, const LayerPlan& plan, std::span<const SolidId> solids,
                           CastCounters& counters, const Progress& progress, int threads) {
  const std::vector<std::size_t> places = places_of(solids);
  const auto rows = static_cast<std::size_t>(plan.grid.size[1]);
  std::vector<SolidCrossings> slabs(count_slabs(plan), SolidCrossings(solids.size()));
  std::vector<CastCounters> casts(slabs.size());
  cut_slabs(engine, plan, progress, threads, [&](std::size_t slab, std::size_t layer, const LayerSpans& spans) {
    casts[slab] += spans.cast;
    for (std::size_t row = 0; row < rows; ++row) {
      for (const Span& span : spans.lattices[0].row(row)) {
        append(slabs[slab][places[span.solid.value()]], static_cast<std::uint32_t>(layer * rows + row), span.begin,
               span.end);
      }
    }
  });
  SolidCrossings all(solids.size());
  for (std::size_t slab = 0; slab < slabs.size(); ++slab) {
    counters += casts[slab];
    for (std::size_t s = 0; s < solids.size(); ++s) {
      all[s].insert(all[s].end(), slabs[slab][s].begin(), slabs[slab][s].end());
    }
  }
  return all;
}

std::vector<double> integrate(const SlabEngine& engine, const LayerPlan& plan, std::span<const SolidId> solids,
                              const Progress& progress, int threads) {
  const std::vector<std::size_t> places = places_of(solids);
  std::vector<std::vector<CompensatedSum>> slabs(count_slabs(plan), std::vector<CompensatedSum>(solids.size()));
  cut_slabs(engine, plan, progress, threads, [&](std::size_t slab, std::size_t, const LayerSpans& spans) {
    for (const Span& span : spans.lattices[0].spans) slabs[slab][places[span.solid.value()]].add(span.end - span.begin);
  });
  std::vector<CompensatedSum> lengths(solids.size());
  for (const auto& slab : slabs) {
    for (std::size_t s = 0; s < solids.size(); ++s) lengths[s].add(slab[s].value());
  }
  std::vector<double> volumes;
  for (const CompensatedSum& length : lengths) {
    volumes.push_back(length.value() * plan.grid.pitch.y() * plan.grid.pitch.z());
  }
  return volumes;
}

void ask_oracle(const Scene& scene, const IdVector<SolidId, SolidMeasure>& measures, std::span<const SolidId> solids,
                const RayLattice& lattice, const SolidCrossings& exact, std::size_t count, const Progress& progress,
                int threads, DirectResult& result) {
  if (count == 0) return;
  const auto start = std::chrono::steady_clock::now();
  const ReferenceEngine oracle(scene, solids, {}, progress, threads);
  const std::size_t step = std::max<std::size_t>(1, lattice.rays() / count);
  std::vector<std::uint32_t> rays;
  for (std::size_t ray = step / 2; ray < lattice.rays(); ray += step) rays.push_back(static_cast<std::uint32_t>(ray));
  std::vector<SolidCrossings> found(rays.size(), SolidCrossings(solids.size()));
  std::vector<CastCounters> casts(rays.size());
  std::atomic<std::size_t> done = 0;
  parallel_for(
      rays.size(),
      [&](std::size_t i) {
        progress.throw_if_cancelled();
        progress.report(kOracleStage, static_cast<double>(done++) / static_cast<double>(rays.size()));
        const double y = lattice.ray_y(rays[i]);
        const double z = lattice.ray_z(rays[i]);
        SolidCast cast;
        for (std::size_t s = 0; s < solids.size(); ++s) {
          const Box3& box = measures[solids[s]].bounds;
          if (!meets(box, y, z)) continue;
          oracle.cast({Vec3(0.0, y, z), Vec3::UnitX()}, Vec3::UnitZ(), solids[s], cast, casts[i]);
          for (const Span& span : cast.spans) append(found[i][s], rays[i], span.begin, span.end);
        }
      },
      threads);
  result.oracle_rays = rays.size();
  for (const CastCounters& cast : casts) result.oracle_counters += cast;
  for (std::size_t s = 0; s < solids.size(); ++s) {
    Crossings certified;
    for (const SolidCrossings& ray : found) certified.insert(certified.end(), ray[s].begin(), ray[s].end());
    Crossings direct;
    std::copy_if(exact[s].begin(), exact[s].end(), std::back_inserter(direct),
                 [&](const Crossing& crossing) { return std::binary_search(rays.begin(), rays.end(), crossing.ray); });
    result.errors += compare_crossings(certified, direct);
  }
  result.oracle_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void ask_occt(const StepShapes& shapes, const IdVector<SolidId, SolidMeasure>& measures,
              std::span<const SolidId> solids, const RayLattice& lattice, const SolidCrossings& exact,
              const StudyOptions& options, const Progress& progress, DirectResult& result) {
  // One entry a ray and solid whose box it meets.
  std::vector<std::pair<std::uint32_t, std::size_t>> pairs;
  const std::size_t step = std::max<std::size_t>(1, lattice.rays() / std::max<std::size_t>(1, options.occt_rays));
  for (std::size_t ray = step / 2; ray < lattice.rays() && options.occt_rays > 0; ray += step) {
    for (std::size_t s = 0; s < solids.size(); ++s) {
      const auto number = static_cast<std::uint32_t>(ray);
      if (meets(measures[solids[s]].bounds, lattice.ray_y(number), lattice.ray_z(number)))
        pairs.emplace_back(number, s);
    }
  }
  std::shuffle(pairs.begin(), pairs.end(), std::mt19937(1));
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  for (const auto& [ray, s] : pairs) {
    if (result.occt_rays >= options.occt_rays || seconds() > options.occt_seconds) break;
    progress.report(kOcctStage, static_cast<double>(result.occt_rays) / static_cast<double>(options.occt_rays));
    const Ray line{Vec3(0.0, lattice.ray_y(ray), lattice.ray_z(ray)), Vec3::UnitX()};
    const std::vector<double> depths = shapes.intersect(solids[s], std::span(&line, 1), progress)[0];
    ++result.occt_rays;
    if (depths.size() % 2 != 0) {
      ++result.occt_odd_rays;
      continue;
    }
    Crossings theirs;
    for (const double x : depths) theirs.push_back({ray, x});
    const auto order = [](const Crossing& a, const Crossing& b) { return a.ray < b.ray; };
    const auto [first, last] = std::equal_range(exact[s].begin(), exact[s].end(), Crossing{ray, 0.0}, order);
    result.occt_errors += compare_crossings(theirs, Crossings(first, last));
  }
  result.occt_seconds = seconds();
}

std::vector<std::vector<double>> exact_section_areas(const Scene& scene,
                                                     const IdVector<SolidId, SolidMeasure>& measures,
                                                     std::span<const SolidId> solids,
                                                     const std::vector<double>& heights, const Progress& progress,
                                                     int threads) {
  SpanOptions options;
  options.threads = threads;
  const SpanEngine engine(scene, solids, options, progress);
  std::vector<std::vector<double>> areas(solids.size(), std::vector<double>(heights.size(), 0.0));
  parallel_for(
      solids.size(),
      [&](std::size_t s) {
        progress.throw_if_cancelled();
        const Box3& box = measures[solids[s]].bounds;
        const auto first = std::upper_bound(heights.begin(), heights.end(), box.min().z());
        const auto last = std::lower_bound(first, heights.end(), box.max().z());
        const std::vector<double> found = engine.section_areas(solids[s], std::span(first, last));
        std::copy(found.begin(), found.end(), areas[s].begin() + (first - heights.begin()));
      },
      threads);
  return areas;
}

}  // namespace lamella::accuracy
