#include <algorithm>
#include <array>
#include <cmath>

#include "bench/mesh_peers.h"
#include "bench/row_buckets.h"
#include "bench/wedges.h"

namespace lamella::bench {
namespace {

constexpr std::int32_t kLayers = 16;  ///< of a slab: one vector of floats

/// Where a wedge lies on each layer of a slab.
struct SlabRuns {
  std::array<float, kLayers> y_a;
  std::array<float, kLayers> x_a;
  std::array<std::int32_t, kLayers> first;
  std::array<std::int32_t, kLayers> last;
};

class DexelSolid {
 public:
  DexelSolid(const SolidMesh& mesh, const Lattice& lattice)
      : wedges_(make_wedges(mesh, lattice)), buckets_(wedges_.first_row, wedges_.last_row, kLayers) {}

  void cast(std::int32_t first_layer, std::int32_t last_layer) {
    activate(first_layer, last_layer);
    do {
      buckets_.clear();
      for (const std::uint32_t wedge : active_) rasterise(wedges_.items[wedge], first_layer, last_layer);
    } while (!buckets_.grow_if_full());
    buckets_.sort();
  }

  void visit(std::size_t solid, const Batch& batch, const RowVisitor& visitor) const {
    buckets_.visit(solid, batch.first_layer, batch.last_layer - batch.first_layer, visitor);
  }

 private:
  /// Keeps in active_ the wedges that the slab meets, in the order of their first layers.
  void activate(std::int32_t first_layer, std::int32_t last_layer) {
    if (first_layer < reached_) {
      active_.clear();
      next_ = 0;
    }
    reached_ = last_layer;
    std::erase_if(active_, [&](std::uint32_t wedge) { return wedges_.items[wedge].last_layer <= first_layer; });
    for (; next_ < wedges_.size && wedges_.items[next_].first_layer < last_layer; ++next_) {
      if (wedges_.items[next_].last_layer > first_layer) active_.push_back(next_);
    }
  }

  /// All layers of the slab at once, also those that the wedge misses: one vector.
  static SlabRuns runs_of(const Wedge& wedge, std::int32_t first_layer) {
    SlabRuns runs;
    for (std::int32_t k = 0; k < kLayers; ++k) {
      const float z = static_cast<float>(first_layer + k);
      const float y_a = wedge.a.y + (z - wedge.a.z) * wedge.a.slope_y;
      const float y_b = wedge.b.y + (z - wedge.b.z) * wedge.b.slope_y;
      runs.y_a[k] = y_a;
      runs.x_a[k] = wedge.a.x + (z - wedge.a.z) * wedge.a.slope_x;
      runs.first[k] = static_cast<std::int32_t>(std::ceil(std::min(y_a, y_b)));
      runs.last[k] = static_cast<std::int32_t>(std::ceil(std::max(y_a, y_b)));
    }
    return runs;
  }

  void rasterise(const Wedge& wedge, std::int32_t first_layer, std::int32_t last_layer) {
    const SlabRuns runs = runs_of(wedge, first_layer);
    const std::int32_t first = std::max(wedge.first_layer, first_layer) - first_layer;
    const std::int32_t last = std::min(wedge.last_layer, last_layer) - first_layer;
    for (std::int32_t k = first; k < last; ++k) {
      buckets_.add(k, {runs.first[k], runs.last[k], runs.y_a[k], runs.x_a[k], wedge.dx_dy});
    }
  }

  Wedges wedges_;
  RowBuckets buckets_;
  std::vector<std::uint32_t> active_;
  std::uint32_t next_ = 0;
  std::int32_t reached_ = 0;
};

class DexelPeer : public Peer {
 public:
  DexelPeer(const ModelMesh& mesh, const Lattice& lattice) : mesh_(mesh), lattice_(lattice) {}

  void prepare() override {
    for (const SolidMesh& solid : mesh_.solids) solids_.emplace_back(solid, lattice_);
  }
  void cast(const Batch& batch) override {
    batch_ = batch;
    for (DexelSolid& solid : solids_) solid.cast(batch.first_layer, batch.last_layer);
  }
  void visit(const RowVisitor& visitor) const override {
    for (std::size_t s = 0; s < solids_.size(); ++s) solids_[s].visit(s, batch_, visitor);
  }
  [[nodiscard]] std::int32_t slab_layers() const override { return kLayers; }

 private:
  const ModelMesh& mesh_;
  Lattice lattice_;
  std::vector<DexelSolid> solids_;
  Batch batch_;
};

}  // namespace

std::unique_ptr<Peer> make_dexel_peer(const ModelMesh& mesh, const Lattice& lattice) {
  return std::make_unique<DexelPeer>(mesh, lattice);
}

}  // namespace lamella::bench
