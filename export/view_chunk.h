#pragma once

#include <cstdint>
#include <optional>
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

/// Places along hatch rows as whole numbers: units from the foot of the lattice's middle.
struct HatchScale {
  explicit HatchScale(const Grid& grid);

  double unit = 1.0;  ///< mm: the lattice's diagonal in 2^24 parts
  Vec2 centre = Vec2::Zero();

  [[nodiscard]] std::int64_t code(double x, const Vec2& along) const;
};

/// How many numbers the columns of a chunk hold.
struct ViewChunkSizes {
  std::uint64_t layers = 0;
  std::uint64_t rows = 0;
  std::uint64_t segments = 0;
  std::uint64_t graded = 0;     ///< segments of graded material
  std::uint64_t knots = 0;      ///< of the graded segments
  std::uint64_t fractions = 0;  ///< of the knots
  std::uint64_t hatch_rows = 0;
  std::uint64_t hatch_segments = 0;
};

/// Consecutive layers of a page, packed together (docs/viewer.md, "What the page holds").
class ViewChunk {
 public:
  /// With a `hatch`, rows of it too.
  explicit ViewChunk(const Grid& grid, const std::optional<HatchLattice>& hatch = {})
      : grid_(grid), hatch_(hatch), scale_(grid), hatch_scale_(grid) {}

  void add(const Layer& layer);
  [[nodiscard]] bool is_full() const;
  [[nodiscard]] const ViewChunkSizes& sizes() const { return sizes_; }
  /// A zlib stream of the columns in base64; the chunk is empty afterwards.
  [[nodiscard]] std::string take();

 private:
  using Column = std::vector<std::uint32_t>;

  /// Rows of segments as columns of differences to the row before.
  struct Rows {
    Column counts, gaps, lengths, materials;
    std::int64_t last_count = 0;
    std::vector<std::int64_t> last_gaps;     ///< of the row before
    std::vector<std::int64_t> last_lengths;  ///< of the row before
    std::vector<std::int64_t> row_gaps;
    std::vector<std::int64_t> row_lengths;

    void begin_row(std::size_t count);
    /// `gap` from the end before, or from 0.
    void add(std::int64_t gap, std::int64_t length, MaterialId material);
    void end_row();
  };

  void add_row(const SegmentRows& rows, std::size_t r);
  void add_mixture(const Layer& layer, std::size_t g);
  void add_hatch(const HatchRows& hatch, std::uint32_t layer);

  Grid grid_;
  std::optional<HatchLattice> hatch_;
  ViewScale scale_;
  HatchScale hatch_scale_;
  ViewChunkSizes sizes_;
  Rows raster_rows_, hatch_rows_;
  std::vector<std::int32_t> begins_;  ///< of the current layer's segments
  std::uint64_t last_graded_ = 0;
  Column solids_, graded_, knot_counts_, knot_x_, fractions_;
};

}  // namespace lamella
