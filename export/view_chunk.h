#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "slicing/layer.h"
#include "slicing/layer_plan.h"

namespace lamella {

/// Places along x as whole numbers: 0 is the centre of pixel 0, one pixel is 2^bits. Rounding never crosses a pixel's
/// centre: pixel i lies at or behind x exactly if i 2^bits >= code, so the codes give the same pixels as the doubles.
/// They are off by less than 2^-bits pixels.
class ViewScale {
 public:
  explicit ViewScale(const Grid& grid);

  /// 16, less on lattices of 2^15 or more pixels, so that codes fit 32 bits.
  [[nodiscard]] int bits() const { return bits_; }
  /// `first` is the first pixel whose centre isn't below x (pixels_of()).
  [[nodiscard]] std::int32_t code(double x, std::int64_t first) const;

 private:
  double origin_;
  double pitch_;
  int bits_;
};

/// How many numbers the columns of a chunk hold.
struct ViewChunkSizes {
  std::uint64_t layers = 0;
  std::uint64_t rows = 0;
  std::uint64_t segments = 0;
  std::uint64_t graded = 0;     ///< segments of graded material
  std::uint64_t knots = 0;      ///< of the graded segments
  std::uint64_t fractions = 0;  ///< of the knots
};

/// Consecutive layers of a page, packed together (docs/viewer.md, "What the page holds").
class ViewChunk {
 public:
  explicit ViewChunk(const Grid& grid) : grid_(grid), scale_(grid) {}

  void add(const Layer& layer);
  [[nodiscard]] bool is_full() const;
  [[nodiscard]] const ViewChunkSizes& sizes() const { return sizes_; }
  /// A zlib stream of the columns in base64; the chunk is empty afterwards.
  [[nodiscard]] std::string take();

 private:
  using Column = std::vector<std::uint32_t>;

  void add_row(const SegmentRows& rows, std::size_t r);
  void add_mixture(const Layer& layer, std::size_t g);

  Grid grid_;
  ViewScale scale_;
  ViewChunkSizes sizes_;
  std::int64_t last_count_ = 0;
  std::vector<std::int64_t> last_gaps_;     ///< of the row before
  std::vector<std::int64_t> last_lengths_;  ///< of the row before
  std::vector<std::int64_t> gaps_;
  std::vector<std::int64_t> lengths_;
  std::vector<std::int32_t> begins_;  ///< of the current layer's segments
  std::uint64_t last_graded_ = 0;
  Column row_counts_, segment_gaps_, segment_lengths_, materials_, solids_, graded_, knot_counts_, knot_x_, fractions_;
};

}  // namespace lamella
