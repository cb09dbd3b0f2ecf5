#include "model/winding_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "model/de_casteljau.h"

namespace lamella {
namespace {

/// Leaves are split until their strip is this part of their chord, but at most this often.
constexpr double kLeafFlatness = 1.0 / 8.0;
constexpr int kLeafDepth = 5;

/// Halvings after which a piece is as small as rounding allows, whatever its weights.
constexpr int kMaxHalvings = 64;

/// Control points from at most kMaxHalvings averagings are off by a few units in the last place of the largest
/// coordinate; the strips get this many.
constexpr double kRoundingUlps = 16.0;

Vec2 project(const Vec3& point) { return point.head<2>() / point[2]; }

double cross(const Vec2& a, const Vec2& b) { return a[0] * b[1] - a[1] * b[0]; }

/// The strip along the chord of a net that holds all its control points. `low` and `high` are distances to the left of
/// the chord times the chord's length: dividing would only round, and blur which side of a straight piece a point is
/// on.
struct Strip {
  Vec2 chord;
  double low = 0.0;
  double high = 0.0;
};

Strip strip_of(const Vec3* net, int degree) {
  const Vec2 begin = project(net[0]);
  const Vec2 chord = project(net[degree]) - begin;
  const bool closed = chord.isZero(0.0);
  Strip strip;
  strip.chord = closed ? Vec2(Vec2::UnitX()) : chord;
  for (int i = 1; i < degree; ++i) {
    const double distance = cross(strip.chord, project(net[i]) - begin);
    strip.low = std::min(strip.low, distance);
    strip.high = std::max(strip.high, distance);
  }
  return strip;
}

Box2 box_of(const Vec3* net, int degree) {
  Box2 box;
  for (int i = 0; i <= degree; ++i) box.extend(project(net[i]));
  return box;
}

/// Half the extent of a box of half-widths `half` across `chord`, times the chord's length.
double extent_across(const Vec2& chord, const Vec2& half) {
  return std::abs(chord[1]) * half[0] + std::abs(chord[0]) * half[1];
}

/// +1 for a run that goes up past the level of `point`, -1 down, 0 when both ends are on the same side of it.
int straddle(const Vec2& begin, const Vec2& end, const Vec2& point) {
  return static_cast<int>(begin[1] <= point[1] && point[1] < end[1]) -
         static_cast<int>(end[1] <= point[1] && point[1] < begin[1]);
}

}  // namespace

struct WindingTree::Query {
  Vec2 point;
  Vec2 tolerance;
  int winding = 0;
  bool on_boundary = false;

  [[nodiscard]] bool meets(const Box2& box) const {
    return point[0] >= box.min()[0] - tolerance[0] && point[0] <= box.max()[0] + tolerance[0] &&
           point[1] >= box.min()[1] - tolerance[1] && point[1] <= box.max()[1] + tolerance[1];
  }
  [[nodiscard]] bool touches(const Vec2& other) const {
    return std::abs(other[0] - point[0]) <= tolerance[0] && std::abs(other[1] - point[1]) <= tolerance[1];
  }

  /// A run that stays within a box away from the point winds as its chord does.
  void add_run(const Box2& box, const Vec2& begin, const Vec2& end) {
    if (box.min()[0] > point[0]) winding += straddle(begin, end, point);
  }

  /// A run that stays on one side of the point's parallel to its chord: `left` if the point is left of the chord.
  void add_chord(const Vec2& begin, const Vec2& end, bool left) {
    const int way = straddle(begin, end, point);
    if ((way > 0 && left) || (way < 0 && !left)) winding += way;
  }

  /// Decides by the strip if it can: true when done. A strip within the rounding is a straight line, and then the
  /// separating axes of box and segment leave only the boundary.
  [[nodiscard]] bool decide(const Vec2& chord, double low, double high, const Vec2& begin, const Vec2& end,
                            const Vec2& rounding) {
    const bool straight = low == 0.0 && high == 0.0;
    const double slack = straight ? 0.0 : extent_across(chord, rounding);
    const double reach = extent_across(chord, tolerance) + slack;
    const double side = cross(chord, point - begin);
    if (side > high + reach || side < low - reach) {
      add_chord(begin, end, side > 0.0);
      return true;
    }
    if (touches(begin) || touches(end) || straight) on_boundary = true;
    return on_boundary;
  }

  void bisect(const Vec3* net, int degree, const Vec2& rounding, int halvings);
};

/// Halves a piece until strips and boxes decide or nothing is left but rounding.
void WindingTree::Query::bisect(const Vec3* net, int degree, const Vec2& rounding, int halvings) {
  std::array<std::array<Vec3, kMaxDegree + 1>, 2> halves;
  std::copy(net, net + degree + 1, halves[0].begin());
  std::copy(net, net + degree + 1, halves[1].begin());
  split_in_place(halves[0].data(), halves[1].data(), degree, 1, 0.5);
  for (const auto& half : halves) {
    if (on_boundary) return;
    const Vec2 begin = project(half[0]);
    const Vec2 end = project(half[degree]);
    const Box2 box = box_of(half.data(), degree);
    if (!meets(box)) {
      add_run(box, begin, end);
      continue;
    }
    const Strip strip = strip_of(half.data(), degree);
    if (decide(strip.chord, strip.low, strip.high, begin, end, rounding)) continue;
    const bool thin = strip.high - strip.low <= extent_across(strip.chord, rounding);
    if (thin || halvings == 0) {
      (void)decide(strip.chord, 0.0, 0.0, begin, end, rounding);
    } else {
      bisect(half.data(), degree, rounding, halvings - 1);
    }
  }
}

std::optional<int> WindingTree::winding(const Vec2& point, const Vec2& tolerance) const {
  if (root_ < 0) return 0;
  Query query{point, tolerance};
  visit(root_, query);
  if (query.on_boundary) return std::nullopt;
  return query.winding;
}

void WindingTree::visit(int index, Query& query) const {
  const Node& node = nodes_[index];
  if (!query.meets(node.box)) {
    query.add_run(node.box, node.begin, node.end);
  } else if (node.leaf >= 0) {
    visit_leaf(node, query);
  } else {
    visit(node.left, query);
    if (!query.on_boundary) visit(node.right, query);
  }
}

void WindingTree::visit_leaf(const Node& node, Query& query) const {
  const Leaf& leaf = leaves_[node.leaf];
  if (query.decide(leaf.chord, leaf.low, leaf.high, node.begin, node.end, rounding_)) return;
  query.bisect(&points_[leaf.first], leaf.degree, rounding_, kMaxHalvings);
}

/// Fills a tree: leaves along each loop, a binary tree over each, and one over the loops.
class WindingTree::Builder {
 public:
  explicit Builder(WindingTree& tree) : tree_(tree) {}

  int add_loop(std::span<const BezierCurve2> pieces) {
    std::vector<int> run;
    for (const BezierCurve2& piece : pieces) add_leaves(piece.net, kLeafDepth, run);
    return join_run(run);
  }

  /// Groups closed loops by halving along the longer side of the box of their centres.
  int join_loops(std::span<int> loops) {
    if (loops.size() == 1) return loops[0];
    Box2 centres;
    for (const int loop : loops) centres.extend(tree_.nodes_[loop].box.center());
    int axis = 0;
    centres.sizes().maxCoeff(&axis);
    const auto middle = loops.begin() + static_cast<std::ptrdiff_t>(loops.size() / 2);
    std::nth_element(loops.begin(), middle, loops.end(), [&](int a, int b) {
      return tree_.nodes_[a].box.center()[axis] < tree_.nodes_[b].box.center()[axis];
    });
    const int left = join_loops(loops.first(loops.size() / 2));
    const int right = join_loops(loops.subspan(loops.size() / 2));
    // No chord: every loop below is closed.
    return add_node({merged(left, right), Vec2::Zero(), Vec2::Zero(), left, right, -1});
  }

 private:
  void add_leaves(const std::vector<Vec3>& net, int depth, std::vector<int>& run) {
    const int degree = static_cast<int>(net.size()) - 1;
    const Strip strip = strip_of(net.data(), degree);
    const Vec2 begin = project(net.front());
    const Vec2 end = project(net.back());
    if (depth > 0 && strip.high - strip.low > kLeafFlatness * strip.chord.squaredNorm()) {
      std::vector<Vec3> first = net;
      std::vector<Vec3> second = net;
      split_in_place(first.data(), second.data(), degree, 1, 0.5);
      add_leaves(first, depth - 1, run);
      add_leaves(second, depth - 1, run);
      return;
    }
    const int leaf = static_cast<int>(tree_.leaves_.size());
    const int offset = static_cast<int>(tree_.points_.size());
    tree_.leaves_.push_back({offset, degree, strip.chord, strip.low, strip.high});
    tree_.points_.insert(tree_.points_.end(), net.begin(), net.end());
    run.push_back(add_node({box_of(net.data(), degree), begin, end, -1, -1, leaf}));
  }

  int join_run(std::span<const int> run) {
    if (run.size() == 1) return run[0];
    const int left = join_run(run.first(run.size() / 2));
    const int right = join_run(run.subspan(run.size() / 2));
    return add_node({merged(left, right), tree_.nodes_[left].begin, tree_.nodes_[right].end, left, right, -1});
  }

  Box2 merged(int left, int right) const { return tree_.nodes_[left].box.merged(tree_.nodes_[right].box); }

  int add_node(const Node& node) {
    tree_.nodes_.push_back(node);
    return static_cast<int>(tree_.nodes_.size()) - 1;
  }

  WindingTree& tree_;
};

WindingTree::WindingTree(std::span<const BezierCurve2> pieces, std::span<const std::size_t> loop_begin) {
  Builder builder(*this);
  std::vector<int> loops;
  for (std::size_t k = 0; k < loop_begin.size(); ++k) {
    const std::size_t end = k + 1 < loop_begin.size() ? loop_begin[k + 1] : pieces.size();
    if (end > loop_begin[k]) loops.push_back(builder.add_loop(pieces.subspan(loop_begin[k], end - loop_begin[k])));
  }
  if (loops.empty()) return;
  root_ = builder.join_loops(loops);
  const Box2& box = nodes_[root_].box;
  rounding_ =
      kRoundingUlps * std::numeric_limits<double>::epsilon() * box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs());
}

}  // namespace lamella
