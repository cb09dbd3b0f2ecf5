#include "slicing/store/layer_digest.h"

#include <bit>
#include <concepts>
#include <span>
#include <vector>

#include "core/sha256.h"

namespace lamella {

namespace {

/// Feeds numbers to a digest as little-endian bytes, in blocks.
class DigestStream {
 public:
  void put(std::unsigned_integral auto value) {
    for (std::size_t i = 0; i < sizeof(value); ++i) bytes_.push_back(static_cast<std::byte>((value >> (8 * i)) & 0xFF));
    if (bytes_.size() >= kBlock) flush();
  }
  void put(double value) { put(std::bit_cast<std::uint64_t>(value)); }

  std::string finish() {
    flush();
    return sha_.finish();
  }

 private:
  static constexpr std::size_t kBlock = 1 << 16;

  void flush() {
    sha_.update(bytes_);
    bytes_.clear();
  }

  Sha256 sha_;
  std::vector<std::byte> bytes_;
};

void put_rows(DigestStream& stream, const SegmentRows& rows) {
  stream.put(static_cast<std::uint64_t>(rows.rows()));
  for (const std::uint64_t start : rows.row_start) stream.put(start);
  for (const Segment& segment : rows.segments) {
    stream.put(segment.x_begin);
    stream.put(segment.x_end);
    stream.put(segment.material.value());
    stream.put(segment.solid.value());
  }
}

}  // namespace

std::string digest_of(const Layer& layer) {
  DigestStream stream;
  stream.put(layer.index);
  stream.put(layer.z_bottom);
  stream.put(layer.z_sample);
  stream.put(layer.z_top);
  put_rows(stream, layer.raster);
  stream.put(static_cast<std::uint32_t>(layer.hatch ? 1 : 0));
  if (layer.hatch) {
    stream.put(layer.hatch->angle);
    stream.put(layer.hatch->spacing);
    stream.put(static_cast<std::uint64_t>(layer.hatch->first_row));
    put_rows(stream, layer.hatch->rows);
  }
  return stream.finish();
}

}  // namespace lamella
