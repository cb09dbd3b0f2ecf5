#include "slicing/span/sheet.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "slicing/span/depth_kernel.h"

namespace lamella::span {

namespace {

constexpr int kNodes = Sheet::kNodes;
constexpr std::size_t kNumbers = 12;  // of a piece: six coefficients of x, six of y

/// Places of the nodes in [-1, 1]: -cos(j pi / 4).
constexpr std::array<double, kNodes> kPlaces{-1.0, -0.70710678118654752, 0.0, 0.70710678118654752, 1.0};

/// Where the interpolation is measured: near the largest values of its remainder, between all neighbouring nodes.
constexpr std::array<double, 4> kProbes{-0.87, -0.35, 0.35, 0.87};

constexpr double kLargestTurn = 0.7;  // radians between neighbouring points

/// Accepted error, in tolerances: tracing keeps to one, so that a run has room for the interpolation.
constexpr double kAccepted = 4.0;

/// Errors beyond this multiple of what is accepted end the measuring.
constexpr double kHopeless = 100.0;

/// Corrections up to this share of a piece are taken from the second derivatives, to third order.
constexpr double kExactShift = 1e-4;

using NodeValues = std::array<double, kNodes>;

/// Monomial coefficients of the polynomial of degree 4 through values at kPlaces: with q = 1/2,
/// p = a0 + a1 z + a2 z^2 + a3 z^3 + a4 z^4 splits into its even and odd parts.
NodeValues monomials(const NodeValues& f) {
  const double even_1 = 0.5 * (f[4] + f[0]) - f[2];                // a2 + a4
  const double even_q = 0.5 * (f[3] + f[1]) - f[2];                // a2 q + a4 q^2
  const double odd_1 = 0.5 * (f[4] - f[0]);                        // a1 + a3
  const double odd_q = 0.5 * (f[3] - f[1]) / 0.70710678118654752;  // a1 + a3 q
  const double a4 = 2.0 * even_1 - 4.0 * even_q;
  const double a3 = 2.0 * (odd_1 - odd_q);
  return {f[2], odd_1 - a3, even_1 - a4, a3, a4};
}

double value_at(const NodeValues& a, double z) { return a[0] + z * (a[1] + z * (a[2] + z * (a[3] + z * a[4]))); }

/// Extrapolates the values known at the first `count` places to the next one (Newton's divided differences).
double extrapolate(const double* values, int count) {
  std::array<double, kNodes> table{};
  std::copy(values, values + count, table.begin());
  for (int order = 1; order < count; ++order) {
    for (int i = count - 1; i >= order; --i) {
      table[i] = (table[i] - table[i - 1]) / (kPlaces[i] - kPlaces[i - order]);
    }
  }
  double result = table[count - 1];
  for (int i = count - 2; i >= 0; --i) result = table[i] + (kPlaces[count] - kPlaces[i]) * result;
  return result;
}

class Builder {
 public:
  Builder(const SectionSurface& surface, double sign, double low, double high, const TraceLimits& limits,
          CarriedArc& carried)
      : surface_(surface), sign_(sign), low_(low), high_(high), limits_(limits), carried_(carried) {}

  double run(const Sheet::EndsAt& ends_at, std::vector<double>& coefficients) {
    constexpr double kLost = std::numeric_limits<double>::infinity();
    const TracedArc& start = carried_.arc;
    points_ = start.points;
    const std::size_t pieces = start.pieces.size();
    numbers_.resize(pieces * kNumbers);
    uv_numbers_.resize(pieces * kNumbers);
    ways_.resize(points_.size());
    for (std::size_t i = 1; i < pieces; ++i) ways_[i].direction = rise_of(points_[i], start.axes[i]);
    find_anchors();
    if (!take_pieces(0)) return kLost;
    for (int j = 1; j < kNodes; ++j) {
      const double z = height(kPlaces[j]);
      SectionPoint begin, end;
      if (!ends_at(z, begin, end) || !place_end(0, begin, z) || !place_end(pieces, end, z)) return kLost;
      if (!move_points(j, z) || !take_pieces(j)) return kLost;
    }
    const double error = measure() / (kAccepted * limits_.tolerance);
    if (!(error <= 1.0)) return error;
    store(coefficients);
    leave_at_top();
    return error;
  }

 private:
  /// A point's straight way in (u, v): start + travel * direction. A point between two anchors is taken along by them,
  /// so that an arc whose ends slide keeps its points evenly spaced.
  struct Way {
    Vec2 direction = Vec2::Zero();
    NodeValues travel{};
    std::size_t before = 0;  ///< anchors: ends of the arc and points on cell limits
    std::size_t after = 0;
    double share = 0.0;  ///< of `after`
  };

  void find_anchors() {
    const TracedArc& arc = carried_.arc;
    const std::size_t last = arc.pieces.size();
    // A loop within the face has one end only; what that does says nothing of the others.
    const bool is_loop = (arc.points.front().uv - arc.points.back().uv).norm() < 1e-9;
    for (std::size_t first = 0; first < last;) {
      std::size_t next = first + 1;
      while (next < last && arc.axes[next] < 0) ++next;
      for (std::size_t i = first + 1; i < next && !is_loop; ++i) {
        ways_[i].before = first;
        ways_[i].after = next;
        ways_[i].share = static_cast<double>(i - first) / static_cast<double>(next - first);
      }
      first = next;
    }
  }

  bool move_points(int node, double z) {
    const std::vector<std::int8_t>& axes = carried_.arc.axes;
    for (const bool anchors : {true, false}) {
      for (std::size_t i = 1; i < carried_.arc.pieces.size(); ++i) {
        if ((axes[i] >= 0) == anchors && !move_point(i, node, z)) return false;
      }
    }
    return true;
  }

  /// How far its anchors take a point along.
  [[nodiscard]] Vec2 taken(const Way& way) const {
    if (way.after == way.before) return Vec2::Zero();
    const std::vector<SectionPoint>& from = carried_.arc.points;
    return (1.0 - way.share) * (points_[way.before].uv - from[way.before].uv) +
           way.share * (points_[way.after].uv - from[way.after].uv);
  }

  [[nodiscard]] double height(double place) const { return 0.5 * (low_ + high_) + 0.5 * (high_ - low_) * place; }

  bool place_end(std::size_t i, const SectionPoint& given, double z) {
    const Cell& cell = carried_.arc.cells[std::min(i, carried_.arc.cells.size() - 1)];
    const Vec2& periods = surface_.periods();
    Vec2 uv = given.uv;
    for (int axis = 0; axis < 2; ++axis) {
      if (periods[axis] > 0.0) uv[axis] += periods[axis] * std::round((points_[i].uv[axis] - uv[axis]) / periods[axis]);
    }
    if (!surface_.holds(cell, uv, -1)) return false;
    points_[i] = surface_.has_cells() ? section_point(surface_.evaluate(uv, cell), uv, sign_) : given;
    points_[i].uv = uv;
    points_[i].z = z;
    return points_[i].uv_bend.allFinite();
  }

  bool move_point(std::size_t i, int node, double z) {
    Way& way = ways_[i];
    const Vec2 from = carried_.arc.points[i].uv + taken(way);
    const Cell& cell = carried_.arc.cells[i];
    const double scale = (points_[i].xy - points_[i - 1].xy).norm();
    // The first guess of a point that is taken along: what it lacks in height.
    double travel = node == 1 ? (way.after == way.before ? z - low_ : 0.0) : extrapolate(way.travel.data(), node);
    SurfacePoint2 at;
    double step = 0.0;
    for (int attempt = 0;; ++attempt) {
      const Vec2 uv = from + travel * way.direction;
      at = surface_.evaluate(uv, cell);
      const Vec3 along = at.du * way.direction[0] + at.dv * way.direction[1];
      step = (z - at.point.z()) / along.z();
      const double off = std::abs(step) * along.norm();
      if (!(off <= scale) || attempt == 5) return false;
      travel += step;
      if (off <= kExactShift * scale) break;
    }
    const Vec2 uv = from + travel * way.direction;
    if (!surface_.holds(cell, uv, carried_.arc.axes[i])) return false;
    way.travel[node] = travel;
    shift(at, step * way.direction);
    points_[i] = section_point(at, uv, sign_);
    points_[i].z = z;
    return points_[i].uv_bend.allFinite();
  }

  /// The pieces between the points as they are now become the values at a node.
  bool take_pieces(int node) {
    const std::vector<Cell>& cells = carried_.arc.cells;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const SectionPoint& a = points_[i];
      SectionPoint b = points_[i + 1];
      if (i + 1 < cells.size() && !(cells[i] == cells[i + 1])) {
        b = section_point(surface_.evaluate(b.uv, cells[i]), b.uv, sign_);
      }
      if (!(a.tangent.dot(b.tangent) > std::cos(kLargestTurn))) return false;
      ArcPiece piece;
      ArcPiece uv;
      if (!join_points(a, b, piece, uv)) return false;
      for (int k = 0; k < 6; ++k) {
        numbers_[i * kNumbers + k][node] = piece.x[k];
        numbers_[i * kNumbers + 6 + k][node] = piece.y[k];
        uv_numbers_[i * kNumbers + k][node] = uv.x[k];
        uv_numbers_[i * kNumbers + 6 + k][node] = uv.y[k];
      }
    }
    return true;
  }

  /// The largest error, or the first that is much too large, mm; infinite where a piece leaves its cell.
  double measure() {
    for (NodeValues& values : numbers_) values = monomials(values);
    for (NodeValues& values : uv_numbers_) values = monomials(values);
    const double hopeless = kHopeless * kAccepted * limits_.tolerance;
    double largest = 0.0;
    for (std::size_t i = 0; i < carried_.arc.cells.size(); ++i) {
      if (!stays_in_cell(i)) return std::numeric_limits<double>::infinity();
      largest = std::max(largest, error_of(i));
      if (!(largest <= hopeless)) break;
    }
    return largest;
  }

  [[nodiscard]] double error_of(std::size_t piece) const {
    const Cell& cell = carried_.arc.cells[piece];
    const bool crosses = surface_.crosses_knot(points_[piece].uv, points_[piece + 1].uv, cell);
    double largest = 0.0;
    for (std::size_t m = 0; m < (crosses ? kMeasured.size() : 1); ++m) {
      for (const double place : kProbes) {
        const double error = error_at(piece, m, place);
        if (!(error <= largest)) largest = error;  // keeps NaN
      }
    }
    return largest;
  }

  /// Whether a piece stays within its cell where the sheet is measured.
  [[nodiscard]] bool stays_in_cell(std::size_t piece) const {
    if (!surface_.is_divided()) return true;
    const Cell& cell = carried_.arc.cells[piece];
    for (const double place : kProbes) {
      ArcPiece uv;
      for (int k = 0; k < 6; ++k) {
        uv.x[k] = value_at(uv_numbers_[piece * kNumbers + k], place);
        uv.y[k] = value_at(uv_numbers_[piece * kNumbers + 6 + k], place);
      }
      if (!span::stays_in_cell(surface_, cell, uv)) return false;
    }
    return true;
  }

  /// Horizontal distance of a measured place of a piece from the surface, to first order about the point of its (u, v).
  [[nodiscard]] double error_at(std::size_t piece, std::size_t measured, double place) const {
    const double t = kMeasured[measured];
    const Vec2 uv = point_at(uv_numbers_, piece, t, place);
    const SurfacePoint at = surface_.evaluate_slopes(uv, carried_.arc.cells[piece]);
    Vec3 point(0.0, 0.0, height(place));
    point.head<2>() = point_at(numbers_, piece, t, place);
    const Vec3 normal = at.normal();
    return std::abs(normal.dot(point - at.point)) / normal.head<2>().norm();
  }

  /// A point of a piece, once its numbers are monomials in the place.
  [[nodiscard]] static Vec2 point_at(const std::vector<NodeValues>& numbers, std::size_t piece, double t,
                                     double place) {
    Vec2 point = Vec2::Zero();
    for (int k = 5; k >= 0; --k) {
      point = point * t +
              Vec2(value_at(numbers[piece * kNumbers + k], place), value_at(numbers[piece * kNumbers + 6 + k], place));
    }
    return point;
  }

  void store(std::vector<double>& coefficients) const {
    const std::size_t stride = numbers_.size();
    coefficients.resize(kNodes * stride);
    for (std::size_t i = 0; i < stride; ++i) {
      for (int power = 0; power < kNodes; ++power) coefficients[power * stride + i] = numbers_[i][power];
    }
  }

  void leave_at_top() {
    TracedArc& arc = carried_.arc;
    arc.points = points_;
    for (std::size_t i = 0; i < arc.pieces.size(); ++i) {
      for (int k = 0; k < 6; ++k) {
        arc.pieces[i].x[k] = value_at(numbers_[i * kNumbers + k], 1.0);
        arc.pieces[i].y[k] = value_at(numbers_[i * kNumbers + 6 + k], 1.0);
      }
    }
    carried_.start(high_);
  }

  const SectionSurface& surface_;
  double sign_;
  double low_;
  double high_;
  const TraceLimits& limits_;
  CarriedArc& carried_;
  std::vector<SectionPoint> points_;  ///< at the node being worked on
  std::vector<Way> ways_;
  std::vector<NodeValues> numbers_;
  std::vector<NodeValues> uv_numbers_;
};

}  // namespace

double Sheet::build(const SectionSurface& surface, double sign, double low, double high, const TraceLimits& limits,
                    const EndsAt& ends_at, CarriedArc& carried) {
  clear();
  // Layers that were settled on one height are no run.
  if (!(high > low)) return std::numeric_limits<double>::infinity();
  const double error = Builder(surface, sign, low, high, limits, carried).run(ends_at, coefficients_);
  // Written so that NaN fails.
  if (!(error <= 1.0)) {
    clear();
    return std::isnan(error) ? std::numeric_limits<double>::infinity() : error;
  }
  low_ = low;
  high_ = high;
  piece_count_ = carried.arc.pieces.size();
  return error;
}

void Sheet::evaluate(double z, ArcPiece* pieces) const {
  const double place = (2.0 * z - low_ - high_) / (high_ - low_);
  static_assert(sizeof(ArcPiece) == kNumbers * sizeof(double));
  depth_kernel().blend(coefficients_.data(), piece_count_ * kNumbers, place, pieces->x.data());
}

}  // namespace lamella::span
