#include "slicing/store/layer_digest.h"

#include <bit>
#include <span>

#include "core/sha256.h"

namespace lamella {

namespace {

static_assert(std::endian::native == std::endian::little, "a digest covers little-endian bytes");
static_assert(sizeof(Segment) == 24 && sizeof(MaterialId) == 4 && sizeof(SolidId) == 4,
              "segments lie in memory as a digest covers them: x_begin, x_end, material, solid");
static_assert(sizeof(Vec2) == 16, "points lie in memory as a digest covers them: x, y");

/// Feeds numbers to a digest as they lie in memory.
class DigestStream {
 public:
  template <class T>
  void put(std::span<const T> values) {
    sha_.update(std::as_bytes(values));
  }
  template <class T>
  void put(const T& value) {
    put(std::span(&value, 1));
  }

  std::string finish() { return sha_.finish(); }

 private:
  Sha256 sha_;
};

void put_rows(DigestStream& stream, const SegmentRows& rows) {
  stream.put(static_cast<std::uint64_t>(rows.rows()));
  stream.put(std::span(rows.row_start));
  stream.put(std::span(rows.segments));
}

void put_mixtures(DigestStream& stream, const Mixtures& mixtures) {
  stream.put(static_cast<std::uint64_t>(mixtures.segment.size()));
  stream.put(std::span(mixtures.segment));
  stream.put(std::span(mixtures.knot_start));
  stream.put(std::span(mixtures.x));
  stream.put(std::span(mixtures.fraction_start));
  stream.put(std::span(mixtures.fraction));
}

void put_contours(DigestStream& stream, const LayerContours& contours) {
  stream.put(static_cast<std::uint64_t>(contours.loops.size()));
  for (const ContourLoop& loop : contours.loops) {
    stream.put(loop.solid.value());
    stream.put(loop.parent);
    stream.put(loop.area);
  }
  stream.put(std::span(contours.point_start));
  stream.put(std::span(contours.points));
  for (const ContourCurve& curve : contours.curves) {
    stream.put(curve.first_side);
    stream.put(curve.sides);
    stream.put(static_cast<std::uint32_t>(curve.kind));
    stream.put(std::span<const double>(curve.numbers));
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
  // A layer without graded segments or contours has the digest that it had before there were any.
  const bool has_mixtures = !layer.raster.mixtures.empty() || (layer.hatch && !layer.hatch->rows.mixtures.empty());
  if (has_mixtures) {
    put_mixtures(stream, layer.raster.mixtures);
    put_mixtures(stream, layer.hatch ? layer.hatch->rows.mixtures : Mixtures());
  }
  if (layer.contours) put_contours(stream, *layer.contours);
  return stream.finish();
}

}  // namespace lamella
