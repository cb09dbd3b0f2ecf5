#include "export/triangulate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace lamella {

namespace {

/// Positive where a, b, c turn left.
double cross(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Whether the triangle, counterclockwise, holds p; its sides belong to it.
bool holds(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& p) {
  return cross(a, b, p) >= 0.0 && cross(b, c, p) >= 0.0 && cross(c, a, p) >= 0.0;
}

/// One outer loop as a ring of nodes, into which the holes are led by bridges, and which is then clipped ear by ear.
class EarClipper {
 public:
  std::vector<Triangle> run(std::span<const std::span<const Vec2>> loops) {
    std::vector<std::size_t> holes;
    std::uint32_t first_point = 0;
    for (std::size_t i = 0; i < loops.size(); ++i) {
      const std::size_t first = add_ring(loops[i], first_point);
      if (i > 0) holes.push_back(leftmost(first));
      first_point += static_cast<std::uint32_t>(loops[i].size());
    }
    // A hole further left may stand between the outer loop and those behind it.
    std::sort(holes.begin(), holes.end(), [&](std::size_t a, std::size_t b) {
      return std::pair(at(a).x(), at(a).y()) < std::pair(at(b).x(), at(b).y());
    });
    for (const std::size_t hole : holes) join(bridge_end(hole), hole);
    clip();
    return std::move(triangles_);
  }

 private:
  struct Node {
    Vec2 point;
    std::uint32_t number = 0;
    std::size_t previous = 0;
    std::size_t next = 0;
  };

  [[nodiscard]] const Vec2& at(std::size_t node) const { return nodes_[node].point; }
  [[nodiscard]] std::size_t next(std::size_t node) const { return nodes_[node].next; }
  [[nodiscard]] std::size_t previous(std::size_t node) const { return nodes_[node].previous; }

  std::size_t add_ring(std::span<const Vec2> loop, std::uint32_t first_point) {
    const std::size_t first = nodes_.size();
    const std::size_t count = loop.size();
    for (std::size_t i = 0; i < count; ++i) {
      nodes_.push_back({loop[i], first_point + static_cast<std::uint32_t>(i), first + (i + count - 1) % count,
                        first + (i + 1) % count});
    }
    return first;
  }

  [[nodiscard]] std::size_t leftmost(std::size_t first) const {
    std::size_t best = first;
    for (std::size_t node = next(first); node != first; node = next(node)) {
      if (std::pair(at(node).x(), at(node).y()) < std::pair(at(best).x(), at(best).y())) best = node;
    }
    return best;
  }

  /// Whether the line from a node to b starts into what the ring encloses.
  [[nodiscard]] bool opens_to(std::size_t node, const Vec2& b) const {
    const Vec2& a = at(node);
    const Vec2& before = at(previous(node));
    const Vec2& behind = at(next(node));
    if (cross(before, a, behind) > 0.0) return cross(a, b, behind) <= 0.0 && cross(a, before, b) <= 0.0;
    return cross(a, b, before) > 0.0 || cross(a, behind, b) > 0.0;
  }

  /// The node of the outer ring that a hole's leftmost point sees: on the side that a ray to the left meets first, or
  /// before that side.
  [[nodiscard]] std::size_t bridge_end(std::size_t hole) const {
    const Vec2& h = at(hole);
    double met = -std::numeric_limits<double>::infinity();
    std::optional<std::size_t> end;
    std::size_t node = 0;
    do {
      const Vec2& a = at(node);
      const Vec2& b = at(next(node));
      if (a == h) return node;
      if (h.y() <= a.y() && h.y() >= b.y() && a.y() != b.y()) {
        const double x = a.x() + (h.y() - a.y()) * (b.x() - a.x()) / (b.y() - a.y());
        if (x <= h.x() && x > met) {
          met = x;
          end = a.x() < b.x() ? node : next(node);
        }
      }
      node = next(node);
    } while (node != 0);
    // Only loops that cross leave a hole without an outer ring to its left.
    return end ? nearest_seen(hole, met, *end) : 0;
  }

  /// Of the nodes within the triangle of hole, met side and its end the one that the hole's point sees at the smallest
  /// angle to the ray.
  [[nodiscard]] std::size_t nearest_seen(std::size_t hole, double met, std::size_t end) const {
    const Vec2 h = at(hole);
    const Vec2 m = at(end);
    const Vec2 foot(met, h.y());
    if (foot == h) return end;
    const bool is_below = h.y() < m.y();
    double smallest = std::numeric_limits<double>::infinity();
    std::size_t best = end;
    std::size_t node = end;
    do {
      const Vec2& p = at(node);
      const bool is_between = h.x() > p.x() && p.x() >= std::min(m.x(), met);
      if (is_between && (is_below ? holds(foot, h, m, p) : holds(h, foot, m, p)) && opens_to(node, h)) {
        const double tangent = std::abs(h.y() - p.y()) / (h.x() - p.x());
        if (tangent < smallest || (tangent == smallest && p.x() > at(best).x())) {
          smallest = tangent;
          best = node;
        }
      }
      node = next(node);
    } while (node != end);
    return best;
  }

  /// Leads the ring from `outer` to the hole, around it, and back.
  void join(std::size_t outer, std::size_t hole) {
    const std::size_t outer_again = nodes_.size();
    const std::size_t hole_again = outer_again + 1;
    nodes_.push_back({at(outer), nodes_[outer].number, hole_again, next(outer)});
    nodes_.push_back({at(hole), nodes_[hole].number, previous(hole), outer_again});
    nodes_[next(outer)].previous = outer_again;
    nodes_[previous(hole)].next = hole_again;
    nodes_[outer].next = hole;
    nodes_[hole].previous = outer;
  }

  [[nodiscard]] bool is_ear(std::size_t node) const {
    const std::size_t before = previous(node);
    const std::size_t behind = next(node);
    const Vec2& a = at(before);
    const Vec2& b = at(node);
    const Vec2& c = at(behind);
    if (!(cross(a, b, c) > 0.0)) return false;
    for (std::size_t other = next(behind); other != before; other = next(other)) {
      const Vec2& p = at(other);
      if (p == a || p == b || p == c || !holds(a, b, c, p)) continue;
      if (!(cross(at(previous(other)), p, at(next(other))) > 0.0)) return false;
    }
    return true;
  }

  void cut(std::size_t node) {
    triangles_.push_back({nodes_[previous(node)].number, nodes_[node].number, nodes_[next(node)].number});
    nodes_[previous(node)].next = next(node);
    nodes_[next(node)].previous = previous(node);
    --left_;
  }

  [[nodiscard]] double turn(std::size_t node) const { return cross(at(previous(node)), at(node), at(next(node))); }

  /// Where loops touch, a bridge may run along a side: its corner, between points in line, is an ear without area. Any
  /// other corner keeps the surface closed, too.
  [[nodiscard]] std::size_t best_without_ear(std::size_t first) const {
    std::size_t best = first;
    std::size_t node = first;
    do {
      if (turn(node) == 0.0) return node;
      if (turn(node) > 0.0 && !(turn(best) > 0.0)) best = node;
      node = next(node);
    } while (node != first);
    return best;
  }

  void clip() {
    left_ = 1;
    std::size_t node = 0;
    for (std::size_t i = next(0); i != 0; i = next(i)) ++left_;
    for (std::size_t failures = 0; left_ > 3;) {
      if (failures > left_) node = best_without_ear(node);
      if (failures > left_ || is_ear(node)) {
        cut(node);
        failures = 0;
      } else {
        ++failures;
      }
      node = next(node);
    }
    if (left_ == 3) cut(node);
  }

  std::vector<Node> nodes_;
  std::size_t left_ = 0;
  std::vector<Triangle> triangles_;
};

}  // namespace

std::vector<Triangle> triangulate(std::span<const std::span<const Vec2>> loops) { return EarClipper().run(loops); }

}  // namespace lamella
