#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/geometry.h"
#include "core/ids.h"

namespace lamella {

/// One material-labelled run [x_begin, x_end) of a row, mm along the row.
struct Segment {
  double x_begin = 0.0;
  double x_end = 0.0;
  MaterialId material;
  SolidId solid;

  bool operator==(const Segment&) const = default;
};

/// What graded segments consist of: volume fractions of their material's components at knots along the row, straight
/// between knots, constant before a segment's first and behind its last. In compressed form: graded segment g is
/// number segment[g] of the rows, has knots [knot_start[g], knot_start[g + 1]) and from fraction[fraction_start[g]] on
/// the fractions of its first knot, then of its second, and so on, in the order of Material::components.
struct Mixtures {
  std::vector<std::uint64_t> segment;  ///< ascending
  std::vector<std::uint64_t> knot_start{0};
  std::vector<double> x;  ///< mm along the row; ascending in a segment, within it
  std::vector<std::uint64_t> fraction_start{0};
  std::vector<float> fraction;  ///< in [0, 1]; those of a knot have the sum 1 to rounding

  [[nodiscard]] bool empty() const { return segment.empty(); }
  [[nodiscard]] std::span<const double> knots(std::size_t g) const {
    return {x.data() + knot_start[g], x.data() + knot_start[g + 1]};
  }
  /// Knot after knot.
  [[nodiscard]] std::span<const float> fractions(std::size_t g) const {
    return {fraction.data() + fraction_start[g], fraction.data() + fraction_start[g + 1]};
  }
  void clear() { *this = {}; }
  bool operator==(const Mixtures&) const = default;
};

/// Rows of segments in compressed form: row r holds segments [row_start[r], row_start[r + 1]), disjoint and ascending.
struct SegmentRows {
  std::vector<std::uint64_t> row_start{0};
  std::vector<Segment> segments;
  Mixtures mixtures;  ///< of the segments whose material is graded

  [[nodiscard]] std::size_t rows() const { return row_start.size() - 1; }
  [[nodiscard]] std::span<const Segment> row(std::size_t r) const {
    return {segments.data() + row_start[r], segments.data() + row_start[r + 1]};
  }
  bool operator==(const SegmentRows&) const = default;
};

/// Hatch rows first_row, first_row + 1, ...; x is the coordinate along the row from the foot of the machine origin.
struct HatchRows {
  double angle = 0.0;    ///< radians, of this layer
  double spacing = 0.0;  ///< mm
  std::int64_t first_row = 0;
  SegmentRows rows;

  bool operator==(const HatchRows&) const = default;
};

/// One closed loop of a solid's section, material on its left.
struct ContourLoop {
  SolidId solid;
  std::int32_t parent = -1;  ///< the smallest loop of the other kind around it, by number in the layer; -1 if none
  double area = 0.0;         ///< mm^2, of the exact loop: positive for outer loops, negative for holes

  bool operator==(const ContourLoop&) const = default;
};

/// Sections of whole solids as polygons, before priorities: where solids overlap, so do their loops. Loops ascend by
/// solid; loop i has the points [point_start[i], point_start[i + 1]), three at least, the last joins the first.
struct LayerContours {
  std::vector<ContourLoop> loops;
  std::vector<std::uint64_t> point_start{0};
  std::vector<Vec2> points;  ///< mm

  [[nodiscard]] std::span<const Vec2> polygon(std::size_t loop) const {
    return {points.data() + point_start[loop], points.data() + point_start[loop + 1]};
  }
  /// Adds a loop at the end.
  void add(const ContourLoop& loop, std::span<const Vec2> polygon) {
    loops.push_back(loop);
    points.insert(points.end(), polygon.begin(), polygon.end());
    point_start.push_back(points.size());
  }
  bool operator==(const LayerContours&) const = default;
};

/// One layer of labelled segments: the exchange format, and the only thing exporters read.
struct Layer {
  std::uint32_t index = 0;
  double z_bottom = 0.0;
  double z_sample = 0.0;
  double z_top = 0.0;
  SegmentRows raster;  ///< one row per raster line, j ascending with y
  std::optional<HatchRows> hatch;
  std::optional<LayerContours> contours;  ///< at z_sample

  bool operator==(const Layer&) const = default;
};

}  // namespace lamella
