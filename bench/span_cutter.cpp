#include <algorithm>

#include "bench/exact_peers.h"

#if LAMELLA_HAS_SPAN_ENGINE
#include "slicing/span/span_engine.h"
#else
#include "slicing/reference/reference_engine.h"
#endif

namespace lamella::bench {

#if LAMELLA_HAS_SPAN_ENGINE
SlabFunction make_cutter(const ExactModel& model) {
  SpanOptions options;
  options.threads = 1;
  const auto engine = std::make_shared<SpanEngine>(model.scene, model.solids, options);
  return [engine](std::span<const LayerRequest> slab, std::span<LayerSpans> out) { engine->cut(slab, out); };
}
#else
/// The reference engine in the place of the span engine: the same result, ray by ray.
SlabFunction make_cutter(const ExactModel& model) {
  const auto engine = std::make_shared<ReferenceEngine>(model.scene, ReferenceOptions{}, Progress{}, 1);
  return [engine](std::span<const LayerRequest> slab, std::span<LayerSpans> out) {
    std::vector<SolidCast> casts;
    for (std::size_t k = 0; k < slab.size(); ++k) {
      const RowLattice& lattice = slab[k].lattices.front();
      out[k].lattices.assign(1, {});
      SpanRows& rows = out[k].lattices.front();
      for (std::int64_t row = lattice.first_row; row < lattice.last_row; ++row) {
        engine->cast_all({{0.0, lattice.position(row), slab[k].z}, Vec3::UnitX()}, Vec3::UnitZ(), casts, out[k].cast);
        for (const SolidCast& cast : casts) rows.spans.insert(rows.spans.end(), cast.spans.begin(), cast.spans.end());
        std::sort(rows.spans.begin() + static_cast<std::ptrdiff_t>(rows.row_start.back()), rows.spans.end(),
                  [](const Span& a, const Span& b) { return a.begin < b.begin; });
        rows.row_start.push_back(rows.spans.size());
      }
    }
  };
}
#endif

}  // namespace lamella::bench
