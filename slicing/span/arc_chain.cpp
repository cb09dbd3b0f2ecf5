#include "slicing/span/arc_chain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace lamella::span {

namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// Directions at a node are taken this share of the nearest neighbouring point away from it: far beyond the gaps that
/// tolerances leave, near enough that arcs which are tangent in the node lie apart in the order of their curvatures.
constexpr double kLookAhead = 0.125;

/// Arcs in directions closer than this lie on one another; then there is no material between them.
constexpr double kCoincident = 1e-7;  // radians

bool comes_before(const Vec2& a, const Vec2& b) { return std::tie(a.x(), a.y()) < std::tie(b.x(), b.y()); }

class Chainer {
 public:
  explicit Chainer(const Section& section)
      : section_(section),
        next_(section.arcs.size(), kNone),
        fork_(section.arcs.size(), kNone),
        is_done_(section.arcs.size(), 0) {}

  ArcChains run() {
    collect();
    match_nodes();
    follow();
    return std::move(chains_);
  }

 private:
  /// An arc that leads into a node and one that leads out of it, with the material between them.
  struct Candidate {
    double angle;
    std::uint32_t in;
    std::uint32_t out;
  };

  const SectionArc& arc(std::uint32_t index) const { return section_.arcs[index]; }

  void collect() {
    for (std::uint32_t i = 0; i < section_.arcs.size(); ++i) {
      const SectionArc& a = arc(i);
      const bool has_extent = a.begin != a.end || (a.piece_count > 0 && !a.straight);
      if (!is_finite(a)) {
        ++chains_.unusable;
      } else if (has_extent) {
        by_begin_.push_back(i);
      }
    }
    std::sort(by_begin_.begin(), by_begin_.end(), [&](std::uint32_t a, std::uint32_t b) {
      if (arc(a).begin != arc(b).begin) return comes_before(arc(a).begin, arc(b).begin);
      if (arc(a).end != arc(b).end) return comes_before(arc(a).end, arc(b).end);
      return a < b;
    });
    drop_doubled();
    by_end_ = by_begin_;
    std::sort(by_end_.begin(), by_end_.end(), [&](std::uint32_t a, std::uint32_t b) {
      if (arc(a).end != arc(b).end) return comes_before(arc(a).end, arc(b).end);
      return a < b;
    });
  }

  bool is_finite(const SectionArc& a) const {
    if (!a.begin.allFinite() || !a.end.allFinite()) return false;
    for (std::uint32_t i = 0; i < a.piece_count; ++i) {
      const ArcPiece& piece = section_.pieces[a.first_piece + i];
      for (int k = 0; k < 6; ++k) {
        if (!std::isfinite(piece.x[k]) || !std::isfinite(piece.y[k])) return false;
      }
    }
    return true;
  }

  bool are_equal(std::uint32_t i, std::uint32_t j) const {
    const SectionArc& a = arc(i);
    const SectionArc& b = arc(j);
    if (a.begin != b.begin || a.end != b.end || a.piece_count != b.piece_count) return false;
    for (std::uint32_t k = 0; k < a.piece_count; ++k) {
      const ArcPiece& p = section_.pieces[a.first_piece + k];
      const ArcPiece& q = section_.pieces[b.first_piece + k];
      if (p.x != q.x || p.y != q.y) return false;
    }
    return true;
  }

  void drop_doubled() {
    std::vector<std::uint32_t> kept;
    for (const std::uint32_t i : by_begin_) {
      // Arcs with the same two ends stand together.
      bool doubled = false;
      for (auto k = kept.rbegin(); k != kept.rend() && !doubled; ++k) {
        if (arc(*k).begin != arc(i).begin || arc(*k).end != arc(i).end) break;
        doubled = are_equal(*k, i);
      }
      if (doubled) {
        ++chains_.doubled;
      } else {
        kept.push_back(i);
      }
    }
    by_begin_ = std::move(kept);
  }

  void match_nodes() {
    std::size_t out = 0;
    for (std::size_t in = 0; in < by_end_.size();) {
      const Vec2& node = arc(by_end_[in]).end;
      std::size_t last_in = in;
      while (last_in < by_end_.size() && arc(by_end_[last_in]).end == node) ++last_in;
      while (out < by_begin_.size() && comes_before(arc(by_begin_[out]).begin, node)) ++out;
      std::size_t last_out = out;
      while (last_out < by_begin_.size() && arc(by_begin_[last_out]).begin == node) ++last_out;
      if (last_in - in == 1 && last_out - out == 1) {
        next_[by_end_[in]] = by_begin_[out];
      } else if (last_out > out) {
        match_node({by_end_.data() + in, by_end_.data() + last_in},
                   {by_begin_.data() + out, by_begin_.data() + last_out}, node);
      }
      in = last_in;
      out = last_out;
    }
  }

  void match_node(const std::vector<std::uint32_t>& ins, const std::vector<std::uint32_t>& outs, const Vec2& node) {
    double radius = std::numeric_limits<double>::infinity();
    for (const std::uint32_t i : ins) radius = std::min(radius, reach(i, true, node));
    for (const std::uint32_t i : outs) radius = std::min(radius, reach(i, false, node));
    radius *= kLookAhead;
    std::vector<Candidate> candidates;
    for (const std::uint32_t in : ins) {
      const double from = direction(in, true, node, radius);
      for (const std::uint32_t out : outs) {
        // Material lies to the left of both, so clockwise from the arc that came in.
        double angle = from - direction(out, false, node, radius);
        angle -= kTwoPi * std::floor(angle / kTwoPi);
        if (angle < kCoincident) angle += kTwoPi;
        candidates.push_back({angle, in, out});
      }
    }
    std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
      return std::tie(a.angle, a.in, a.out) < std::tie(b.angle, b.in, b.out);
    });
    for (const std::uint32_t out : outs) fork_[out] = outs.front();
    std::vector<std::uint32_t> used;
    for (const Candidate& candidate : candidates) {
      if (next_[candidate.in] != kNone) continue;
      if (std::find(used.begin(), used.end(), candidate.out) != used.end()) continue;
      next_[candidate.in] = candidate.out;
      used.push_back(candidate.out);
    }
  }

  /// The point at `part` of the first piece, or of the last one counted backward.
  Vec2 look(std::uint32_t index, bool backward, double part) const {
    const SectionArc& a = arc(index);
    if (a.piece_count == 0)
      return backward ? Vec2(a.end + part * (a.begin - a.end)) : Vec2(a.begin + part * (a.end - a.begin));
    const std::uint32_t piece = backward ? a.first_piece + a.piece_count - 1 : a.first_piece;
    return section_.pieces[piece].at(backward ? 1.0 - part : part);
  }

  double reach(std::uint32_t index, bool backward, const Vec2& node) const {
    const double distance = (look(index, backward, 1.0) - node).norm();
    return distance > 0.0 ? distance : std::numeric_limits<double>::infinity();
  }

  /// Angle of the ray from the node to where the arc leaves the circle of this radius about it.
  double direction(std::uint32_t index, bool backward, const Vec2& node, double radius) const {
    double inside = 0.0;
    double outside = 1.0;
    for (int i = 0; i < 50; ++i) {
      const double middle = 0.5 * (inside + outside);
      ((look(index, backward, middle) - node).norm() < radius ? inside : outside) = middle;
    }
    const Vec2 ray = look(index, backward, outside) - node;
    return std::atan2(ray.y(), ray.x());
  }

  void follow() {
    std::vector<std::uint8_t> has_previous(next_.size(), 0);
    for (const std::uint32_t i : by_begin_) {
      if (next_[i] != kNone) has_previous[next_[i]] = 1;
    }
    std::vector<std::uint32_t> order = by_begin_;
    std::sort(order.begin(), order.end());
    for (const std::uint32_t i : order) {
      if (has_previous[i] == 0) follow_from(i, chains_.open);
    }
    for (const std::uint32_t i : order) {
      if (is_done_[i] == 0) follow_from(i, chains_.loops);
    }
    for (auto& loop : chains_.loops) std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
    std::sort(chains_.loops.begin(), chains_.loops.end());
  }

  /// Where a chain comes to a node for the second time, what lies between is a loop of its own.
  void follow_from(std::uint32_t first, std::vector<std::vector<std::uint32_t>>& lists) {
    std::vector<std::uint32_t> list;
    for (std::uint32_t i = first; i != kNone && is_done_[i] == 0; i = next_[i]) {
      is_done_[i] = 1;
      const auto seen = std::find_if(list.begin(), list.end(),
                                     [&](std::uint32_t k) { return fork_[i] != kNone && fork_[k] == fork_[i]; });
      if (seen != list.end()) {
        chains_.loops.emplace_back(seen, list.end());
        list.erase(seen, list.end());
      }
      list.push_back(i);
    }
    lists.push_back(std::move(list));
  }

  const Section& section_;
  std::vector<std::uint32_t> next_;  ///< the arc that follows each
  std::vector<std::uint32_t> fork_;  ///< of arcs that begin where others do too: the first of them
  std::vector<std::uint8_t> is_done_;
  std::vector<std::uint32_t> by_begin_;
  std::vector<std::uint32_t> by_end_;
  ArcChains chains_;
};

}  // namespace

ArcChains chain_arcs(const Section& section) { return Chainer(section).run(); }

}  // namespace lamella::span
