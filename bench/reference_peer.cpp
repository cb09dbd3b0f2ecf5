#include "bench/exact_peers.h"
#include "slicing/reference/reference_engine.h"

namespace lamella::bench {
namespace {

struct FoundRow {
  std::int32_t layer;
  std::int32_t row;
  SolidId solid;
  std::vector<double> x;
};

class ReferencePeer : public Peer {
 public:
  ReferencePeer(const ExactModel& model, const Lattice& lattice) : model_(model), lattice_(lattice) {}

  void prepare() override {
    engine_ = std::make_unique<ReferenceEngine>(model_.scene, ReferenceOptions{}, Progress{}, 1);
  }

  void cast(const Batch& batch) override {
    found_.clear();
    counters_ = {};
    for (std::int32_t layer = batch.first_layer; layer < batch.last_layer; ++layer) {
      for (const std::int32_t row : batch.rows) cast_row(layer, row);
    }
  }

  void visit(const RowVisitor& visitor) const override {
    for (const FoundRow& row : found_) visitor(row.solid.value(), row.layer, row.row, row.x);
  }

  [[nodiscard]] CastCounters counters() const override { return counters_; }

  [[nodiscard]] bool casts_single_rows() const override { return true; }

 private:
  void cast_row(std::int32_t layer, std::int32_t row) {
    const Ray ray{{0.0, lattice_.y(row), lattice_.z(layer)}, Vec3::UnitX()};
    engine_->cast_all(ray, Vec3::UnitZ(), casts_, counters_);
    for (const SolidCast& cast : casts_) {
      if (cast.spans.empty()) continue;
      FoundRow& found = found_.emplace_back(FoundRow{layer, row, cast.solid, {}});
      for (const Span& span : cast.spans) found.x.insert(found.x.end(), {span.begin, span.end});
    }
  }

  const ExactModel& model_;
  Lattice lattice_;
  std::unique_ptr<ReferenceEngine> engine_;
  std::vector<SolidCast> casts_;
  CastCounters counters_;
  std::vector<FoundRow> found_;
};

}  // namespace

std::unique_ptr<Peer> make_reference_peer(const ExactModel& model, const Lattice& lattice) {
  return std::make_unique<ReferencePeer>(model, lattice);
}

}  // namespace lamella::bench
