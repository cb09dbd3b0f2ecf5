#include "model/extremum_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

#include "model/de_casteljau.h"

namespace lamella {

namespace {

/// A part of a patch with the net of (w f, w), f = direction . S.
struct Cell {
  int degree_u;
  int degree_v;
  Interval u;
  Interval v;
  std::vector<Vec2> net;
  double bound;  ///< of f from above
  double floor;  ///< of f from below

  bool operator<(const Cell& other) const { return bound < other.bound; }
};

void set_range(Cell& cell) {
  cell.bound = -std::numeric_limits<double>::infinity();
  cell.floor = std::numeric_limits<double>::infinity();
  for (const Vec2& p : cell.net) {
    cell.bound = std::max(cell.bound, p[0] / p[1]);
    cell.floor = std::min(cell.floor, p[0] / p[1]);
  }
}

Cell make_cell(const BezierPatch& patch, const Vec3& direction) {
  Cell cell{patch.degree_u, patch.degree_v, patch.u, patch.v, {}, 0.0, 0.0};
  cell.net.reserve(patch.net.size());
  for (const Vec4& p : patch.net) cell.net.emplace_back(direction.dot(p.head<3>()), p[3]);
  set_range(cell);
  return cell;
}

double bound_of(const BezierPatch& patch, const Vec3& direction) {
  double bound = -std::numeric_limits<double>::infinity();
  for (const Vec4& p : patch.net) bound = std::max(bound, direction.dot(p.head<3>()) / p[3]);
  return bound;
}

/// The direction along which the net varies more is the one to halve.
bool varies_more_in_u(const Cell& cell) {
  const int stride = cell.degree_v + 1;
  double in_u = 0.0;
  double in_v = 0.0;
  const auto value = [&](int i, int j) { return cell.net[i * stride + j][0] / cell.net[i * stride + j][1]; };
  for (int i = 0; i <= cell.degree_u; ++i) {
    for (int j = 0; j <= cell.degree_v; ++j) {
      if (i > 0) in_u = std::max(in_u, std::abs(value(i, j) - value(i - 1, j)) * cell.degree_u);
      if (j > 0) in_v = std::max(in_v, std::abs(value(i, j) - value(i, j - 1)) * cell.degree_v);
    }
  }
  return in_u >= in_v;
}

std::pair<Cell, Cell> halve(const Cell& cell) {
  std::pair<Cell, Cell> halves{cell, cell};
  const int stride = cell.degree_v + 1;
  if (varies_more_in_u(cell)) {
    for (int j = 0; j < stride; ++j) {
      split_in_place(halves.first.net.data() + j, halves.second.net.data() + j, cell.degree_u, stride, 0.5);
    }
    halves.first.u.hi = halves.second.u.lo = cell.u.middle();
  } else {
    for (int i = 0; i <= cell.degree_u; ++i) {
      split_in_place(halves.first.net.data() + i * stride, halves.second.net.data() + i * stride, cell.degree_v, 1,
                     0.5);
    }
    halves.first.v.hi = halves.second.v.lo = cell.v.middle();
  }
  set_range(halves.first);
  set_range(halves.second);
  return halves;
}

/// True if the derivative of f = F / w along one parameter, stepping `stride` through the net, is positive throughout
/// or negative throughout. With G = F - c w, c a value of f, it is (G' w - G w') / w^2, and G is small in a small cell.
bool keeps_sign(const Cell& cell, bool along_u, double c) {
  const int stride = cell.degree_v + 1;
  const int step = along_u ? stride : 1;
  double lo = std::numeric_limits<double>::infinity();
  double hi = -lo, size = 0.0, slope = 0.0;
  double weight_lo = lo;
  for (int i = 0; i <= cell.degree_u; ++i) {
    for (int j = 0; j <= cell.degree_v; ++j) {
      const Vec2& p = cell.net[i * stride + j];
      size = std::max(size, std::abs(p[0] - c * p[1]));
      weight_lo = std::min(weight_lo, p[1]);
      if ((along_u ? i : j) == 0) continue;
      const Vec2 d = p - cell.net[i * stride + j - step];
      lo = std::min(lo, d[0] - c * d[1]);
      hi = std::max(hi, d[0] - c * d[1]);
      slope = std::max(slope, std::abs(d[1]));
    }
  }
  // Rounding of the differences: a few ulp of the coordinates.
  const double margin = size * slope / weight_lo + 1e-14 * (std::abs(c) + size);
  return lo > margin || hi < -margin;
}

/// Such a cell has no stationary point, so no maximum of the face but one on the border, which is known.
bool is_monotone(const Cell& cell) {
  const double c = 0.5 * (cell.bound + cell.floor);
  return keeps_sign(cell, true, c) || keeps_sign(cell, false, c);
}

double corner_value(const Cell& cell, bool high_u, bool high_v) {
  const int stride = cell.degree_v + 1;
  const Vec2& p = cell.net[(high_u ? cell.degree_u : 0) * stride + (high_v ? cell.degree_v : 0)];
  return p[0] / p[1];
}

class Search {
 public:
  Search(const RationalForm& form, const TrimRegion& region, double known, const ExtremumLimits& limits)
      : form_(form), region_(region), limits_(limits), best_(known) {}

  void add(Cell cell) {
    if (worth(cell, false)) queue_.push(std::move(cell));
  }

  Extremum run() {
    for (int boxes = 0; !queue_.empty(); ++boxes) {
      const Cell cell = queue_.top();
      queue_.pop();
      if (!worth(cell, false)) break;  // none of the rest is better
      if (is_monotone(cell)) continue;
      if (boxes >= limits_.max_boxes) return {best_, false, place_};
      examine(cell);
    }
    return {best_, true, place_};
  }

 private:
  /// Along the border the face may overshoot its edges by their tolerance; to chase that everywhere would take forever
  /// and mean nothing, unless it is most of what the cell varies.
  [[nodiscard]] bool worth(const Cell& cell, bool meets_border) const {
    double slack = limits_.accuracy;
    if (meets_border) slack = std::max(slack, std::min(limits_.border_accuracy, 1e-3 * (cell.bound - cell.floor)));
    return cell.bound > best_ + slack;
  }

  void examine(const Cell& cell) {
    // The nets' parameters map to the surface's by a monotone map of each, so corners map to corners.
    const Vec2 lo = form_.to_surface({cell.u.lo, cell.v.lo});
    const Vec2 hi = form_.to_surface({cell.u.hi, cell.v.hi});
    const Vec2 middle = 0.5 * (lo + hi);
    const Vec2 half = 0.5 * (hi - lo);
    const TrimRegion::Side side = region_.classify(middle, half);
    if (side == TrimRegion::Side::outside) return;
    const bool meets_border = side == TrimRegion::Side::on_boundary;
    if (!worth(cell, meets_border) || !(half.minCoeff() > 1e-14 * middle.cwiseAbs().maxCoeff())) return;
    auto [first, second] = halve(cell);
    for (const bool high_u : {false, true}) {
      for (const bool high_v : {false, true}) try_corner(cell, high_u, high_v, !meets_border);
    }
    add(std::move(first));
    add(std::move(second));
  }

  void try_corner(const Cell& cell, bool high_u, bool high_v, bool certain) {
    const double value = corner_value(cell, high_u, high_v);
    if (!(value > best_)) return;
    const Vec2 st{high_u ? cell.u.hi : cell.u.lo, high_v ? cell.v.hi : cell.v.lo};
    if (!certain && region_.classify(form_.to_surface(st)) != TrimRegion::Side::inside) return;
    best_ = value;
    place_ = st;
  }

  const RationalForm& form_;
  const TrimRegion& region_;
  const ExtremumLimits& limits_;
  double best_;
  std::optional<Vec2> place_;
  std::priority_queue<Cell> queue_;
};

}  // namespace

Extremum find_maximum(const RationalForm& form, const TrimRegion& region, const Vec3& direction, double known,
                      const ExtremumLimits& limits) {
  Search search(form, region, known, limits);
  for (const BezierPatch& patch : form.patches) {
    if (bound_of(patch, direction) > known + limits.accuracy) search.add(make_cell(patch, direction));
  }
  return search.run();
}

}  // namespace lamella
