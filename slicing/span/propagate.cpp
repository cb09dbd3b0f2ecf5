#include "slicing/span/propagate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "slicing/span/section_lanes.h"

namespace lamella::span {

namespace {

constexpr double kLargestTurn = 0.6;  // radians between neighbouring points

/// From this on a turn between neighbours is followed anew, not divided.
constexpr double kSharpTurn = 1.2;  // radians

/// Accepted error of a piece, in tolerances.
constexpr double kAccepted = 2.0;

/// A longer correction than 0.3 of the way that a point was moved means that the extrapolation is off.
constexpr MoveLimits kMoveLimits{0.3, 1e3, 4};

/// Between two points a new one is looked for within 0.3 of their distance.
constexpr MoveLimits kSplitLimits{0.0, 0.3, 4};

/// How often the pieces that don't hold are divided, and into how many parts at most each time.
constexpr int kMostPasses = 4;
constexpr double kMostParts = 8.0;

class Carrier {
 public:
  Carrier(const SectionSurface& surface, double sign, double z, const TraceLimits& limits, bool same_band,
          CarriedArc& carried)
      : surface_(surface), sign_(sign), z_(z), limits_(limits), same_band_(same_band), carried_(carried) {}

  bool run(const SectionPoint& begin, const SectionPoint& end) {
    const std::size_t last = carried_.arc.pieces.size();
    const std::size_t most = 4 * last + 64;
    places_.reserve(last + 1);
    if (!add_end(0, begin)) return false;
    for (std::size_t first = 1; first < last; first += kLanes) {
      if (!add_moved(first, std::min(first + kLanes, last))) return false;
    }
    if (!add_end(last, end)) return false;
    for (int pass = 0; !fit_places(); ++pass) {
      if (pass == kMostPasses || !mend() || places_.size() > most) return false;
    }
    take_places();
    return true;
  }

 private:
  /// A point at the new height, and the piece to the next one.
  struct Place {
    SectionPoint point;
    Cell cell;  ///< of the piece that begins here
    int axis = -1;
    bool fixed = false;  ///< an end, or between two cells: can't be spared
    bool fits = false;
    bool dropped = false;
    int parts = 1;  ///< into which the piece is to be divided
    std::size_t traced = 0;  ///< what is to be put behind it: index and number in traced_
    std::size_t traced_count = 0;
    Motion motion;
    ArcPiece piece = {};
    ArcPiece uv = {};    ///< of a piece that doesn't fit
    double error = 0.0;  ///< mm; infinite where there is no such piece
  };

  bool add_end(std::size_t i, const SectionPoint& given) {
    Place place;
    place.cell = carried_.arc.cells[std::min(i, carried_.arc.cells.size() - 1)];
    place.axis = carried_.arc.axes[i];
    place.fixed = true;
    place.motion = carried_.motions[i];
    const Vec2& periods = surface_.periods();
    const Vec2& last = carried_.arc.points[i].uv;
    Vec2 uv = given.uv;
    for (int axis = 0; axis < 2; ++axis) {
      if (periods[axis] > 0.0) uv[axis] += periods[axis] * std::round((last[axis] - uv[axis]) / periods[axis]);
    }
    // Beyond its cell the piece would go on analytically, the surface doesn't.
    if (!surface_.holds(place.cell, uv, -1)) return false;
    place.point = surface_.has_cells() ? section_point(surface_.evaluate(uv, place.cell), uv, sign_) : given;
    place.point.uv = uv;
    place.point.z = z_;
    places_.push_back(place);
    return place.point.uv_bend.allFinite();
  }

  /// Moves the inner points [first, last), no more than there are lanes.
  bool add_moved(std::size_t first, std::size_t last) {
    const TracedArc& arc = carried_.arc;
    std::array<MovingPoint, kLanes> moving;
    for (std::size_t i = first; i < last; ++i) moving[i - first] = moving_point(i);
    move_points(surface_, sign_, z_, kMoveLimits, {moving.data(), last - first});
    for (std::size_t i = first; i < last; ++i) {
      const MovingPoint& moved = moving[i - first];
      const bool fixed = !(arc.cells[i - 1] == arc.cells[i]);
      if (moved.found && surface_.holds(arc.cells[i], moved.at.uv, arc.axes[i])) {
        add_place(moved, arc.axes[i], fixed, places_).motion = motion_of(i, moved.velocity);
      } else if (fixed) {
        return false;
      }
    }
    return true;
  }

  static Place& add_place(const MovingPoint& moved, int axis, bool fixed, std::vector<Place>& places) {
    Place& place = places.emplace_back();
    place.point = moved.point;
    place.cell = moved.at.cell;
    place.axis = axis;
    place.fixed = fixed;
    place.motion.velocity = moved.velocity;
    return place;
  }

  /// The motion of a point with a new velocity.
  [[nodiscard]] Motion motion_of(std::size_t i, const Vec2& velocity) const {
    const Motion& last = carried_.motions[i];
    const double dz = z_ - carried_.z;
    Motion motion{velocity, (velocity - last.velocity) / dz, Vec2::Zero()};
    if (carried_.last_step > 0.0) motion.bend = (motion.change - last.change) / (dz + carried_.last_step);
    return motion;
  }

  [[nodiscard]] MovingPoint moving_point(std::size_t i) const {
    const std::vector<SectionPoint>& points = carried_.arc.points;
    MovingPoint moving;
    const Motion& motion = carried_.motions[i];
    const double dz = z_ - carried_.z;
    moving.step = motion.velocity * dz;
    // Two layers may be nearly one, and say nothing then. The integral of Newton's interpolation of the velocity.
    if (dz < 16.0 * carried_.last_step) {
      moving.step += motion.change * (0.5 * dz * dz);
      if (dz < 16.0 * carried_.step_before) {
        moving.step += motion.bend * (dz * dz * (dz / 3.0 + 0.5 * carried_.last_step));
      }
    }
    moving.at = {points[i].uv + moving.step, carried_.arc.cells[i]};
    const int axis = carried_.arc.axes[i];
    if (axis >= 0) moving.way[1 - axis] = 1.0;
    const double after = (points[i + 1].xy - points[i].xy).squaredNorm();
    const double before = (points[i - 1].xy - points[i].xy).squaredNorm();
    moving.scale = std::sqrt(std::max(after, before));
    return moving;
  }

  /// Fits what isn't fitted yet. Returns whether all pieces hold.
  bool fit_places() {
    bool all = true;
    const std::size_t pieces = places_.size() - 1;
    for (std::size_t i = 0; i < pieces;) {
      if (places_[i].fits) {
        ++i;
        continue;
      }
      const std::size_t next = fit_from(i);
      for (; i < next; ++i) all = all && places_[i].fits;
    }
    return all;
  }

  /// Fits as many pieces as there are lanes, up to one that leads into another cell or fits already. Returns the first one behind.
  std::size_t fit_from(std::size_t first) {
    PointRun run(surface_, sign_, places_[first].point);
    for (std::size_t i = first; i + 1 < places_.size() && !places_[i].fits; ++i) {
      if (!run.add(places_[i].cell, places_[i + 1].point, places_[i + 1].cell)) break;
    }
    const std::size_t count = run.pieces();
    PieceFits fits;
    fit_run(run, {kLargestTurn, kAccepted * limits_.tolerance}, fits);
    for (std::size_t i = 0; i < count; ++i) {
      Place& place = places_[first + i];
      place.error = fits.errors[i];
      place.fits = place.error <= kAccepted * limits_.tolerance;
      place.piece = fits.pieces[i];
      if (!place.fits) place.uv = fits.uv[i];
    }
    return first + count;
  }

  /// Puts points into pieces that are too long, and leaves out those that were overtaken. False if neither helps.
  bool mend() {
    mending_.clear();
    traced_.clear();
    for (std::size_t i = 0; i + 1 < places_.size(); ++i) {
      if (!places_[i].fits && !places_[i].dropped && !mend(i)) return false;
    }
    for (std::size_t first = 0; first < mending_.size(); first += kLanes) {
      const std::size_t count = std::min<std::size_t>(kLanes, mending_.size() - first);
      move_points(surface_, sign_, z_, kSplitLimits, {mending_.data() + first, count});
    }
    return insert_mended();
  }

  /// The same for the piece that begins in a place.
  bool mend(std::size_t i) {
    const SectionPoint& a = places_[i].point;
    std::size_t next = i + 1;
    if (turn_between(a, places_[next].point) > kSharpTurn) return trace_on(i);
    while (!runs_forward(a, places_[next].point) && !places_[next].fixed) places_[next++].dropped = true;
    if (!runs_forward(a, places_[next].point)) return drop(i);
    if (next == i + 1) split(i);
    return true;
  }

  [[nodiscard]] static double turn_between(const SectionPoint& a, const SectionPoint& b) {
    return std::acos(std::clamp(a.tangent.dot(b.tangent), -1.0, 1.0));
  }

  [[nodiscard]] static bool runs_forward(const SectionPoint& a, const SectionPoint& b) {
    return a.tangent.dot(b.xy - a.xy) > 0.0 && b.tangent.dot(b.xy - a.xy) > 0.0;
  }

  /// Follows the section from a place to the next one that it meets: round a bend so sharp that it has moved by its own
  /// size, no carried point is left there. The arc's end is always among the places that may be met, so that what is
  /// followed never runs beyond it, or round a loop once more. Over an event it may not be done: where arcs have merged,
  /// each would become the whole.
  bool trace_on(std::size_t i) {
    constexpr std::size_t kMostTargets = 12;
    if (i == 0 || !same_band_) return false;
    std::vector<std::size_t> numbers;
    std::vector<SectionPoint> targets;
    for (std::size_t k = i + 1; k + 1 < places_.size() && targets.size() < kMostTargets; ++k) {
      numbers.push_back(k);
      targets.push_back(places_[k].point);
    }
    numbers.push_back(places_.size() - 1);
    targets.push_back(places_.back().point);
    TraceLimits limits = limits_;
    limits.last = kAccepted;
    limits.longest = std::min(limits.longest, 4.0 * (targets.front().xy - places_[i].point.xy).norm());
    TracedArc arc;
    if (!trace(surface_, sign_, places_[i].point, targets, limits, arc)) return false;
    // Not in another period.
    const Vec2& landed = targets[arc.target].uv;
    if (!((arc.points.back().uv - landed).norm() <= 1e-9 * (1.0 + landed.norm()))) return false;
    for (std::size_t k = i + 1; k < numbers[arc.target]; ++k) places_[k].dropped = true;
    places_[i].traced = traced_.size();
    places_[i].traced_count = arc.pieces.size() - 1;
    take_piece(arc, 0, places_[i]);
    for (std::size_t k = 1; k < arc.pieces.size(); ++k) {
      Place& place = traced_.emplace_back();
      place.point = arc.points[k];
      place.axis = arc.axes[k];
      place.fixed = !(arc.cells[k - 1] == arc.cells[k]);
      place.motion.velocity = rise_of(place.point, place.axis);
      take_piece(arc, k, place);
    }
    return true;
  }

  static void take_piece(const TracedArc& arc, std::size_t k, Place& place) {
    place.cell = arc.cells[k];
    place.piece = arc.pieces[k];
    place.fits = true;
  }

  /// Has points put between two places: where the piece is known, as many as its error asks for, since that is of order
  /// six in the step.
  void split(std::size_t i) {
    Place& place = places_[i];
    const SectionPoint& a = place.point;
    const SectionPoint& b = places_[i + 1].point;
    const bool is_known = std::isfinite(place.error);
    if (is_known) {
      place.parts = static_cast<int>(
          std::clamp(std::ceil(std::pow(place.error / limits_.tolerance, 1.0 / 6.0)), 2.0, kMostParts));
    } else {
      place.parts = 2;
    }
    MovingPoint moving;
    moving.scale = (b.xy - a.xy).norm();
    for (int part = 1; part < place.parts; ++part) {
      const double t = static_cast<double>(part) / place.parts;
      moving.at = {is_known ? place.uv.at(t) : Vec2((1.0 - t) * a.uv + t * b.uv), place.cell};
      mending_.push_back(moving);
    }
  }

  bool drop(std::size_t i) {
    if (places_[i].fixed) return false;
    places_[i].dropped = true;
    places_[i - 1].fits = false;
    return true;
  }

  bool insert_mended() {
    std::vector<Place> mended;
    mended.reserve(places_.size() + mending_.size() + traced_.size());
    auto next = mending_.begin();
    for (const Place& place : places_) {
      if (!place.dropped) mended.push_back(place);
      mended.back().parts = 1;
      mended.back().traced_count = 0;
      const auto traced = traced_.begin() + static_cast<std::ptrdiff_t>(place.traced);
      mended.insert(mended.end(), traced, traced + static_cast<std::ptrdiff_t>(place.traced_count));
      for (int part = 1; part < place.parts; ++part, ++next) {
        if (!next->found || !surface_.holds(place.cell, next->at.uv, -1)) return false;
        add_place(*next, -1, false, mended);
      }
    }
    std::swap(places_, mended);
    return true;
  }

  /// The places become the arc.
  void take_places() {
    TracedArc& arc = carried_.arc;
    const std::size_t points = places_.size();
    arc.points.resize(points);
    arc.axes.resize(points);
    arc.cells.resize(points - 1);
    arc.pieces.resize(points - 1);
    carried_.motions.resize(points);
    for (std::size_t i = 0; i < points; ++i) {
      const Place& place = places_[i];
      arc.points[i] = place.point;
      arc.axes[i] = static_cast<std::int8_t>(place.axis);
      carried_.motions[i] = place.motion;
      if (i + 1 == points) break;
      arc.cells[i] = place.cell;
      arc.pieces[i] = place.piece;
    }
    arc.landed = true;
    carried_.step_before = carried_.last_step;
    carried_.last_step = z_ - carried_.z;
    carried_.z = z_;
  }

  const SectionSurface& surface_;
  double sign_;
  double z_;
  const TraceLimits& limits_;
  bool same_band_;
  CarriedArc& carried_;
  std::vector<Place> places_;
  std::vector<MovingPoint> mending_;  ///< points to be put between places, in their order
  std::vector<Place> traced_;         ///< the same, with their pieces
};

}  // namespace

void CarriedArc::start(double height) {
  z = height;
  last_step = step_before = 0.0;
  motions.clear();
  for (std::size_t i = 0; i < arc.points.size(); ++i) motions.push_back({rise_of(arc.points[i], arc.axes[i]), {}, {}});
}

bool carry(const SectionSurface& surface, double sign, const SectionPoint& begin, const SectionPoint& end, double z,
           const TraceLimits& limits, bool same_band, CarriedArc& carried) {
  return Carrier(surface, sign, z, limits, same_band, carried).run(begin, end);
}

}  // namespace lamella::span
