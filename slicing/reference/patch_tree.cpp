#include "slicing/reference/patch_tree.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

namespace lamella::reference {

namespace {

/// Median splits halve the items, so 2^64 items would be needed to exceed this.
constexpr std::size_t kMaxDepth = 64;

}  // namespace

bool line_meets_box(const Ray& line, const Vec3& lower, const Vec3& upper) {
  double enter = -std::numeric_limits<double>::infinity();
  double leave = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double o = line.origin[axis];
    const double d = line.direction[axis];
    if (d == 0.0) {
      if (o < lower[axis] || o > upper[axis]) return false;
      continue;
    }
    const double a = (lower[axis] - o) / d;
    const double b = (upper[axis] - o) / d;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return !(enter > leave);
}

PatchTree::PatchTree(std::span<const Box3> boxes, double margin) : order_(boxes.size()) {
  if (boxes.empty()) return;
  std::iota(order_.begin(), order_.end(), 0U);
  nodes_.reserve(2 * boxes.size());
  build(boxes, 0, static_cast<std::uint32_t>(boxes.size()), margin);
  bounds_ = Box3(nodes_.front().lower, nodes_.front().upper);
}

void PatchTree::build(std::span<const Box3> boxes, std::uint32_t first, std::uint32_t last, double margin) {
  Box3 all;
  Box3 centers;
  for (std::uint32_t k = first; k < last; ++k) {
    all.extend(boxes[order_[k]]);
    centers.extend(boxes[order_[k]].center());
  }
  const std::size_t self = nodes_.size();
  nodes_.push_back({all.min() - Vec3::Constant(margin), all.max() + Vec3::Constant(margin), first, last - first});
  if (last - first == 1) return;
  int axis = 0;
  centers.sizes().maxCoeff(&axis);
  const std::uint32_t middle = first + (last - first) / 2;
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double ca = boxes[a].center()[axis];
                     const double cb = boxes[b].center()[axis];
                     return ca < cb || (ca == cb && a < b);
                   });
  nodes_[self].count = 0;
  build(boxes, first, middle, margin);
  nodes_[self].first = static_cast<std::uint32_t>(nodes_.size());
  build(boxes, middle, last, margin);
}

void PatchTree::find(const Ray& line, std::vector<std::uint32_t>& items) const {
  if (nodes_.empty()) return;
  const std::size_t found = items.size();
  std::array<std::uint32_t, kMaxDepth> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t index = stack[--depth];
    const Node& node = nodes_[index];
    if (!line_meets_box(line, node.lower, node.upper)) continue;
    if (node.count > 0) {
      items.insert(items.end(), order_.begin() + node.first, order_.begin() + node.first + node.count);
    } else {
      stack[depth++] = node.first;
      stack[depth++] = index + 1;
    }
  }
  std::sort(items.begin() + static_cast<std::ptrdiff_t>(found), items.end());
}

}  // namespace lamella::reference
