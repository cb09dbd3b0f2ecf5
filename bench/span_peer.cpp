#include <algorithm>
#include <optional>

#include "bench/exact_peers.h"
#include "materials/material_rules.h"
#include "slicing/combine.h"
#include "slicing/layer.h"
#include "slicing/span/span_engine.h"

namespace lamella::bench {
namespace {

class SpanPeer : public Peer {
 public:
  SpanPeer(const ExactModel& model, const Lattice& lattice, bool combine) : model_(model), lattice_(lattice) {
    if (!combine) return;
    IdVector<SolidId, SolidMeasure> measures(model.scene.solids.size());
    for (const SolidId solid : model.solids) measures[solid] = measure_solid(model.scene, solid, 1e-4);
    table_ = assign_materials(model.scene);
    rules_.emplace();
    rules_->table = &table_;
    rules_->rank = rank_solids(model.scene, table_, measures);
    rules_->widen_at(model.scene.faces);
  }

  void prepare() override { cut_ = make_cutter(model_); }

  void cast(const Batch& batch) override {
    requests_.clear();
    for (std::int32_t layer = batch.first_layer; layer < batch.last_layer; ++layer) {
      requests_.push_back({static_cast<std::size_t>(layer), lattice_.z(layer), {row_lattice(lattice_)}});
    }
    spans_.resize(requests_.size());
    for (LayerSpans& layer : spans_) layer.cast = {};
    cut_(requests_, spans_);
    if (rules_) combine();
  }

  void visit(const RowVisitor& visitor) const override {
    std::vector<Span> spans;
    std::vector<double> x;
    for (std::size_t k = 0; k < requests_.size(); ++k) {
      const SpanRows& rows = spans_[k].lattices.front();
      for (std::size_t r = 0; r < rows.rows(); ++r) {
        spans.assign(rows.row(r).begin(), rows.row(r).end());
        std::stable_sort(spans.begin(), spans.end(), [](const Span& a, const Span& b) { return a.solid < b.solid; });
        for (std::size_t i = 0; i < spans.size();) {
          const SolidId solid = spans[i].solid;
          x.clear();
          for (; i < spans.size() && spans[i].solid == solid; ++i) x.insert(x.end(), {spans[i].begin, spans[i].end});
          visitor(solid.value(), static_cast<std::int32_t>(requests_[k].layer), static_cast<std::int32_t>(r), x);
        }
      }
    }
  }

  [[nodiscard]] CastCounters counters() const override {
    CastCounters sum;
    for (std::size_t k = 0; k < requests_.size(); ++k) sum += spans_[k].cast;
    return sum;
  }

  [[nodiscard]] std::int32_t slab_layers() const override { return kSlabLayers; }

 private:
  /// The segments of each layer, as the slicer keeps them until an exporter has taken them.
  void combine() {
    segments_.resize(spans_.size());
    for (std::size_t k = 0; k < spans_.size(); ++k) {
      const SpanRows& rows = spans_[k].lattices.front();
      segments_[k].segments.clear();
      segments_[k].row_start.assign(1, 0);
      for (std::size_t r = 0; r < rows.rows(); ++r) {
        combiner_.combine(rows.row(r), *rules_, segments_[k].segments);
        segments_[k].row_start.push_back(segments_[k].segments.size());
      }
    }
  }

  const ExactModel& model_;
  Lattice lattice_;
  SlabFunction cut_;
  MaterialTable table_;
  std::optional<CombineRules> rules_;
  std::vector<LayerRequest> requests_;
  std::vector<LayerSpans> spans_;
  std::vector<SegmentRows> segments_;
  RowCombiner combiner_;
};

}  // namespace

SlabFunction make_cutter(const ExactModel& model) {
  SpanOptions options;
  options.threads = 1;
  const auto engine = std::make_shared<const SpanEngine>(model.scene, model.solids, options);
  return [engine](std::span<const LayerRequest> slab, std::span<LayerSpans> out) { engine->cut(slab, out); };
}

RowLattice row_lattice(const Lattice& lattice) {
  RowLattice rows;
  rows.anchor = lattice.y0;
  rows.spacing = lattice.pitch_y;
  rows.last_row = lattice.rows;
  return rows;
}

std::unique_ptr<Peer> make_span_peer(const ExactModel& model, const Lattice& lattice, bool combine) {
  return std::make_unique<SpanPeer>(model, lattice, combine);
}

}  // namespace lamella::bench
