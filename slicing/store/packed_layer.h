#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "slicing/layer.h"

namespace lamella {

/// Arrays up to this many bytes lie in their object header, where neither chunks nor compression would pay.
inline constexpr std::size_t kCompactBytes = 1024;
/// Longer ones come in chunks of at most this many elements.
inline constexpr std::size_t kChunkElements = std::size_t{1} << 17;

enum class ElementType { i32, u32, u64, f32, f64 };

/// One array as its bytes will lie in a shard.
struct PackedArray {
  const char* name = nullptr;
  ElementType type = ElementType::u64;
  const char* unit = nullptr;  ///< "1" for counts and ids
  std::size_t count = 0;       ///< elements
  std::size_t chunk = 0;       ///< elements a chunk, the last filled up with zeros; 0: one plain piece, not compressed
  std::vector<std::string> pieces;  ///< the chunks, shuffled and deflated unless the level is 0
};

/// Rows of segments, or contours.
using PackedRows = std::vector<PackedArray>;

/// One layer, ready for its shard.
struct PackedLayer {
  struct Hatch {
    double angle = 0.0;    ///< radians
    double spacing = 0.0;  ///< mm
    std::int64_t first_row = 0;
    PackedRows rows;
  };

  std::uint32_t index = 0;
  double z_bottom = 0.0;  ///< mm
  double z_sample = 0.0;
  double z_top = 0.0;
  PackedRows raster;
  std::optional<Hatch> hatch;
  std::optional<PackedRows> contours;
};

/// Brings a layer into the form in which a shard holds it: nearly all the work of storing it, and none that HDF5 has to
/// do under its lock. Several threads may pack layers at once. `level` is that of deflate, 0 (none) to 9.
[[nodiscard]] PackedLayer pack_layer(const Layer& layer, int level);

}  // namespace lamella
