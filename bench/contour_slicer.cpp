#include <algorithm>
#include <cmath>
#include <tuple>

#include "bench/mesh_peers.h"
#include "bench/row_buckets.h"
#include "bench/wedges.h"

namespace lamella::bench {
namespace {

/// The wedges that the sweep is in, copied together, structure of arrays.
class ActiveWedges {
 public:
  void clear() { resize(0); }

  void add(const Wedge& wedge) {
    last_layer.push_back(wedge.last_layer);
    z_a.push_back(wedge.a.z);
    y_a.push_back(wedge.a.y);
    x_a.push_back(wedge.a.x);
    slope_y_a.push_back(wedge.a.slope_y);
    slope_x_a.push_back(wedge.a.slope_x);
    z_b.push_back(wedge.b.z);
    y_b.push_back(wedge.b.y);
    x_b.push_back(wedge.b.x);
    slope_y_b.push_back(wedge.b.slope_y);
    slope_x_b.push_back(wedge.b.slope_x);
  }

  /// Drops those that end at `layer` or below.
  void drop(std::int32_t layer) {
    std::size_t size = last_layer.size();
    for (std::size_t i = 0; i < size;) {
      if (last_layer[i] > layer) {
        ++i;
      } else {
        copy(--size, i);
      }
    }
    resize(size);
  }

  [[nodiscard]] std::size_t size() const { return last_layer.size(); }

  std::vector<std::int32_t> last_layer;
  std::vector<float> z_a, y_a, x_a, slope_y_a, slope_x_a;
  std::vector<float> z_b, y_b, x_b, slope_y_b, slope_x_b;

 private:
  template <class Visit>
  void for_each(Visit visit) {
    for (auto* values : {&z_a, &y_a, &x_a, &slope_y_a, &slope_x_a, &z_b, &y_b, &x_b, &slope_y_b, &slope_x_b}) {
      visit(*values);
    }
  }
  void copy(std::size_t from, std::size_t to) {
    last_layer[to] = last_layer[from];
    for_each([=](std::vector<float>& values) { values[to] = values[from]; });
  }
  void resize(std::size_t size) {
    last_layer.resize(size);
    for_each([=](std::vector<float>& values) { values.resize(size); });
  }
};

/// The segments of one layer as runs of rows, structure of arrays.
struct Segments {
  std::vector<std::int32_t> first, last;
  std::vector<float> y0, x0, slope;

  void resize(std::size_t size) {
    first.resize(size);
    last.resize(size);
    y0.resize(size);
    x0.resize(size);
    slope.resize(size);
  }
};

/// Cuts all active wedges at height z. One loop without branches, for the vectoriser.
void cut(const ActiveWedges& wedges, float z, Segments& out) {
  const std::size_t size = wedges.size();
  if (out.first.size() < size) out.resize(size);
  for (std::size_t i = 0; i < size; ++i) {
    const float y_a = wedges.y_a[i] + (z - wedges.z_a[i]) * wedges.slope_y_a[i];
    const float y_b = wedges.y_b[i] + (z - wedges.z_b[i]) * wedges.slope_y_b[i];
    const float x_a = wedges.x_a[i] + (z - wedges.z_a[i]) * wedges.slope_x_a[i];
    const float x_b = wedges.x_b[i] + (z - wedges.z_b[i]) * wedges.slope_x_b[i];
    out.y0[i] = y_a;
    out.x0[i] = x_a;
    out.slope[i] = (x_b - x_a) / (y_b - y_a);
    out.first[i] = static_cast<std::int32_t>(std::ceil(std::min(y_a, y_b)));
    out.last[i] = static_cast<std::int32_t>(std::ceil(std::max(y_a, y_b)));
  }
}

class ContourSolid {
 public:
  ContourSolid(const SolidMesh& mesh, const Lattice& lattice)
      : wedges_(make_wedges(mesh, lattice)), buckets_(wedges_.first_row, wedges_.last_row, 1) {}

  void cast(std::int32_t layer, Segments& segments) {
    sweep_to(layer);
    cut(active_, static_cast<float>(layer), segments);
    do {
      buckets_.clear();
      for (std::size_t i = 0; i < active_.size(); ++i) {
        buckets_.add(0, {segments.first[i], segments.last[i], segments.y0[i], segments.x0[i], segments.slope[i]});
      }
    } while (!buckets_.grow_if_full());
    buckets_.sort();
  }

  void visit(std::size_t solid, std::int32_t layer, const RowVisitor& visitor) const {
    buckets_.visit(solid, layer, 1, visitor);
  }

 private:
  void sweep_to(std::int32_t layer) {
    if (layer < reached_) {
      active_.clear();
      next_ = 0;
    }
    reached_ = layer;
    active_.drop(layer);
    for (; next_ < wedges_.size && wedges_.items[next_].first_layer <= layer; ++next_) {
      if (wedges_.items[next_].last_layer > layer) active_.add(wedges_.items[next_]);
    }
  }

  Wedges wedges_;
  RowBuckets buckets_;
  ActiveWedges active_;
  std::uint32_t next_ = 0;
  std::int32_t reached_ = 0;
};

class ContourPeer : public Peer {
 public:
  ContourPeer(const ModelMesh& mesh, const Lattice& lattice) : mesh_(mesh), lattice_(lattice) {}

  void prepare() override {
    for (const SolidMesh& solid : mesh_.solids) solids_.emplace_back(solid, lattice_);
  }
  void cast(const Batch& batch) override {
    layer_ = batch.first_layer;
    for (ContourSolid& solid : solids_) solid.cast(layer_, segments_);
  }
  void visit(const RowVisitor& visitor) const override {
    for (std::size_t s = 0; s < solids_.size(); ++s) solids_[s].visit(s, layer_, visitor);
  }
  [[nodiscard]] std::int32_t slab_layers() const override { return 1; }

 private:
  const ModelMesh& mesh_;
  Lattice lattice_;
  std::vector<ContourSolid> solids_;
  Segments segments_;
  std::int32_t layer_ = 0;
};

}  // namespace

std::unique_ptr<Peer> make_contour_peer(const ModelMesh& mesh, const Lattice& lattice) {
  return std::make_unique<ContourPeer>(mesh, lattice);
}

}  // namespace lamella::bench
