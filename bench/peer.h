#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "slicing/hit.h"

/// The peers of span_bench: ways to find where the scanlines of a raster lattice cross the solids of one model.
namespace lamella::bench {

/// Scanlines along +x: row m of layer k is y = y0 + (m + 1/2) pitch_y, z = z0 + (k + 1/2) pitch_z. Lengths in mm.
struct Lattice {
  double y0 = 0.0;
  double z0 = 0.0;
  double pitch_y = 1.0;
  double pitch_z = 1.0;
  std::int32_t rows = 0;
  std::int32_t layers = 0;
  Box3 bounds;  ///< of the model

  [[nodiscard]] double y(std::int32_t row) const { return y0 + (row + 0.5) * pitch_y; }
  [[nodiscard]] double z(std::int32_t layer) const { return z0 + (layer + 0.5) * pitch_z; }
};

/// Lays `rows` rows and `layers` layers over the whole of `bounds`.
[[nodiscard]] Lattice make_lattice(const Box3& bounds, std::int32_t rows, std::int32_t layers);

/// What a peer is asked to cast at once.
struct Batch {
  std::int32_t first_layer = 0;
  std::int32_t last_layer = 0;     ///< one past
  std::vector<std::int32_t> rows;  ///< ascending, for slow peers; fast ones cast every row all the same
};

/// Told of the crossings of one solid with one row, ascending. `solid` numbers the solids as the peer meets them.
using RowVisitor =
    std::function<void(std::size_t solid, std::int32_t layer, std::int32_t row, std::span<const double> x)>;

/// One way to do the work. prepare() and cast() are timed, visit() isn't.
class Peer {
 public:
  virtual ~Peer() = default;

  /// Builds whatever does not depend on the batch, from the model as it was read or tessellated.
  virtual void prepare() = 0;

  /// Finds all crossings of a batch, sorted by x per row and solid, and keeps them until the next call.
  virtual void cast(const Batch& batch) = 0;

  /// Shows what the last cast() found. Rows without a crossing need not be shown.
  virtual void visit(const RowVisitor& visitor) const = 0;

  /// What an exact engine says of its own last cast(); nothing from others.
  [[nodiscard]] virtual CastCounters counters() const { return {}; }

  /// Layers to cast at once.
  [[nodiscard]] virtual std::int32_t slab_layers() const { return 16; }

  /// Whether Batch::rows is followed; such peers get random rows instead of whole layers.
  [[nodiscard]] virtual bool casts_single_rows() const { return false; }
};

/// A peer and what it is called in the results. Made only in the process that runs it.
struct PeerEntry {
  std::string name;
  std::string mesh;  ///< key of the tessellation it works on, empty for exact geometry
  std::function<std::unique_ptr<Peer>()> make;
};

}  // namespace lamella::bench
