#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/geometry.h"

namespace lamella {

/// A binary tree over boxes for searches by distance from a point, halved at the median of the longer side.
class BoxTree {
 public:
  BoxTree() = default;
  explicit BoxTree(std::span<const Box3> boxes);

  /// Calls visit(item, limit) for items whose box comes nearer to `point` than `limit`, near ones first; `visit`
  /// returns the limit from then on, squared distances in mm^2.
  template <class Visit>
  void search(const Vec3& point, double squared_limit, const Visit& visit) const;

  [[nodiscard]] bool empty() const { return nodes_.empty(); }
  /// Box of everything.
  [[nodiscard]] const Box3& bounds() const { return nodes_.front().box; }

 private:
  struct Node {
    Box3 box;
    std::uint32_t item = 0;    ///< of a leaf
    std::uint32_t second = 0;  ///< the second child, the first is the next node; 0 of a leaf
  };

  void build(std::span<const Box3> boxes, std::span<std::uint32_t> items);

  std::vector<Node> nodes_;
};

template <class Visit>
void BoxTree::search(const Vec3& point, double squared_limit, const Visit& visit) const {
  if (nodes_.empty()) return;
  struct Open {
    std::uint32_t node;
    double squared_distance;
  };
  // Halving keeps the depth below 64 for any number of items.
  Open open[64];
  int count = 0;
  open[count++] = {0, nodes_.front().box.squaredExteriorDistance(point)};
  while (count > 0) {
    const Open top = open[--count];
    if (!(top.squared_distance < squared_limit)) continue;
    const Node& node = nodes_[top.node];
    if (node.second == 0) {
      squared_limit = visit(node.item, squared_limit);
      continue;
    }
    Open first{top.node + 1, nodes_[top.node + 1].box.squaredExteriorDistance(point)};
    Open second{node.second, nodes_[node.second].box.squaredExteriorDistance(point)};
    if (first.squared_distance < second.squared_distance) std::swap(first, second);
    open[count++] = first;
    open[count++] = second;
  }
}

}  // namespace lamella
