#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry.h"

namespace lamella::reference {

/// A binary tree of axis-aligned boxes (paper, step 3) for queries by whole lines.
class PatchTree {
 public:
  PatchTree() = default;
  /// Over `boxes`, each of which is enlarged by `margin` mm on every side. Item k of a query is boxes[k].
  PatchTree(std::span<const Box3> boxes, double margin);

  /// Appends the items whose box the line meets, ascending. No box that the line meets within `margin` is left out.
  void find(const Ray& line, std::vector<std::uint32_t>& items) const;

  [[nodiscard]] bool empty() const { return nodes_.empty(); }
  /// Box of everything, with the margin.
  [[nodiscard]] const Box3& bounds() const { return bounds_; }

 private:
  struct Node {
    Vec3 lower;
    Vec3 upper;
    std::uint32_t first = 0;  ///< leaf: its entry of `order_`; inner: the second child (the first is the next node)
    std::uint32_t count = 0;  ///< 1 for a leaf, 0 for an inner node
  };

  void build(std::span<const Box3> boxes, std::uint32_t first, std::uint32_t last, double margin);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
  Box3 bounds_;
};

/// Whether a whole line meets a box; NaN counts as meeting it.
[[nodiscard]] bool line_meets_box(const Ray& line, const Vec3& lower, const Vec3& upper);

}  // namespace lamella::reference
