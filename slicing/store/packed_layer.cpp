#include "slicing/store/packed_layer.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <functional>
#include <libdeflate.h>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>

#include "core/error.h"

namespace lamella {

namespace {

static_assert(std::endian::native == std::endian::little, "shards are little-endian");

/// Elements that are shuffled at once: their bytes stay in the nearest cache.
constexpr std::size_t kShuffleBlock = 1024;

/// Bytes from the middle of a plane by which it is judged, and the level at which that costs least.
constexpr std::size_t kSampleBytes = 4096;
constexpr int kSampleLevel = 1;
/// A plane is worth deflating if that takes one byte in this many off the sample.
constexpr std::size_t kWorthwhile = 8;

/// Longest stored block of a deflate stream (RFC 1951, 3.2.4).
constexpr std::size_t kStoredBytes = 65535;

/// HDF5's shuffle: the first bytes of all elements, then the second ones, and so on.
template <class T>
void shuffle(std::span<const T> elements, char* out) {
  const std::size_t count = elements.size();
  for (std::size_t begin = 0; begin < count; begin += kShuffleBlock) {
    const std::size_t end = std::min(begin + kShuffleBlock, count);
    for (std::size_t byte = 0; byte < sizeof(T); ++byte) {
      char* const row = out + byte * count;
      for (std::size_t i = begin; i < end; ++i) row[i] = static_cast<char>(elements[i] >> (8 * byte));
    }
  }
}

/// Compresses shuffled bytes to zlib streams (RFC 1950, 1951).
///
/// The low bytes of a coordinate are noise: five planes of eight on curved bodies, and searching them for repetitions
/// is most of what deflate would do. So the leading planes that a sample finds incompressible go into stored blocks, at
/// the speed of copying. These end on a byte, where the compressor's own blocks for the rest can begin.
class PlaneDeflater {
 public:
  explicit PlaneDeflater(int level) : compressor_(make(level)), sampler_(make(kSampleLevel)) {}

  std::string compress(std::span<const char> planes, std::size_t plane_bytes) {
    const std::size_t noise = noisy_prefix(planes, plane_bytes);
    std::string out("\x78\x01", 2);  // a window of 32 KiB; the checksum of these two bytes
    for (std::size_t begin = 0; begin < noise; begin += kStoredBytes)
      append_stored(planes.subspan(begin, std::min(kStoredBytes, noise - begin)), out);
    const auto rest = deflated(compressor_, planes.subspan(noise));
    out.append(rest.data(), rest.size());
    const std::uint32_t checksum = libdeflate_adler32(1, planes.data(), planes.size());
    for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(checksum >> shift);
    return out;
  }

 private:
  struct Free {
    void operator()(libdeflate_compressor* compressor) const { libdeflate_free_compressor(compressor); }
  };
  using Compressor = std::unique_ptr<libdeflate_compressor, Free>;

  static Compressor make(int level) {
    Compressor compressor(libdeflate_alloc_compressor(level));
    if (!compressor) throw ExportError("out of memory for compression");
    return compressor;
  }

  /// A deflate stream, valid until the next call.
  std::span<const char> deflated(const Compressor& compressor, std::span<const char> bytes) {
    buffer_.resize(libdeflate_deflate_compress_bound(compressor.get(), bytes.size()));
    const std::size_t size =
        libdeflate_deflate_compress(compressor.get(), bytes.data(), bytes.size(), buffer_.data(), buffer_.size());
    return std::span(buffer_).first(size);
  }

  /// Bytes of the leading planes that aren't worth deflating.
  std::size_t noisy_prefix(std::span<const char> planes, std::size_t plane_bytes) {
    if (plane_bytes < kSampleBytes) return 0;
    const std::size_t offset = (plane_bytes - kSampleBytes) / 2;
    std::size_t noise = 0;
    while (noise < planes.size()) {
      const auto sample = planes.subspan(noise + offset, kSampleBytes);
      if (deflated(sampler_, sample).size() < kSampleBytes - kSampleBytes / kWorthwhile) break;
      noise += plane_bytes;
    }
    return noise;
  }

  static void append_stored(std::span<const char> bytes, std::string& out) {
    const auto length = static_cast<std::uint16_t>(bytes.size());
    const auto complement = static_cast<std::uint16_t>(~length);
    out += '\0';  // not the last block, stored
    for (const std::uint16_t number : {length, complement}) {
      out += static_cast<char>(number & 0xFF);
      out += static_cast<char>(number >> 8);
    }
    out.append(bytes.data(), bytes.size());
  }

  Compressor compressor_;
  Compressor sampler_;
  std::vector<char> buffer_;
};

/// Packs the arrays of one layer with memory that is used again.
class Packer {
 public:
  explicit Packer(int level) {
    if (level > 0) deflater_.emplace(level);
  }

  PackedRows pack(const SegmentRows& rows) {
    PackedRows packed;
    packed.push_back(pack("row_start", ElementType::u64, "1", rows.row_start, std::identity()));
    const auto column = [&](const char* name, ElementType type, const char* unit, const auto& value) {
      packed.push_back(pack(name, type, unit, rows.segments, value));
    };
    column("x_begin", ElementType::f64, "mm", [](const Segment& segment) { return segment.x_begin; });
    column("x_end", ElementType::f64, "mm", [](const Segment& segment) { return segment.x_end; });
    column("material", ElementType::u32, "1", [](const Segment& segment) { return segment.material.value(); });
    column("solid", ElementType::u32, "1", [](const Segment& segment) { return segment.solid.value(); });
    if (!rows.mixtures.empty()) pack(rows.mixtures, packed);
    return packed;
  }

  PackedRows pack(const LayerContours& contours) {
    const auto& loops = contours.loops;
    const auto& points = contours.points;
    PackedRows packed;
    const auto put = [&](PackedArray array) { packed.push_back(std::move(array)); };
    put(pack("solid", ElementType::u32, "1", loops, [](const ContourLoop& loop) { return loop.solid.value(); }));
    put(pack("parent", ElementType::i32, "1", loops, [](const ContourLoop& loop) { return loop.parent; }));
    put(pack("area", ElementType::f64, "mm^2", loops, [](const ContourLoop& loop) { return loop.area; }));
    put(pack("point_start", ElementType::u64, "1", contours.point_start, std::identity()));
    put(pack("x", ElementType::f64, "mm", points, [](const Vec2& point) { return point.x(); }));
    put(pack("y", ElementType::f64, "mm", points, [](const Vec2& point) { return point.y(); }));
    if (!contours.curves.empty()) pack(contours.curves, packed);
    return packed;
  }

 private:
  void pack(const std::vector<ContourCurve>& curves, PackedRows& packed) {
    const auto column = [&](const char* name, ElementType type, const auto& value) {
      packed.push_back(pack(name, type, "1", curves, value));
    };
    column("curve_side", ElementType::u64, [](const ContourCurve& curve) { return curve.first_side; });
    column("curve_sides", ElementType::u64, [](const ContourCurve& curve) { return curve.sides; });
    column("curve_kind", ElementType::u32,
           [](const ContourCurve& curve) { return static_cast<std::uint32_t>(curve.kind); });
    std::vector<double> numbers;
    for (const ContourCurve& curve : curves) numbers.insert(numbers.end(), curve.numbers.begin(), curve.numbers.end());
    packed.push_back(pack("curve_numbers", ElementType::f64, "mm, rad", numbers, std::identity()));
  }

  void pack(const Mixtures& mixtures, PackedRows& packed) {
    const auto whole = [&](const char* name, ElementType type, const char* unit, const auto& values) {
      packed.push_back(pack(name, type, unit, values, std::identity()));
    };
    whole("graded_segment", ElementType::u64, "1", mixtures.segment);
    whole("knot_start", ElementType::u64, "1", mixtures.knot_start);
    whole("knot_x", ElementType::f64, "mm", mixtures.x);
    whole("fraction_start", ElementType::u64, "1", mixtures.fraction_start);
    whole("fraction", ElementType::f32, "1", mixtures.fraction);
  }

  /// The array of value(element) for each of the elements.
  template <class Values, class Value>
  PackedArray pack(const char* name, ElementType type, const char* unit, const Values& values, const Value& value) {
    using T = std::decay_t<decltype(value(*values.begin()))>;
    using Bits = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;
    start<Bits>(values.size());
    std::transform(values.begin(), values.end(), elements<Bits>().begin(),
                   [&](const auto& element) { return std::bit_cast<Bits>(value(element)); });
    return finish<Bits>(name, type, unit);
  }

  template <class T>
  std::vector<T>& elements() {
    if constexpr (sizeof(T) == 8) {
      return longs_;
    } else {
      return shorts_;
    }
  }

  /// Makes room for `count` elements and for what fills up their last chunk.
  template <class T>
  void start(std::size_t count) {
    count_ = count;
    chunk_ = count * sizeof(T) <= kCompactBytes ? 0 : std::min(count, kChunkElements);
    const std::size_t pieces = chunk_ == 0 ? 1 : (count + chunk_ - 1) / chunk_;
    elements<T>().assign(chunk_ == 0 ? count : pieces * chunk_, T{0});
  }

  template <class T>
  PackedArray finish(const char* name, ElementType type, const char* unit) {
    PackedArray array{name, type, unit, count_, chunk_, {}};
    const std::span<const T> all = elements<T>();
    if (chunk_ == 0) {
      array.pieces.emplace_back(reinterpret_cast<const char*>(all.data()), all.size_bytes());
      return array;
    }
    for (std::size_t begin = 0; begin < all.size(); begin += chunk_)
      array.pieces.push_back(piece_of(all.subspan(begin, chunk_)));
    return array;
  }

  template <class T>
  std::string piece_of(std::span<const T> chunk) {
    if (!deflater_) return {reinterpret_cast<const char*>(chunk.data()), chunk.size_bytes()};
    shuffled_.resize(chunk.size_bytes());
    shuffle(chunk, shuffled_.data());
    return deflater_->compress(shuffled_, chunk.size());
  }

  std::optional<PlaneDeflater> deflater_;
  std::size_t count_ = 0;
  std::size_t chunk_ = 0;
  std::vector<std::uint64_t> longs_;
  std::vector<std::uint32_t> shorts_;
  std::vector<char> shuffled_;
};

}  // namespace

PackedLayer pack_layer(const Layer& layer, int level) {
  Packer packer(level);
  PackedLayer packed{layer.index, layer.z_bottom, layer.z_sample, layer.z_top, packer.pack(layer.raster), {}, {}};
  if (layer.hatch) {
    const HatchRows& hatch = *layer.hatch;
    packed.hatch = {hatch.angle, hatch.spacing, hatch.first_row, packer.pack(hatch.rows)};
  }
  if (layer.contours) packed.contours = packer.pack(*layer.contours);
  return packed;
}

}  // namespace lamella
