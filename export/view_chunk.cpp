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

bool ViewChunk::is_full() const {
  return sizes_.segments >= kFullSegments || sizes_.rows >= kFullRows || sizes_.fractions >= kFullFractions;
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
  ++sizes_.layers;
  sizes_.rows += layer.raster.rows();
  sizes_.graded += mixtures.segment.size();
}

void ViewChunk::add_row(const SegmentRows& rows, std::size_t r) {
  const auto segments = rows.row(r);
  row_counts_.push_back(folded(static_cast<std::int64_t>(segments.size()) - last_count_));
  last_count_ = static_cast<std::int64_t>(segments.size());
  gaps_.clear();
  lengths_.clear();
  std::int64_t end = 0;
  for (const Segment& segment : segments) {
    const PixelRun pixels = pixels_of(segment, grid_);
    const std::int32_t begin = scale_.code(segment.x_begin, pixels.begin);
    begins_.push_back(begin);
    gaps_.push_back(begin - end);
    end = scale_.code(segment.x_end, pixels.end);
    lengths_.push_back(end - begin);
    segment_gaps_.push_back(folded(gaps_.back() - or_zero(last_gaps_, gaps_.size() - 1)));
    segment_lengths_.push_back(folded(lengths_.back() - or_zero(last_lengths_, lengths_.size() - 1)));
    materials_.push_back(segment.material.value());
    solids_.push_back(segment.solid.value());
  }
  sizes_.segments += segments.size();
  std::swap(gaps_, last_gaps_);
  std::swap(lengths_, last_lengths_);
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
  for (const Column* column : {&row_counts_, &segment_gaps_, &segment_lengths_, &materials_, &solids_, &graded_,
                               &knot_counts_, &knot_x_, &fractions_}) {
    append_planes(*column, bytes);
  }
  *this = ViewChunk(grid_);
  return base64(compress(bytes));
}

}  // namespace lamella
