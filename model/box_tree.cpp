#include "model/box_tree.h"

#include <numeric>

namespace lamella {

BoxTree::BoxTree(std::span<const Box3> boxes) {
  std::vector<std::uint32_t> items(boxes.size());
  std::iota(items.begin(), items.end(), 0U);
  nodes_.reserve(2 * boxes.size());
  if (!items.empty()) build(boxes, items);
}

void BoxTree::build(std::span<const Box3> boxes, std::span<std::uint32_t> items) {
  const std::size_t self = nodes_.size();
  nodes_.emplace_back();
  Box3 centers;
  for (const std::uint32_t item : items) {
    nodes_[self].box.extend(boxes[item]);
    centers.extend(boxes[item].center());
  }
  if (items.size() == 1) {
    nodes_[self].item = items.front();
    return;
  }
  int axis = 0;
  centers.sizes().maxCoeff(&axis);
  const std::size_t half = items.size() / 2;
  // Items with equal centres keep an order of their own, so that a tree is the same on every platform.
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(half), items.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double x = boxes[a].center()[axis];
                     const double y = boxes[b].center()[axis];
                     return x < y || (x == y && a < b);
                   });
  build(boxes, items.first(half));
  nodes_[self].second = static_cast<std::uint32_t>(nodes_.size());
  build(boxes, items.subspan(half));
}

}  // namespace lamella
