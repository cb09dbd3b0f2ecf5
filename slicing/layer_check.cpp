#include "slicing/layer_check.h"

#include <algorithm>
#include <cmath>

namespace lamella {

namespace {

/// Comparisons are written so that NaN fails.
std::optional<std::string> find_row_fault(std::span<const Segment> row, const LayerLimits& limits) {
  for (std::size_t i = 0; i < row.size(); ++i) {
    const Segment& segment = row[i];
    if (!std::isfinite(segment.x_begin) || !std::isfinite(segment.x_end)) return "a segment's end is not finite";
    if (!(segment.x_begin < segment.x_end)) return "a segment is empty or reversed";
    if (i > 0 && !(row[i - 1].x_end <= segment.x_begin)) return "segments overlap or are out of order";
    if (!(segment.material.value() < limits.materials)) return "a material id is out of range";
    if (!(segment.solid.value() < limits.solids)) return "a solid id is out of range";
  }
  return std::nullopt;
}

/// Fractions are kept as floats.
constexpr double kSumSlack = 1e-5;

/// Knots and fractions of one graded segment.
std::optional<std::string> find_mixture_fault(std::span<const double> x, std::span<const float> fractions,
                                              const Segment& segment) {
  const std::size_t components = fractions.size() / x.size();
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (!(segment.x_begin <= x[k] && x[k] <= segment.x_end)) return "a knot lies beyond its segment";
    if (k > 0 && !(x[k - 1] < x[k])) return "knots are out of order";
    double sum = 0.0;
    for (const float fraction : fractions.subspan(k * components, components)) {
      if (!(fraction >= 0.0F && fraction <= 1.0F)) return "a fraction is out of range";
      sum += fraction;
    }
    if (!(std::abs(sum - 1.0) <= kSumSlack)) return "fractions don't add up to 1";
  }
  return std::nullopt;
}

bool is_start_list(const std::vector<std::uint64_t>& starts, std::size_t count, std::size_t end) {
  return starts.size() == count + 1 && starts.front() == 0 && starts.back() == end &&
         std::is_sorted(starts.begin(), starts.end());
}

std::optional<std::string> find_rows_fault(const SegmentRows& rows, const LayerLimits& limits) {
  if (rows.row_start.empty() || rows.row_start.front() != 0) return "row_start does not begin with 0";
  for (std::size_t r = 0; r < rows.rows(); ++r) {
    if (rows.row_start[r] > rows.row_start[r + 1]) return "row_start is not monotone";
  }
  if (rows.row_start.back() != rows.segments.size()) return "row_start does not end at the number of segments";
  for (std::size_t r = 0; r < rows.rows(); ++r) {
    if (auto fault = find_row_fault(rows.row(r), limits)) return *fault + " in row " + std::to_string(r);
  }
  return lamella::find_mixtures_fault(rows, limits);
}

std::optional<std::string> find_loop_fault(const LayerContours& contours, std::size_t i, const LayerLimits& limits) {
  const ContourLoop& loop = contours.loops[i];
  if (!(loop.solid.value() < limits.solids)) return "a solid id is out of range";
  if (i > 0 && loop.solid < contours.loops[i - 1].solid) return "loops are out of order";
  if (!std::isfinite(loop.area)) return "an area is not finite";
  if (loop.parent < -1 || loop.parent >= static_cast<std::int64_t>(contours.loops.size())) {
    return "a loop's parent is out of range";
  }
  if (loop.parent >= 0) {
    const ContourLoop& parent = contours.loops[static_cast<std::size_t>(loop.parent)];
    if (parent.solid != loop.solid || (parent.area > 0.0) == (loop.area > 0.0)) return "a loop has a wrong parent";
  }
  for (const Vec2& point : contours.polygon(i)) {
    if (!point.allFinite()) return "a point is not finite";
  }
  return std::nullopt;
}

std::optional<std::string> find_curve_fault(const LayerContours& contours) {
  std::uint64_t free_side = 0;
  for (const ContourCurve& curve : contours.curves) {
    const auto end = std::upper_bound(contours.point_start.begin(), contours.point_start.end(), curve.first_side);
    if (curve.first_side < free_side || curve.sides == 0 || end == contours.point_start.end() ||
        curve.sides > *end - curve.first_side) {
      return "the sides of curves aren't in order";
    }
    free_side = curve.first_side + curve.sides;
    if (curve.kind > CurveKind::conic) return "a curve is of no known kind";
    for (const double number : curve.numbers) {
      if (!std::isfinite(number)) return "a curve is not finite";
    }
    if (curve.kind == CurveKind::conic && !(curve.numbers[6] > 0.0)) return "a conic's weight is not positive";
  }
  return std::nullopt;
}

std::optional<std::string> find_contour_fault(const LayerContours& contours, const LayerLimits& limits) {
  if (!is_start_list(contours.point_start, contours.loops.size(), contours.points.size())) {
    return "the points of loops aren't in order";
  }
  for (std::size_t i = 0; i < contours.loops.size(); ++i) {
    if (contours.point_start[i + 1] - contours.point_start[i] < 3) return "a loop has less than three points";
    if (auto fault = find_loop_fault(contours, i, limits)) return *fault + " in loop " + std::to_string(i);
  }
  return find_curve_fault(contours);
}

}  // namespace

LayerLimits make_layer_limits(std::int64_t rows, const IdVector<MaterialId, Material>& materials, std::size_t solids) {
  LayerLimits limits{static_cast<std::size_t>(rows), materials.size(), solids, {}};
  for (const Material& material : materials) limits.components.push_back(material.components.size());
  return limits;
}

std::optional<std::string> find_mixtures_fault(const SegmentRows& rows, const LayerLimits& limits) {
  const Mixtures& mixtures = rows.mixtures;
  const std::size_t count = mixtures.segment.size();
  if (!is_start_list(mixtures.knot_start, count, mixtures.x.size()) ||
      !is_start_list(mixtures.fraction_start, count, mixtures.fraction.size())) {
    return "the knots of graded segments aren't in order";
  }
  std::size_t g = 0;
  for (std::size_t i = 0; i < rows.segments.size(); ++i) {
    const Segment& segment = rows.segments[i];
    const std::size_t components = limits.components.empty() ? 0 : limits.components[segment.material.value()];
    if (components == 0) continue;
    if (g == count || mixtures.segment[g] != i) return "a graded segment has no fractions";
    const auto x = mixtures.knots(g);
    if (x.empty() || mixtures.fractions(g).size() != x.size() * components) {
      return "a graded segment has a wrong number of fractions";
    }
    if (auto fault = find_mixture_fault(x, mixtures.fractions(g), segment)) return fault;
    ++g;
  }
  if (g != count) return "fractions of a segment that isn't graded";
  return std::nullopt;
}

std::optional<std::string> find_layer_fault(const Layer& layer, const LayerLimits& limits) {
  if (!(layer.z_bottom < layer.z_sample) || !(layer.z_sample < layer.z_top)) return "its heights do not ascend";
  if (!std::isfinite(layer.z_bottom) || !std::isfinite(layer.z_top)) return "its heights are not finite";
  if (layer.raster.rows() != limits.rows) {
    return "it has " + std::to_string(layer.raster.rows()) + " rows instead of " + std::to_string(limits.rows);
  }
  if (auto fault = find_rows_fault(layer.raster, limits)) return fault;
  if (layer.contours) {
    if (auto fault = find_contour_fault(*layer.contours, limits)) return std::string("contours: ").append(*fault);
  }
  if (layer.sub_rows) {
    if (layer.sub_rows->per_row < 1 ||
        layer.sub_rows->rows.rows() != limits.rows * static_cast<std::size_t>(layer.sub_rows->per_row)) {
      return "it has a wrong number of sub-rows";
    }
    if (auto fault = find_rows_fault(layer.sub_rows->rows, limits)) return std::string("sub-rows: ").append(*fault);
  }
  if (!layer.hatch) return std::nullopt;
  if (!std::isfinite(layer.hatch->angle) || !(layer.hatch->spacing > 0.0)) return "its hatch lattice is not finite";
  if (auto fault = find_rows_fault(layer.hatch->rows, limits)) return std::string("hatch: ").append(*fault);
  return std::nullopt;
}

}  // namespace lamella
