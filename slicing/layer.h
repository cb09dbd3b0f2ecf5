#pragma once

#include <algorithm>
#include <array>
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

/// Finer rows for outputs that average over a row of voxels: line s of raster row j is row j * per_row + s, at
/// y = O_y + (j + (s + 1/2) / per_row) p_y.
struct SubRows {
  std::int64_t per_row = 1;
  SegmentRows rows;

  bool operator==(const SubRows&) const = default;
};

enum class CurveKind : std::uint8_t { ellipse, quintic, conic };

/// The curve that consecutive sides of a loop are chords of. Side i leads from point i to the next of its loop.
struct ContourCurve {
  std::uint64_t first_side = 0;
  std::uint64_t sides = 0;  ///< all in one loop
  CurveKind kind = CurveKind::quintic;
  /// Of an ellipse x and y of the centre, of the radius at angle 0 and of that at pi / 2, mm, then the angle where the
  /// first side begins and the angle swept, radians, of either sign: centre + cos(a) r0 + sin(a) r1; the rest is 0.
  /// Of a quintic the coefficients of x(t), then of y(t), ascending, mm; t runs from 0 to 1.
  /// Of a conic, as a rational Bezier curve of degree 2, x and y of its three poles, mm, and the weight of the middle
  /// one, those of the ends being 1; the rest is 0. t runs from 0 to 1.
  std::array<double, 12> numbers{};

  /// Moves the curve in its plane.
  void shift(const Vec2& by) {
    if (kind == CurveKind::conic) {
      for (std::size_t pole = 0; pole < 3; ++pole) {
        numbers[2 * pole] += by.x();
        numbers[2 * pole + 1] += by.y();
      }
      return;
    }
    numbers[0] += by.x();
    numbers[kind == CurveKind::ellipse ? 1 : 6] += by.y();
  }
  bool operator==(const ContourCurve&) const = default;
};

/// Sections of whole solids as polygons, before priorities: where solids overlap, so do their loops. Loops ascend by
/// solid; loop i has the points [point_start[i], point_start[i + 1]), three at least, the last joins the first.
struct LayerContours {
  std::vector<ContourLoop> loops;
  std::vector<std::uint64_t> point_start{0};
  std::vector<Vec2> points;  ///< mm
  /// On request, ascending by side, no side in two of them; sides in none are straight in the section too.
  std::vector<ContourCurve> curves;

  [[nodiscard]] std::span<const Vec2> polygon(std::size_t loop) const {
    return {points.data() + point_start[loop], points.data() + point_start[loop + 1]};
  }
  /// Adds a loop at the end; the sides of its curves count from its own first.
  void add(const ContourLoop& loop, std::span<const Vec2> polygon, std::span<const ContourCurve> of_loop = {}) {
    for (ContourCurve curve : of_loop) {
      curve.first_side += points.size();
      curves.push_back(curve);
    }
    loops.push_back(loop);
    points.insert(points.end(), polygon.begin(), polygon.end());
    point_start.push_back(points.size());
  }
  /// Those of one loop; their sides count from its own first.
  [[nodiscard]] std::vector<ContourCurve> curves_of(std::size_t loop) const {
    const auto by_side = [](const ContourCurve& curve, std::uint64_t side) { return curve.first_side < side; };
    const auto first = std::lower_bound(curves.begin(), curves.end(), point_start[loop], by_side);
    const auto last = std::lower_bound(first, curves.end(), point_start[loop + 1], by_side);
    std::vector<ContourCurve> found(first, last);
    for (ContourCurve& curve : found) curve.first_side -= point_start[loop];
    return found;
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
  std::optional<SubRows> sub_rows;        ///< on request, while slicing: a store keeps none

  bool operator==(const Layer&) const = default;
};

}  // namespace lamella
