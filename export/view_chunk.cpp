#include "export/view_chunk.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <libdeflate.h>
#include <memory>
#include <new>

#include "export/base64.h"
#include "export/raster_row.h"

namespace lamella {

namespace {

constexpr int kDeflateLevel = 6;
constexpr int kMostBits = 16;
// A chunk is what the page decodes at once: some tens of milliseconds.
constexpr std::uint64_t kFullSegments = 1U << 17;
constexpr std::uint64_t kFullRows = 1U << 18;
constexpr std::uint64_t kFullFractions = 1U << 19;
constexpr double kWholeFraction = 65535.0;

/// Small numbers of either sign as small numbers without one: 0, -1, 1, -2 ... become 0, 1, 2, 3 ...
std::uint32_t folded(std::int64_t value) {
  const auto bits = static_cast<std::uint32_t>(static_cast<std::int32_t>(value));
  return bits << 1 ^ (value < 0 ? ~0U : 0U);
}

/// Appends the column as four planes, lowest bytes first: what is mostly zero then lies together.
void append_planes(const std::vector<std::uint32_t>& column, std::string& out) {
  for (int shift = 0; shift < 32; shift += 8) {
    for (const std::uint32_t value : column) out.push_back(static_cast<char>(value >> shift & 0xFFU));
  }
}

std::string compress(const std::string& bytes) {
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
      libdeflate_alloc_compressor(kDeflateLevel), &libdeflate_free_compressor);
  if (!compressor) throw std::bad_alloc();
  std::string out(libdeflate_zlib_compress_bound(compressor.get(), bytes.size()), '\0');
  out.resize(libdeflate_zlib_compress(compressor.get(), bytes.data(), bytes.size(), out.data(), out.size()));
  return out;
}

std::int64_t or_zero(const std::vector<std::int64_t>& values, std::size_t i) {
  return i < values.size() ? values[i] : 0;
}

}  // namespace

ViewScale::ViewScale(const Grid& grid)
    : origin_(grid.origin.x()),
      pitch_(grid.pitch.x()),
      bits_(std::clamp(31 - static_cast<int>(std::bit_width(static_cast<std::uint64_t>(grid.size[0]))), 0, kMostBits)) {
}

std::int32_t ViewScale::code(double x, std::int64_t first) const {
  const double scale = std::ldexp(1.0, bits_);
  const double centres = (x - origin_) / pitch_ - 0.5;
  const double before = std::round((static_cast<double>(first) - centres) * scale);
  // In [0, scale - 1], whatever the division rounded to; written so that NaN is 0.
  const double kept = before > 0.0 ? std::min(before, scale - 1.0) : 0.0;
  return static_cast<std::int32_t>(static_cast<double>(first) * scale - kept);
}

HatchScale::HatchScale(const Grid& grid) {
  const Vec2 size(grid.pitch.x() * static_cast<double>(grid.size[0]),
                  grid.pitch.y() * static_cast<double>(grid.size[1]));
  unit = std::ldexp(size.norm(), -24);
  centre = grid.origin.head<2>() + 0.5 * size;
}

std::int64_t HatchScale::code(double x, const Vec2& along) const {
  return std::llround((x - centre.dot(along)) / unit);
}

bool ViewChunk::is_full() const {
  return sizes_.segments + sizes_.hatch_segments >= kFullSegments || sizes_.rows + sizes_.hatch_rows >= kFullRows ||
         sizes_.fractions >= kFullFractions;
}

void ViewChunk::add(const Layer& layer) {
  const std::uint64_t first = sizes_.segments;
  begins_.clear();
  for (std::size_t r = 0; r < layer.raster.rows(); ++r) add_row(layer.raster, r);
  const Mixtures& mixtures = layer.raster.mixtures;
  for (std::size_t g = 0; g < mixtures.segment.size(); ++g) {
    const std::uint64_t number = first + mixtures.segment[g];
    graded_.push_back(static_cast<std::uint32_t>(number - last_graded_));
    last_graded_ = number;
    add_mixture(layer, g);
  }
  if (hatch_ && layer.hatch) add_hatch(*layer.hatch, layer.index);
  ++sizes_.layers;
  sizes_.rows += layer.raster.rows();
  sizes_.graded += mixtures.segment.size();
}

void ViewChunk::Rows::begin_row(std::size_t count) {
  counts.push_back(folded(static_cast<std::int64_t>(count) - last_count));
  last_count = static_cast<std::int64_t>(count);
  row_gaps.clear();
  row_lengths.clear();
}

void ViewChunk::Rows::add(std::int64_t gap, std::int64_t length, MaterialId material) {
  gaps.push_back(folded(gap - or_zero(last_gaps, row_gaps.size())));
  lengths.push_back(folded(length - or_zero(last_lengths, row_lengths.size())));
  row_gaps.push_back(gap);
  row_lengths.push_back(length);
  materials.push_back(material.value());
}

void ViewChunk::Rows::end_row() {
  std::swap(row_gaps, last_gaps);
  std::swap(row_lengths, last_lengths);
}

void ViewChunk::add_row(const SegmentRows& rows, std::size_t r) {
  const auto segments = rows.row(r);
  raster_rows_.begin_row(segments.size());
  std::int64_t end = 0;
  for (const Segment& segment : segments) {
    const PixelRun pixels = pixels_of(segment, grid_);
    const std::int32_t begin = scale_.code(segment.x_begin, pixels.begin);
    begins_.push_back(begin);
    const std::int64_t gap = begin - end;
    end = scale_.code(segment.x_end, pixels.end);
    raster_rows_.add(gap, end - begin, segment.material);
    solids_.push_back(segment.solid.value());
  }
  raster_rows_.end_row();
  sizes_.segments += segments.size();
}

void ViewChunk::add_hatch(const HatchRows& hatch, std::uint32_t layer) {
  const Vec2 along = hatch_axes(*hatch_, layer).along;
  for (std::size_t r = 0; r < hatch.rows.rows(); ++r) {
    const auto segments = hatch.rows.row(r);
    hatch_rows_.begin_row(segments.size());
    std::int64_t last = 0;
    for (const Segment& segment : segments) {
      const std::int64_t begin = hatch_scale_.code(segment.x_begin, along);
      const std::int64_t end = hatch_scale_.code(segment.x_end, along);
      hatch_rows_.add(begin - last, end - begin, segment.material);
      last = end;
    }
    hatch_rows_.end_row();
    sizes_.hatch_segments += segments.size();
  }
  sizes_.hatch_rows += hatch.rows.rows();
}

void ViewChunk::add_mixture(const Layer& layer, std::size_t g) {
  const Mixtures& mixtures = layer.raster.mixtures;
  const auto x = mixtures.knots(g);
  const auto fractions = mixtures.fractions(g);
  knot_counts_.push_back(static_cast<std::uint32_t>(x.size()));
  std::int64_t last = begins_[mixtures.segment[g]];
  for (const double knot : x) {
    const std::int64_t code = scale_.code(knot, pixels_of({knot, HUGE_VAL, {}, {}}, grid_).begin);
    knot_x_.push_back(folded(code - last));
    last = code;
  }
  const std::size_t components = fractions.size() / x.size();
  for (std::size_t i = 0; i < fractions.size(); ++i) {
    const auto whole = [&](std::size_t n) { return std::lround(static_cast<double>(fractions[n]) * kWholeFraction); };
    fractions_.push_back(folded(whole(i) - (i < components ? 0 : whole(i - components))));
  }
  sizes_.knots += x.size();
  sizes_.fractions += fractions.size();
}

std::string ViewChunk::take() {
  std::string bytes;
  for (const Column* column : {&raster_rows_.counts, &raster_rows_.gaps, &raster_rows_.lengths, &raster_rows_.materials,
                               &solids_, &graded_, &knot_counts_, &knot_x_, &fractions_, &hatch_rows_.counts,
                               &hatch_rows_.gaps, &hatch_rows_.lengths, &hatch_rows_.materials}) {
    append_planes(*column, bytes);
  }
  *this = ViewChunk(grid_, hatch_);
  return base64(compress(bytes));
}

}  // namespace lamella
