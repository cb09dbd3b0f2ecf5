#include "slicing/span/sheet.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "slicing/span/depth_kernel.h"
#include "slicing/span/section_lanes.h"

namespace lamella::span {

namespace {

constexpr int kNodes = Sheet::kNodes;
constexpr std::size_t kNumbers = 12;  // of a piece: six coefficients of x, six of y
static_assert(sizeof(ArcPiece) == kNumbers * sizeof(double));

/// Places of the nodes in [-1, 1]: -cos(j pi / 4).
constexpr std::array<double, kNodes> kPlaces{-1.0, -0.70710678118654752, 0.0, 0.70710678118654752, 1.0};

/// Where the interpolation is measured: near the largest values of its remainder, between all neighbouring nodes.
constexpr std::array<double, 4> kProbes{-0.87, -0.35, 0.35, 0.87};

constexpr double kLargestTurn = 0.7;  // radians between neighbouring points

/// Accepted error, in tolerances: tracing keeps to one, so that a run has room for the interpolation.
constexpr double kAccepted = 4.0;

/// Errors beyond this multiple of what is accepted end the measuring.
constexpr double kHopeless = 100.0;

/// Corrections longer than a piece are not trusted.
constexpr MoveLimits kMoveLimits{0.0, 1.0, 6};

using NodeValues = std::array<double, kNodes>;

/// Turns values at kPlaces, [node][piece], into the monomial coefficients of the polynomials of degree 4 through them,
/// [power][piece]: with q = 1/2, p = a0 + a1 z + a2 z^2 + a3 z^3 + a4 z^4 splits into its even and odd parts.
void to_monomials(std::vector<ArcPiece>& numbers) {
  const std::size_t stride = numbers.size() / kNodes * kNumbers;
  double* f = numbers.front().x.data();
  for (std::size_t i = 0; i < stride; ++i) {
    const double f0 = f[i], f1 = f[i + stride], f2 = f[i + 2 * stride], f3 = f[i + 3 * stride], f4 = f[i + 4 * stride];
    const double even_1 = 0.5 * (f4 + f0) - f2;                  // a2 + a4
    const double even_q = 0.5 * (f3 + f1) - f2;                  // a2 q + a4 q^2
    const double odd_1 = 0.5 * (f4 - f0);                        // a1 + a3
    const double odd_q = 0.5 * (f3 - f1) / 0.70710678118654752;  // a1 + a3 q
    const double a4 = 2.0 * even_1 - 4.0 * even_q;
    const double a3 = 2.0 * (odd_1 - odd_q);
    f[i] = f2;
    f[i + stride] = odd_1 - a3;
    f[i + 2 * stride] = even_1 - a4;
    f[i + 3 * stride] = a3;
    f[i + 4 * stride] = a4;
  }
}

/// The pieces at a place in [-1, 1].
void blend(const std::vector<ArcPiece>& numbers, double place, std::vector<ArcPiece>& pieces) {
  depth_kernel().blend(numbers.front().x.data(), pieces.size() * kNumbers, place, pieces.front().x.data());
}

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
    numbers_.resize(kNodes * pieces);
    uv_numbers_.resize(kNodes * pieces);
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

  /// Anchors first, since the others are taken along by them.
  bool move_points(int node, double z) {
    const std::vector<std::int8_t>& axes = carried_.arc.axes;
    for (const bool anchors : {true, false}) {
      moving_.clear();
      for (std::size_t i = 1; i < carried_.arc.pieces.size(); ++i) {
        if ((axes[i] >= 0) == anchors) moving_.push_back(i);
      }
      for (std::size_t first = 0; first < moving_.size(); first += kLanes) {
        const std::size_t count = std::min<std::size_t>(kLanes, moving_.size() - first);
        if (!move_some({moving_.data() + first, count}, node, z)) return false;
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

  bool move_some(std::span<const std::size_t> numbers, int node, double z) {
    const TracedArc& arc = carried_.arc;
    std::array<MovingPoint, kLanes> moving;
    std::array<Vec2, kLanes> guesses;
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      const std::size_t i = numbers[k];
      Way& way = ways_[i];
      way.travel[node] = first_travel(way, node, z);
      guesses[k] = arc.points[i].uv + taken(way) + way.travel[node] * way.direction;
      moving[k].at = {guesses[k], arc.cells[i]};
      moving[k].way = way.direction;
      moving[k].scale = (points_[i].xy - points_[i - 1].xy).norm();
      moving[k].point = &points_[i];
    }
    span::move_points(surface_, sign_, z, kMoveLimits, {moving.data(), numbers.size()});
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      const std::size_t i = numbers[k];
      const MovingPoint& moved = moving[k];
      if (!moved.found || !surface_.holds(arc.cells[i], moved.at.uv, arc.axes[i])) return false;
      Way& way = ways_[i];
      way.travel[node] += way.direction.dot(moved.at.uv - guesses[k]) / way.direction.squaredNorm();
    }
    return true;
  }

  /// The first guess of a point that is taken along: what it lacks in height.
  [[nodiscard]] double first_travel(const Way& way, int node, double z) const {
    if (node > 1) return extrapolate(way.travel.data(), node);
    return way.after == way.before ? z - low_ : 0.0;
  }

  /// The pieces between the points as they are now become the values at a node.
  bool take_pieces(int node) {
    const std::vector<Cell>& cells = carried_.arc.cells;
    const std::size_t pieces = cells.size();
    for (std::size_t first = 0; first < pieces;) {
      PointRun run(surface_, sign_, points_[first]);
      for (std::size_t i = first; i < pieces; ++i) {
        if (!run.add(cells[i], points_[i + 1], cells[std::min(i + 1, pieces - 1)])) break;
      }
      PieceFits fits;
      join_run(run, kLargestTurn, fits);
      for (std::size_t k = 0; k < run.pieces(); ++k, ++first) {
        if (fits.errors[k] != 0.0) return false;
        numbers_[node * pieces + first] = fits.pieces[k];
        uv_numbers_[node * pieces + first] = fits.uv[k];
      }
    }
    return true;
  }

  /// The largest error, or one that is much too large, mm; infinite where a piece leaves its cell.
  double measure() {
    to_monomials(numbers_);
    to_monomials(uv_numbers_);
    const double hopeless = kHopeless * kAccepted * limits_.tolerance;
    double largest = 0.0;
    for (const double place : kProbes) {
      const double error = error_at(place);
      if (!(error <= largest)) largest = error;  // keeps NaN
      if (!(largest <= hopeless)) break;
    }
    return largest;
  }

  /// The same at one place between the nodes.
  [[nodiscard]] double error_at(double place) {
    const std::vector<Cell>& cells = carried_.arc.cells;
    const std::size_t pieces = cells.size();
    probed_.resize(pieces);
    uv_probed_.resize(pieces);
    blend(numbers_, place, probed_);
    blend(uv_numbers_, place, uv_probed_);
    DistanceMeter meter(surface_, height(place));
    for (std::size_t i = 0; i < pieces; ++i) {
      if (!stays_in_cell(surface_, cells[i], uv_probed_[i])) return std::numeric_limits<double>::infinity();
      const bool crosses = surface_.crosses_knot(points_[i].uv, points_[i + 1].uv, cells[i]);
      for (std::size_t m = 0; m < (crosses ? kMeasured.size() : 1); ++m) {
        meter.add({uv_probed_[i].at(kMeasured[m]), cells[i]}, probed_[i].at(kMeasured[m]));
      }
    }
    return meter.largest();
  }

  void store(std::vector<double>& coefficients) const {
    const double* first = numbers_.front().x.data();
    coefficients.assign(first, first + numbers_.size() * kNumbers);
  }

  void leave_at_top() {
    TracedArc& arc = carried_.arc;
    arc.points = points_;
    blend(numbers_, 1.0, arc.pieces);
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
  std::vector<ArcPiece> numbers_;  ///< [node or power][piece]
  std::vector<ArcPiece> uv_numbers_;
  std::vector<ArcPiece> probed_;  ///< between the nodes
  std::vector<ArcPiece> uv_probed_;
  std::vector<std::size_t> moving_;  ///< numbers of the points being moved
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
  depth_kernel().blend(coefficients_.data(), piece_count_ * kNumbers, place, pieces->x.data());
}

}  // namespace lamella::span
