#include "slicing/span/loop_nesting.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/bernstein_roots.h"
#include "slicing/span/quintic.h"

namespace lamella::span {

namespace {

/// Where in the height of a loop it is probed: not the middle, where symmetric parts have their nodes.
constexpr double kProbe = 0.4871;

/// A bound of |c(t) - c(0)| over [0, 1].
double largest_move(const Quintic& c) {
  double sum = 0.0;
  for (std::size_t k = 1; k < c.size(); ++k) sum += std::abs(c[k]);
  return sum;
}

/// Crossings of the line y = row with arcs, by the half-open rule of the rows, closed in integers on every loop.
class RowCrossings {
 public:
  RowCrossings(const Section& section, double row) : section_(section), row_(row) {}

  /// Calls visit(x, rises) for each crossing of an arc.
  template <class Visit>
  void visit_arc(const SectionArc& arc, const Visit& visit) const {
    double y = arc.begin.y();
    if (arc.piece_count == 0) visit_chord(arc, visit);
    for (std::uint32_t i = 0; i < arc.piece_count; ++i) {
      const ArcPiece& piece = section_.pieces[arc.first_piece + i];
      const double y_end = i + 1 == arc.piece_count ? arc.end.y() : value_at(piece.y, 1.0);
      visit_piece(piece, y, y_end, visit);
      y = y_end;
    }
  }

 private:
  template <class Visit>
  void visit_chord(const SectionArc& arc, const Visit& visit) const {
    const ArcPiece chord = straight_piece(arc.begin, arc.end);
    visit_stretch(chord, arc.begin.y(), arc.end.y(), 0.0, 1.0, visit);
  }

  template <class Visit>
  void visit_piece(const ArcPiece& piece, double y_begin, double y_end, const Visit& visit) const {
    const bool is_far = std::abs(piece.y[0] - row_) > largest_move(piece.y);
    if (is_far && (y_begin <= row_) == (y_end <= row_)) return;
    double y = y_begin;
    double t = 0.0;
    for (const double turn : bernstein_roots(slope_net(piece.y), 0.0)) {
      const double y_turn = value_at(piece.y, turn);
      visit_stretch(piece, y, y_turn, t, turn, visit);
      y = y_turn;
      t = turn;
    }
    visit_stretch(piece, y, y_end, t, 1.0, visit);
  }

  template <class Visit>
  void visit_stretch(const ArcPiece& piece, double y0, double y1, double t0, double t1, const Visit& visit) const {
    if ((y0 <= row_) == (y1 <= row_)) return;
    const bool rises = y0 < y1;
    double lo = t0;
    double hi = t1;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (lo + hi);
      ((value_at(piece.y, middle) <= row_) == rises ? lo : hi) = middle;
    }
    visit(value_at(piece.x, 0.5 * (lo + hi)), rises);
  }

  const Section& section_;
  double row_;
};

class Nesting {
 public:
  Nesting(const Section& section, const std::vector<std::vector<std::uint32_t>>& arcs,
          const std::vector<SectionLoop>& loops, double chord_error)
      : section_(section), arcs_(arcs), loops_(loops) {
    for (const SectionLoop& loop : loops) {
      Box2 box;
      for (const Vec2& point : loop.points) box.extend(point);
      exact_.push_back(box);
      box.min().array() -= chord_error;
      box.max().array() += chord_error;
      boxes_.push_back(box);
    }
  }

  std::int32_t parent_of(std::size_t inner) const {
    const double row = exact_[inner].min().y() + kProbe * exact_[inner].sizes().y();
    const RowCrossings crossings(section_, row);
    const double x = leftmost(inner, crossings);
    std::int32_t best = -1;
    for (std::size_t outer = 0; outer < loops_.size(); ++outer) {
      const double area = std::abs(loops_[outer].area);
      if ((loops_[outer].area > 0.0) == (loops_[inner].area > 0.0) || !boxes_[outer].contains(Vec2(x, row))) continue;
      if (best >= 0 && area >= std::abs(loops_[static_cast<std::size_t>(best)].area)) continue;
      if (winding(outer, x, crossings) != 0) best = static_cast<std::int32_t>(outer);
    }
    return best;
  }

 private:
  double leftmost(std::size_t loop, const RowCrossings& crossings) const {
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t i : arcs_[loop]) {
      crossings.visit_arc(section_.arcs[i], [&](double x, bool) { least = std::min(least, x); });
    }
    return least;
  }

  /// How often the loop runs round the point of the row at x.
  int winding(std::size_t loop, double x, const RowCrossings& crossings) const {
    int turns = 0;
    for (const std::uint32_t i : arcs_[loop]) {
      crossings.visit_arc(section_.arcs[i], [&](double at, bool rises) {
        if (at < x) turns += rises ? -1 : 1;
      });
    }
    return turns;
  }

  const Section& section_;
  const std::vector<std::vector<std::uint32_t>>& arcs_;
  const std::vector<SectionLoop>& loops_;
  std::vector<Box2> exact_;  ///< of the polygons, whose points lie on the loops
  std::vector<Box2> boxes_;  ///< around the loops themselves
};

}  // namespace

std::vector<std::int32_t> find_parents(const Section& section, const std::vector<std::vector<std::uint32_t>>& arcs,
                                       const std::vector<SectionLoop>& loops, double chord_error) {
  const Nesting nesting(section, arcs, loops, chord_error);
  std::vector<std::int32_t> parents;
  for (std::size_t i = 0; i < loops.size(); ++i) parents.push_back(nesting.parent_of(i));
  return parents;
}

}  // namespace lamella::span
