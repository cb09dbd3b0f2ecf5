#include "slicing/span/section_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "model/bezier.h"
#include "model/bspline.h"

namespace lamella::span {

namespace {

/// Share of the domain by which the outer cells reach beyond it.
constexpr double kOuterMargin = 0.02;

/// Share of a cell within which an edge's tolerance may move a point over its limit.
constexpr double kNearLimit = 1e-4;

/// Multiplicity of a knot.
int count_of(const std::vector<double>& knots, double knot) {
  const auto [first, last] = std::equal_range(knots.begin(), knots.end(), knot);
  return static_cast<int>(last - first);
}

}  // namespace

SectionSurface::SectionSurface(const Surface& surface) : surface_(&surface), periods_(lamella::periods(surface)) {
  const auto* spline = std::get_if<BSplineSurface>(&surface);
  if (const auto* fitted = std::get_if<FittedSurface>(&surface)) spline = &fitted->fit;
  const auto* extrusion = std::get_if<Extrusion>(&surface);
  const auto* revolution = std::get_if<Revolution>(&surface);
  if (spline != nullptr) {
    kind_ = Kind::spline;
    nets_ = SurfaceNets(*spline);
    set_breaks(0, nets_.breaks_u(), spline->knots_u, spline->degree_u);
    set_breaks(1, nets_.breaks_v(), spline->knots_v, spline->degree_v);
  } else if (extrusion != nullptr || revolution != nullptr) {
    kind_ = extrusion != nullptr ? Kind::extrusion : Kind::revolution;
    const Curve3& curve = extrusion != nullptr ? extrusion->basis : revolution->meridian;
    if (const auto* basis = std::get_if<BSplineCurve<3>>(&curve)) {
      basis_ = CurveNets<3>(*basis);
      set_breaks(extrusion != nullptr ? 0 : 1, basis_.breaks(), basis->knots, basis->degree);
    }
  }
}

void SectionSurface::set_breaks(int axis, const Breaks& pieces, const std::vector<double>& knots, int degree) {
  pieces_[axis] = pieces;
  const std::vector<double>& all = pieces.all();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool is_end = i == 0 || i + 1 == all.size();
    if (!is_end && count_of(knots, all[i]) <= degree - 2) continue;
    breaks_[axis].push_back(all[i]);
    first_piece_[axis].push_back(static_cast<int>(i));
  }
}

bool SectionSurface::crosses_knot(const Vec2& a, const Vec2& b, const Cell& cell) const {
  for (int axis = 0; axis < 2; ++axis) {
    if (pieces_[axis].empty()) continue;
    const int index = axis == 0 ? cell.u : cell.v;
    if (first_piece_[axis][index + 1] - first_piece_[axis][index] == 1) continue;
    // Points on a knot touch it, no more.
    const auto [low, high] = std::minmax(a[axis], b[axis]);
    const double slack = 1e-6 * (high - low);
    const int piece = piece_of(axis, low + slack, index);
    if (piece + 1 < first_piece_[axis][index + 1] && high - slack >= pieces_[axis][piece + 1]) return true;
  }
  return false;
}

Interval SectionSurface::piece_limits(int axis, double place, double heading, const Cell& cell) const {
  const Breaks& all = pieces_[axis];
  if (all.empty()) return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  const int index = axis == 0 ? cell.u : cell.v;
  const int first = first_piece_[axis][index];
  const int last = first_piece_[axis][index + 1];
  int piece = all.part_of(place, first, last);
  const double slack = kCellSlack * (all[piece + 1] - all[piece]);
  if (heading < 0.0 && piece > first && place <= all[piece] + slack) --piece;
  if (heading > 0.0 && piece + 1 < last && place >= all[piece + 1] - slack) ++piece;
  const Interval outer = limits(cell, axis);
  return {piece == first ? outer.lo : all[piece], piece + 1 == last ? outer.hi : all[piece + 1]};
}

CurvePoint2<3> SectionSurface::basis_point(double t, int piece) const {
  if (!basis_.breaks().empty()) return basis_.evaluate(t, piece);
  if (kind_ == Kind::extrusion) return evaluate2(std::get<Extrusion>(*surface_).basis, t);
  return evaluate2(std::get<Revolution>(*surface_).meridian, t);
}

SurfacePoint2 SectionSurface::evaluate(const Vec2& uv, const Cell& cell) const {
  if (kind_ == Kind::analytic) return evaluate2(*surface_, uv);
  const Cell piece{piece_of(0, uv[0], cell.u), piece_of(1, uv[1], cell.v)};
  if (kind_ == Kind::spline) return nets_.evaluate(uv, piece.u, piece.v);
  if (kind_ == Kind::extrusion) {
    return extrude(basis_point(uv[0], piece.u), std::get<Extrusion>(*surface_).direction, uv[1]);
  }
  return revolve(basis_point(uv[1], piece.v), std::get<Revolution>(*surface_), uv[0]);
}

SurfacePoint SectionSurface::evaluate_slopes(const Vec2& uv, const Cell& cell) const {
  if (kind_ != Kind::spline) return evaluate(uv, cell);
  return nets_.evaluate_slopes(uv, piece_of(0, uv[0], cell.u), piece_of(1, uv[1], cell.v));
}

namespace {

void set_lane(const SurfacePoint2& at, int lane, JetLanes& out) {
  const std::array<const Vec3*, 6> orders{&at.point, &at.du, &at.dv, &at.duu, &at.duv, &at.dvv};
  for (int order = 0; order < 6; ++order) {
    for (int axis = 0; axis < 3; ++axis) out.value[3 * order + axis][lane] = (*orders[order])[axis];
  }
}

}  // namespace

void SectionSurface::evaluate_lanes(std::span<const CellPlace> places, bool bends, JetLanes& out) const {
  const auto count = static_cast<int>(places.size());
  if (kind_ != Kind::spline) {
    for (int lane = 0; lane < count; ++lane) {
      const auto& [uv, cell] = places[static_cast<std::size_t>(lane)];
      set_lane(evaluate(uv, cell), lane, out);
    }
    return;
  }
  NetLanes nets;
  for (int lane = 0; lane < count; ++lane) {
    const auto& [uv, cell] = places[static_cast<std::size_t>(lane)];
    nets_.set_lane(uv, piece_of(0, uv[0], cell.u), piece_of(1, uv[1], cell.v), lane, nets);
  }
  lane_kernel().jets(nets_.shape(), nets, count, bends, out);
}

Cell SectionSurface::find_cell(const Vec2& uv, const Vec2& heading) const {
  Cell cell;
  for (int axis = 0; axis < 2; ++axis) {
    const std::vector<double>& all = breaks_[axis];
    if (all.empty()) continue;
    const auto last = static_cast<int>(all.size()) - 2;
    const auto above = std::upper_bound(all.begin(), all.end(), uv[axis]) - all.begin() - 1;
    int index = std::clamp(static_cast<int>(above), 0, last);
    const double slack = kCellSlack * (all[index + 1] - all[index]);
    if (heading[axis] < 0.0 && index > 0 && uv[axis] <= all[index] + slack) {
      --index;
    } else if (heading[axis] > 0.0 && index < last && uv[axis] >= all[index + 1] - slack) {
      ++index;
    }
    (axis == 0 ? cell.u : cell.v) = index;
  }
  return cell;
}

Interval SectionSurface::limits(const Cell& cell, int axis) const {
  const std::vector<double>& all = breaks_[axis];
  if (all.empty()) return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  const int index = axis == 0 ? cell.u : cell.v;
  // Nodes may lie outside the domain by an edge's tolerance: the outer cells go on a little.
  const double margin = kOuterMargin * (all.back() - all.front());
  Interval limits{all[index], all[index + 1]};
  if (index == 0) limits.lo -= margin;
  if (index + 2 == static_cast<int>(all.size())) limits.hi += margin;
  return limits;
}

bool SectionSurface::holds(const Cell& cell, const Vec2& uv, int free_axis) const {
  for (int axis = 0; axis < 2; ++axis) {
    if (axis == free_axis) continue;
    const Interval range = limits(cell, axis);
    const double slack = kCellSlack * range.length();
    // Written so that NaN fails; an infinite range has an infinite slack.
    if (!(uv[axis] >= range.lo - slack && uv[axis] <= range.hi + slack)) return false;
  }
  return true;
}

bool SectionSurface::is_near_limit(const Cell& cell, const Vec2& uv) const {
  for (int axis = 0; axis < 2; ++axis) {
    const Interval range = limits(cell, axis);
    const double slack = kNearLimit * range.length();
    if (has_neighbor(cell, axis, false) && uv[axis] - range.lo < slack) return true;
    if (has_neighbor(cell, axis, true) && range.hi - uv[axis] < slack) return true;
  }
  return false;
}

double SectionSurface::extent(int axis) const {
  if (periods_[axis] > 0.0) return periods_[axis];
  if (breaks_[axis].empty()) return std::numeric_limits<double>::infinity();
  return breaks_[axis].back() - breaks_[axis].front();
}

bool SectionSurface::has_neighbor(const Cell& cell, int axis, bool upper) const {
  const int index = axis == 0 ? cell.u : cell.v;
  return upper ? index + 2 < static_cast<int>(breaks_[axis].size()) : index > 0;
}

}  // namespace lamella::span
