#include "materials/distance_row.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella {

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Of the size of the part.
constexpr double kLongestPart = 1.0 / 16.0;

/// Times the depth to which distances count.
constexpr double kDepthSteps = 2.0;

/// mm: where the distance has a corner, on the medial axis, it is cut off no farther from it than this.
constexpr double kShortest = 1e-3;

/// A corner is guessed where the slopes differ by this much.
constexpr double kLeastTurn = 0.1;

/// A cubic is judged by a point that leaves at most this part of the interval on one side.
constexpr double kCentred = 0.7;

/// On the surface itself the direction to the nearest point is rounding, so the slope is taken from this far on, mm.
constexpr double kOnSurface = 1e-6;
constexpr double kNudge = 1e-4;

/// Rounding of a bound on a distance, relative to it and in mm.
constexpr double kBoundSlack = 1e-9;

}  // namespace

DistanceRow::DistanceRow(const PartDistance& distance, const DistanceLimits& limits)
    : distance_(distance),
      limits_(limits),
      step_(std::min(kLongestPart * distance.size(), kDepthSteps * limits.farthest)) {}

/// `most` bounds the distance, or is what counts of it.
DistanceRow::Node DistanceRow::node_at(double x, double most) {
  const Vec3 point = piece_.origin + x * piece_.along;
  ++queries_;
  const auto found = distance_.find(point, most * (1.0 + kBoundSlack) + kBoundSlack);
  if (!found) return {x, kInfinite};
  const double slope = found->distance > 0.0 ? (point - found->point).dot(piece_.along) / found->distance : 0.0;
  return {x, found->distance, slope, found->point};
}

/// An end of the piece usually lies on the surface.
DistanceRow::Node DistanceRow::end_node(double x, double toward) {
  Node node = node_at(x, limits_.farthest + step_);
  if (!(node.distance < kOnSurface)) return node;
  const double inner = x + std::clamp(toward - x, -kNudge, kNudge);
  const Node next = node_at(inner, node.distance + kNudge);
  if (next.distance < kInfinite && inner != x) node.slope = (next.distance - node.distance) / (inner - x);
  return node;
}

double DistanceRow::cubic(const Node& from, const Node& to, double x) {
  const double length = to.x - from.x;
  const double t = (x - from.x) / length;
  const double s = 1.0 - t;
  return s * s * (1.0 + 2.0 * t) * from.distance + t * t * (1.0 + 2.0 * s) * to.distance +
         s * t * length * (s * from.slope - t * to.slope);
}

/// Bounds the distance at `x` by that of the point that is nearest to another place.
double DistanceRow::farthest_from(const Node& node, double x) const {
  return node.distance < kInfinite ? (piece_.origin + x * piece_.along - node.foot).norm() : kInfinite;
}

/// Where to look between two nodes: at the corner that their tangents make if they turn as at the medial axis, where
/// another part of the surface becomes the nearest, else in the middle.
double DistanceRow::split(const Node& from, const Node& to) {
  const double middle = 0.5 * (from.x + to.x);
  const double turn = from.slope - to.slope;
  const bool is_known = from.distance < kInfinite && to.distance < kInfinite;
  if (!is_known || !(turn > kLeastTurn) || to.x - from.x < 2.0 * kShortest) return middle;
  const double corner = from.x + (to.distance - from.distance - to.slope * (to.x - from.x)) / turn;
  return std::clamp(corner, from.x + kShortest, to.x - kShortest);
}

/// Appends the nodes behind `from` up to `to`. A distance can't change by more than the way that is gone: so an
/// interval is deep if it is farther than `farthest` by half its length in the middle.
void DistanceRow::refine(const Node& from, const Node& to, bool may_guess) {
  const double length = to.x - from.x;
  const double x = may_guess ? split(from, to) : 0.5 * (from.x + to.x);
  const double reach = limits_.farthest + std::max(0.5 * length, step_);
  const Node inner = node_at(x, std::min({farthest_from(from, x), farthest_from(to, x), reach}));
  const double wider = std::max(x - from.x, to.x - x);
  const bool is_short = length <= kShortest;
  const bool may_be_deep = from.distance >= limits_.farthest && to.distance >= limits_.farthest;
  if (may_be_deep && (inner.distance >= limits_.farthest + wider || is_short)) {
    nodes_.back().is_deep = true;
    nodes_.push_back(to);
    return;
  }
  const bool is_known = from.distance < kInfinite && inner.distance < kInfinite && to.distance < kInfinite;
  const bool is_centred = wider <= kCentred * length;
  const bool is_smooth =
      is_known && length <= step_ && is_centred && std::abs(cubic(from, to, x) - inner.distance) <= limits_.tolerance;
  if (is_smooth || (is_known && is_short)) {
    nodes_.push_back(inner);
    nodes_.push_back(to);
    return;
  }
  // A guess that was far off leaves nearly all: halving comes next.
  refine(from, inner, is_centred || inner.x - from.x < wider);
  refine(inner, to, is_centred || to.x - inner.x < wider);
}

void DistanceRow::build(const RowPiece& piece) {
  piece_ = piece;
  const Node from = end_node(piece.range.lo, piece.range.hi);
  nodes_.assign(1, from);
  if (!(piece.range.lo < piece.range.hi)) return;
  const Node to = end_node(piece.range.hi, piece.range.lo);
  refine(from, to, true);
}

double DistanceRow::at(double x) const {
  const auto above = std::upper_bound(nodes_.begin(), nodes_.end(), x, [](double v, const Node& n) { return v < n.x; });
  if (above == nodes_.begin()) return std::min(nodes_.front().distance, limits_.farthest);
  const Node& from = *(above - 1);
  if (above == nodes_.end()) return std::min(from.distance, limits_.farthest);
  if (from.is_deep) return limits_.farthest;
  return std::clamp(cubic(from, *above, x), 0.0, limits_.farthest);
}

}  // namespace lamella
