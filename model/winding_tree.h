#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/geometry.h"
#include "model/bezier.h"

namespace lamella {

/// Winding numbers of closed chains of rational Bezier pieces, in logarithmic time for points away from the chains.
///
/// A run of consecutive pieces within a box that doesn't hold the query point winds around it exactly as the straight
/// line between the run's ends does. So a tree over each chain needs to descend only where its boxes hold the point.
class WindingTree {
 public:
  WindingTree() = default;
  /// `loop_begin[k]` is the index of the first piece of loop k. Each loop's pieces join end to begin, the last to the
  /// first, bit for bit.
  WindingTree(std::span<const BezierCurve2> pieces, std::span<const std::size_t> loop_begin);

  /// Winding number of all loops around `point`; nothing when a loop comes within the box of half-widths `tolerance`
  /// around it. Crossings are counted along +u from the point, half open: a piece crosses when v of exactly one of
  /// its ends is at most the point's.
  [[nodiscard]] std::optional<int> winding(const Vec2& point, const Vec2& tolerance) const;

  [[nodiscard]] std::size_t leaf_count() const { return leaves_.size(); }

 private:
  /// A run of pieces; `begin` and `end` are its end points, equal for closed chains and groups of them.
  struct Node {
    Box2 box;
    Vec2 begin;
    Vec2 end;
    int left = -1;  ///< child nodes; a leaf has none
    int right = -1;
    int leaf = -1;  ///< index in leaves_
  };

  /// A nearly straight part of a piece and the strip along its chord that holds its control points.
  struct Leaf {
    int first = 0;  ///< in points_
    int degree = 0;
    Vec2 chord;        ///< from begin to end, any direction if they coincide
    double low = 0.0;  ///< least and largest distance of the control points to the left of the chord, times its length
    double high = 0.0;
  };

  struct Query;
  class Builder;

  void visit(int node, Query& query) const;
  void visit_leaf(const Node& node, Query& query) const;

  std::vector<Node> nodes_;
  std::vector<Leaf> leaves_;
  std::vector<Vec3> points_;      ///< homogeneous control points of the leaves
  Vec2 rounding_ = Vec2::Zero();  ///< bound of the rounding error of control points, per coordinate
  int root_ = -1;
};

}  // namespace lamella
