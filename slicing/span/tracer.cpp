#include "slicing/span/tracer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace lamella::span {

namespace {

constexpr std::size_t kMaxPieces = 20000;
constexpr int kMaxAttempts = 60;
constexpr double kLargestTurn = 0.5;      // radians of one step
constexpr double kCorrectionShare = 0.3;  // of a step: a longer correction is not trusted
constexpr double kGrowth = 2.0;

/// A step ends on a knot that it would cross, unless that lies nearer than this share of it.
constexpr double kLeastShare = 0.05;

/// Where a step of arc length from a point first leaves its cell, or meets a knot within it.
struct Exit {
  int axis = -1;
  bool within = false;  ///< a knot of the cell, that steps may cross
  bool upper = false;
  double value = 0.0;
  double length = 0.0;
};

Vec2 predict(const SectionPoint& from, double length) {
  return from.uv + length * from.uv_slope + (0.5 * length * length) * from.uv_bend;
}

/// Smallest s > floor with slope s + bend s^2 / 2 = rise, or `fallback`.
double first_reach(double rise, double slope, double bend, double floor, double fallback) {
  const double half = 0.5 * bend;
  const double discriminant = slope * slope + 4.0 * half * rise;
  if (!(discriminant >= 0.0)) return fallback;
  const double q = 0.5 * (slope + std::copysign(std::sqrt(discriminant), slope));
  double best = fallback;
  const double first = rise / q;
  const double second = q / -half;
  for (const double s : {first, second}) {
    if (s > floor && s < best) best = s;
  }
  return best;
}

Exit find_exit(const SectionSurface& surface, const Cell& cell, const SectionPoint& from, double length) {
  Exit exit;
  exit.length = length;
  const Vec2 to = predict(from, length);
  for (int axis = 0; axis < 2; ++axis) {
    const Interval limits = surface.limits(cell, axis);
    const double slack = kCellSlack * limits.length();
    const bool above = to[axis] > limits.hi + slack;
    if (!above && !(to[axis] < limits.lo - slack)) continue;
    const double value = above ? limits.hi : limits.lo;
    // From a point on the limit inward, the limit just left isn't reached again at once.
    const bool inward = (from.uv_slope[axis] > 0.0) != above;
    const double s = first_reach(value - from.uv[axis], from.uv_slope[axis], from.uv_bend[axis],
                                 inward ? 1e-6 * length : 0.0, length);
    if (exit.axis < 0 || s < exit.length) exit = {axis, false, above, value, s};
  }
  return exit;
}

/// The same for the knots within the cell: a piece between two of them is as smooth as can be.
Exit find_knot(const SectionSurface& surface, const Cell& cell, const SectionPoint& from, const Exit& cell_exit) {
  Exit exit = cell_exit;
  const Vec2 to = predict(from, cell_exit.length);
  for (int axis = 0; axis < 2; ++axis) {
    const Interval limits = surface.piece_limits(axis, from.uv[axis], to[axis] - from.uv[axis], cell);
    const bool above = to[axis] > limits.hi;
    if (!above && !(to[axis] < limits.lo)) continue;
    const double value = above ? limits.hi : limits.lo;
    const double s = first_reach(value - from.uv[axis], from.uv_slope[axis], from.uv_bend[axis],
                                 kLeastShare * cell_exit.length, cell_exit.length);
    if (s < exit.length) exit = {axis, true, above, value, s};
  }
  return exit;
}

/// Moves to the neighbouring cell when `at` lies on a limit and heads out of it.
bool enter_next_cell(const SectionSurface& surface, const SectionPoint& at, Cell& cell) {
  bool moved = false;
  for (int axis = 0; axis < 2; ++axis) {
    const Interval limits = surface.limits(cell, axis);
    const double slack = kCellSlack * limits.length();
    int& index = axis == 0 ? cell.u : cell.v;
    if (at.uv[axis] >= limits.hi - slack && at.uv_slope[axis] > 0.0 && surface.has_neighbor(cell, axis, true)) {
      ++index;
      moved = true;
    } else if (at.uv[axis] <= limits.lo + slack && at.uv_slope[axis] < 0.0 && surface.has_neighbor(cell, axis, false)) {
      --index;
      moved = true;
    }
  }
  return moved;
}

/// The copy of `uv` in the period nearest to `near`.
Vec2 unwrapped(Vec2 uv, const Vec2& near, const Vec2& periods) {
  for (int axis = 0; axis < 2; ++axis) {
    if (periods[axis] > 0.0) uv[axis] += periods[axis] * std::round((near[axis] - uv[axis]) / periods[axis]);
  }
  return uv;
}

/// One step in progress.
struct Step {
  SectionPoint next;
  PieceFit fit;
  Exit exit;
};

class Trace {
 public:
  Trace(const SectionSurface& surface, double sign, std::span<const SectionPoint> targets, const TraceLimits& limits,
        std::size_t twin, TracedArc& arc)
      : surface_(surface), sign_(sign), targets_(targets), limits_(limits), twin_(twin), arc_(arc) {}

  bool run(const SectionPoint& start) {
    arc_.clear();
    arc_.points.push_back(start);
    arc_.axes.push_back(-1);
    z_ = start.z;
    cell_ = surface_.find_cell(start.uv, start.uv_slope);
    current_ = start;
    length_ = limits_.longest;
    while (arc_.pieces.size() < kMaxPieces) {
      const std::optional<Step> step = find_step();
      if (!step) return false;
      if (land(*step)) return true;
      if (!advance(*step)) return false;
    }
    return false;
  }

 private:
  /// The longest step that keeps to the tolerance.
  std::optional<Step> find_step() {
    length_ = std::min(length_, limits_.longest);
    if (current_.curvature != 0.0) length_ = std::min(length_, kLargestTurn / std::abs(current_.curvature));
    for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
      std::optional<Step> step = try_step(length_);
      if (!step) {
        length_ *= 0.5;
        continue;
      }
      const double ratio = std::pow(limits_.tolerance / std::max(step->fit.error, 1e-30), 1.0 / 6.0);
      if (step->fit.error <= limits_.tolerance) {
        grow_ = std::min(kGrowth, std::max(1.0, 0.8 * ratio));
        return step;
      }
      length_ = step->exit.length * std::clamp(0.8 * ratio, 0.1, 0.7);
    }
    return std::nullopt;
  }

  std::optional<Step> try_step(double length) {
    Step step;
    step.exit = find_knot(surface_, cell_, current_, find_exit(surface_, cell_, current_, length));
    Vec2 uv = predict(current_, step.exit.length);
    // A correction may leave the cell where the prediction didn't, or by its other side: then end on that limit.
    for (int attempt = 0; attempt < 3; ++attempt) {
      if (step.exit.axis >= 0) uv[step.exit.axis] = step.exit.value;
      const CorrectLimits correct_limits{kCorrectionShare * step.exit.length + limits_.tolerance};
      const auto next = correct(surface_, cell_, uv, z_, sign_, step.exit.axis, correct_limits);
      if (!next) return std::nullopt;
      if (!leaves_cell(next->uv, step.exit)) {
        step.next = *next;
        return fitted(step);
      }
      uv = next->uv;
    }
    return std::nullopt;
  }

  /// Whether `uv` lies beyond a limit of the cell; `exit` then holds that limit.
  bool leaves_cell(const Vec2& uv, Exit& exit) const {
    for (int axis = 0; axis < 2; ++axis) {
      const Interval limits = surface_.limits(cell_, axis);
      const double slack = 2.0 * kCellSlack * limits.length();
      const bool above = uv[axis] > limits.hi + slack;
      if (!above && !(uv[axis] < limits.lo - slack)) continue;
      exit.axis = axis;
      exit.within = false;
      exit.upper = above;
      exit.value = above ? limits.hi : limits.lo;
      return true;
    }
    return false;
  }

  std::optional<Step> fitted(Step step) {
    if (!(step.next.tangent.dot(current_.tangent) > std::cos(kLargestTurn * 1.2))) return std::nullopt;
    step.fit = fit_piece(surface_, cell_, current_, step.next);
    if (!std::isfinite(step.fit.error)) return std::nullopt;
    return step;
  }

  /// Ends the arc if a target lies on the step.
  bool land(const Step& step) {
    double first = 2.0;
    std::size_t best = targets_.size();
    Vec2 best_uv;
    for (std::size_t i = 0; i < targets_.size(); ++i) {
      const Vec2 uv = unwrapped(targets_[i].uv, 0.5 * (current_.uv + step.next.uv), surface_.periods());
      const double t = step.fit.parameter(current_.uv, step.next.uv, uv);
      if (!(t > 1e-9 && t < first) || !is_on(step, targets_[i], uv, t)) continue;
      if (i == twin_ && !has_come_round(uv_at(step.fit, current_, step.next, t), targets_[i])) continue;
      first = t;
      best = i;
      best_uv = uv;
    }
    return best < targets_.size() && finish(best, best_uv);
  }

  /// By a whole period, or nearly (passing a pole closely takes half of one), or by a way that is long beside the
  /// distance of the twins: near a pole a seam's gap may be any part of a period.
  [[nodiscard]] bool has_come_round(const Vec2& uv, const SectionPoint& twin) const {
    const SectionPoint& start = arc_.points.front();
    const Vec2 way = (uv - start.uv).cwiseAbs();
    if (way[0] > 0.75 * surface_.extent(0) || way[1] > 0.75 * surface_.extent(1)) return true;
    return travelled_ > 20.0 * std::max((twin.xy - start.xy).norm(), limits_.landing);
  }

  bool is_on(const Step& step, const SectionPoint& target, const Vec2& uv, double t) const {
    const double chord = (step.next.xy - current_.xy).norm();
    if (t > 1.0 + std::min(0.5, 10.0 * limits_.landing / chord)) return false;
    if (!((step.fit.piece.at(t) - target.xy).norm() <= limits_.landing + 1e-6 * chord)) return false;
    const Vec2 aside = uv_at(step.fit, current_, step.next, t) - uv;
    return length_of(current_, aside) <= 1e-3 * chord + limits_.landing ||
           length_of(step.next, aside) <= 1e-3 * chord + limits_.landing;
  }

  bool finish(std::size_t target, const Vec2& uv) {
    SectionPoint end = section_point(surface_.evaluate(uv, cell_), uv, sign_);
    end.z = z_;
    PieceFit fit = fit_piece(surface_, cell_, current_, end);
    // The last bit of an arc may be too short, or end too obliquely in (u, v), for derivatives to mean anything.
    const double chord = (end.xy - current_.xy).norm();
    if (!(fit.error <= limits_.last * limits_.tolerance)) {
      if (chord > 1e-2 * limits_.landing && end.uv_bend.allFinite()) return false;
      fit.piece = straight_piece(current_.xy, end.xy);
    }
    push(end, fit.piece, -1);
    arc_.target = target;
    arc_.landed = true;
    return true;
  }

  void push(const SectionPoint& point, const ArcPiece& piece, int axis) {
    travelled_ += (point.xy - arc_.points.back().xy).norm();
    arc_.points.push_back(point);
    arc_.axes.push_back(static_cast<std::int8_t>(axis));
    arc_.cells.push_back(cell_);
    arc_.pieces.push_back(piece);
  }

  bool advance(const Step& step) {
    push(step.next, step.fit.piece, step.exit.axis);
    // A step that a limit has cut short says little of how long the next one may be.
    length_ = step.exit.axis >= 0 ? std::max(length_, step.exit.length * grow_) : step.exit.length * grow_;
    const bool leaves = step.exit.axis >= 0 && !step.exit.within;
    if (leaves) length_ = std::max(length_, 0.5 * limits_.longest);
    current_ = step.next;
    if (leaves && !surface_.has_neighbor(cell_, step.exit.axis, step.exit.upper)) return false;
    return enter_cell_ahead();
  }

  /// The next cell may be left at once by another of its limits, in a corner. What leads back into one that was left
  /// runs along the limit, and may as well stay.
  bool enter_cell_ahead() {
    std::array<Cell, 4> left;
    for (std::size_t count = 0; count < left.size(); ++count) {
      left[count] = cell_;
      if (!enter_next_cell(surface_, current_, cell_)) return true;
      if (std::find(left.begin(), left.begin() + count, cell_) != left.begin() + count) {
        cell_ = left[count];
        return true;
      }
      current_ = section_point(surface_.evaluate(current_.uv, cell_), current_.uv, sign_);
      current_.z = z_;
      arc_.points.back() = current_;
      if (!current_.uv_bend.allFinite()) return false;
    }
    return true;
  }

  const SectionSurface& surface_;
  double sign_;
  std::span<const SectionPoint> targets_;
  const TraceLimits& limits_;
  std::size_t twin_;
  TracedArc& arc_;
  Cell cell_;
  SectionPoint current_;
  double z_ = 0.0;
  double length_ = 0.0;
  double grow_ = 1.0;
  double travelled_ = 0.0;  ///< mm along the chords of the arc so far
};

}  // namespace

bool trace(const SectionSurface& surface, double sign, const SectionPoint& start, std::span<const SectionPoint> targets,
           const TraceLimits& limits, TracedArc& arc, std::size_t twin) {
  return Trace(surface, sign, targets, limits, twin, arc).run(start);
}

}  // namespace lamella::span
