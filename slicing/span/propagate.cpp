#include "slicing/span/propagate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

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

/// A point between two pieces of errors below this share of the tolerance is left out: the error is of order six in the
/// step, so that of both as one is up to 64 times as large.
constexpr double kIdle = 0.005;

/// How often the pieces that don't hold are divided, and into how many parts at most each time.
constexpr int kMostPasses = 8;
constexpr double kMostParts = 8.0;

/// Whether a point reaches the next heights by a line u or v = const, without much more of a way than by the steepest.
bool moves_well(const SectionPoint& at, int line) {
  constexpr double kLongest = 3.0;
  return line >= 0 && length_of(at, rise_of(at, line)) <= kLongest * length_of(at, rise_of(at, -1));
}

class Carrier {
 public:
  Carrier(const SectionSurface& surface, double sign, double z, const TraceLimits& limits, bool same_band,
          CarryWork& work, CarriedArc& carried)
      : surface_(surface),
        sign_(sign),
        z_(z),
        limits_(limits),
        same_band_(same_band),
        carried_(carried),
        places_(work.places),
        work_(work) {
    places_.clear();
    work_.uv.clear();
    reserve(carried.arc.points.size());
  }

  bool run(const SectionPoint& begin, const SectionPoint& end) {
    const std::size_t last = carried_.arc.pieces.size();
    const std::size_t most = 4 * last + 64;
    if (!add_end(0, begin)) return false;
    if (!add_inner_points(last) || !add_end(last, end)) return false;
    for (int pass = 0; !fit_places(); ++pass) {
      if (pass == kMostPasses || !mend() || places_.size() > most) return false;
    }
    // A point that was overtaken by the end lies beyond it: followed from there a closed section is run through twice.
    if (was_traced_ && !(std::abs(turn() - carried_turn()) < kPi)) return false;
    take_places();
    return true;
  }

 private:
  using Place = CarriedPlace;

  /// Makes room for as many points, motions and pieces.
  void reserve(std::size_t count) {
    work_.points.resize(count);
    work_.motions.resize(count);
    work_.pieces.resize(count);
  }

  /// The same beyond those that there are. Returns the number of the first one.
  std::uint32_t add_numbers(std::size_t count) {
    const std::size_t first = work_.points.size();
    reserve(first + count);
    return static_cast<std::uint32_t>(first);
  }

  [[nodiscard]] const SectionPoint& point_of(const Place& place) const { return work_.points[place.number]; }

  bool add_end(std::size_t i, const SectionPoint& given) {
    Place& place = places_.emplace_back();
    place.number = static_cast<std::uint32_t>(i);
    place.cell = carried_.arc.cells[std::min(i, carried_.arc.cells.size() - 1)];
    place.axis = carried_.arc.axes[i];
    place.line = carried_.lines[i];
    place.fixed = true;
    work_.motions[i] = carried_.motions[i];
    const Vec2& periods = surface_.periods();
    const Vec2& last = carried_.arc.points[i].uv;
    Vec2 uv = given.uv;
    for (int axis = 0; axis < 2; ++axis) {
      if (periods[axis] > 0.0) uv[axis] += periods[axis] * std::round((last[axis] - uv[axis]) / periods[axis]);
    }
    // Beyond its cell the piece would go on analytically, the surface doesn't.
    if (!surface_.holds(place.cell, uv, -1)) return false;
    SectionPoint& point = work_.points[i];
    point = surface_.has_cells() ? section_point(surface_.evaluate(uv, place.cell), uv, sign_) : given;
    point.uv = uv;
    point.z = z_;
    return point.uv_bend.allFinite();
  }

  /// Moves those inner points that are needed.
  bool add_inner_points(std::size_t last) {
    std::array<std::size_t, kLanes> numbers;
    std::size_t count = 0;
    bool was_idle = false;
    for (std::size_t i = 1; i < last; ++i) {
      was_idle = !was_idle && is_idle(i);
      if (was_idle) continue;
      numbers[count++] = i;
      if (count < kLanes) continue;
      if (!add_moved(numbers)) return false;
      count = 0;
    }
    return count == 0 || add_moved({numbers.data(), count});
  }

  /// Whether the pieces on both sides of an inner point would do as one.
  [[nodiscard]] bool is_idle(std::size_t i) const {
    const TracedArc& arc = carried_.arc;
    const double most = kIdle * limits_.tolerance;
    return carried_.errors[i - 1] <= most && carried_.errors[i] <= most && arc.axes[i] < 0 &&
           arc.cells[i - 1] == arc.cells[i] &&
           arc.points[i - 1].tangent.dot(arc.points[i + 1].tangent) > std::cos(0.8 * kLargestTurn);
  }

  /// Moves inner points, no more than there are lanes.
  bool add_moved(std::span<const std::size_t> numbers) {
    const TracedArc& arc = carried_.arc;
    std::array<MovingPoint, kLanes> moving;
    for (std::size_t k = 0; k < numbers.size(); ++k) set_out(numbers[k], moving[k]);
    move_points(surface_, sign_, z_, kMoveLimits, {moving.data(), numbers.size()});
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      const std::size_t i = numbers[k];
      const MovingPoint& moved = moving[k];
      const bool fixed = !(arc.cells[i - 1] == arc.cells[i]);
      if (moved.found && surface_.holds(arc.cells[i], moved.at.uv, arc.axes[i])) {
        Place& place = places_.emplace_back();
        place.number = static_cast<std::uint32_t>(i);
        place.cell = arc.cells[i];
        place.axis = arc.axes[i];
        place.line = carried_.lines[i];
        place.fixed = fixed;
        work_.motions[i] = motion_of(i, moved.velocity);
      } else if (fixed) {
        return false;
      }
    }
    return true;
  }

  /// The motion of a point with a new velocity.
  [[nodiscard]] Motion motion_of(std::size_t i, const Vec2& velocity) const {
    const Motion& last = carried_.motions[i];
    const double dz = z_ - carried_.z;
    Motion motion{velocity, (velocity - last.velocity) / dz, Vec2::Zero(), 1};
    if (last.known == 0) return motion;
    motion.bend = (motion.change - last.change) / (dz + carried_.last_step);
    motion.known = 2;
    return motion;
  }

  void set_out(std::size_t i, MovingPoint& moving) const {
    const std::vector<SectionPoint>& points = carried_.arc.points;
    const Motion& motion = carried_.motions[i];
    const double dz = z_ - carried_.z;
    moving.step = motion.velocity * dz;
    // Two layers may be nearly one, and say nothing then. The integral of Newton's interpolation of the velocity.
    if (motion.known > 0 && dz < 16.0 * carried_.last_step) {
      moving.step += motion.change * (0.5 * dz * dz);
      if (motion.known > 1 && dz < 16.0 * carried_.step_before) {
        moving.step += motion.bend * (dz * dz * (dz / 3.0 + 0.5 * carried_.last_step));
      }
    }
    moving.at = {points[i].uv + moving.step, carried_.arc.cells[i]};
    const int line = carried_.lines[i];
    if (line >= 0) moving.way[1 - line] = 1.0;
    const double after = (points[i + 1].xy - points[i].xy).squaredNorm();
    const double before = (points[i - 1].xy - points[i].xy).squaredNorm();
    moving.scale = std::sqrt(std::max(after, before));
    moving.point = &work_.points[i];
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

  /// Fits as many pieces as there are lanes, up to one that leads into another cell or fits already. Returns the first
  /// one behind.
  std::size_t fit_from(std::size_t first) {
    PointRun run(surface_, sign_, point_of(places_[first]));
    for (std::size_t i = first; i + 1 < places_.size() && !places_[i].fits; ++i) {
      if (!run.add(places_[i].cell, point_of(places_[i + 1]), places_[i + 1].cell)) break;
    }
    const std::size_t count = run.pieces();
    PieceFits fits;
    fit_run(run, {kLargestTurn, kAccepted * limits_.tolerance}, fits);
    for (std::size_t i = 0; i < count; ++i) {
      Place& place = places_[first + i];
      place.error = fits.errors[i];
      place.fits = place.error <= kAccepted * limits_.tolerance;
      if (place.fits) {
        work_.pieces[place.number] = fits.pieces[i];
      } else {
        place.uv = static_cast<std::uint32_t>(work_.uv.size());
        work_.uv.push_back(fits.uv[i]);
      }
    }
    return first + count;
  }

  /// Puts points into pieces that are too long, and leaves out those that were overtaken. False if neither helps.
  bool mend() {
    work_.moving.clear();
    work_.traced.clear();
    for (std::size_t i = 0; i + 1 < places_.size(); ++i) {
      if (!places_[i].fits && !places_[i].dropped && !mend(i)) return false;
    }
    move_between();
    return insert_mended();
  }

  /// The same for the piece that begins in a place.
  bool mend(std::size_t i) {
    const SectionPoint& a = point_of(places_[i]);
    std::size_t next = i + 1;
    if (turn_between(a, point_of(places_[next])) > kSharpTurn) return trace_on(i);
    while (!runs_forward(a, point_of(places_[next])) && !places_[next].fixed) places_[next++].dropped = true;
    if (!runs_forward(a, point_of(places_[next]))) return drop(i);
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
  /// followed never runs beyond it, or round a loop once more. Over an event it may not be done: where arcs have
  /// merged, each would become the whole.
  bool trace_on(std::size_t i) {
    constexpr std::size_t kMostTargets = 12;
    if (i == 0 || !same_band_) return false;
    std::vector<std::size_t> numbers;
    std::vector<SectionPoint> targets;
    for (std::size_t k = i + 1; k + 1 < places_.size() && targets.size() < kMostTargets; ++k) {
      numbers.push_back(k);
      targets.push_back(point_of(places_[k]));
    }
    numbers.push_back(places_.size() - 1);
    targets.push_back(point_of(places_.back()));
    TraceLimits limits = limits_;
    limits.last = kAccepted;
    limits.longest = std::min(limits.longest, 4.0 * (targets.front().xy - point_of(places_[i]).xy).norm());
    TracedArc arc;
    if (!trace(surface_, sign_, point_of(places_[i]), targets, limits, arc)) return false;
    // Not in another period.
    const Vec2& landed = targets[arc.target].uv;
    if (!((arc.points.back().uv - landed).norm() <= 1e-9 * (1.0 + landed.norm()))) return false;
    for (std::size_t k = i + 1; k < numbers[arc.target]; ++k) places_[k].dropped = true;
    insert_traced(i, arc);
    return true;
  }

  /// Angle by which the tangent turns from one point to the next, positive to the left, radians. Exact for pieces,
  /// which turn by less than pi.
  [[nodiscard]] static double signed_turn(const SectionPoint& a, const SectionPoint& b) {
    const double side = a.tangent.x() * b.tangent.y() - a.tangent.y() * b.tangent.x();
    return std::atan2(side, a.tangent.dot(b.tangent));
  }

  /// The same along the whole arc: on the new height, and on the last one.
  [[nodiscard]] double turn() const {
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < places_.size(); ++i)
      sum += signed_turn(point_of(places_[i]), point_of(places_[i + 1]));
    return sum;
  }
  [[nodiscard]] double carried_turn() const {
    const std::vector<SectionPoint>& points = carried_.arc.points;
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) sum += signed_turn(points[i], points[i + 1]);
    return sum;
  }

  /// Has what was traced put behind a place, whose piece is its first one.
  void insert_traced(std::size_t i, const TracedArc& arc) {
    const std::size_t more = arc.pieces.size() - 1;
    std::uint32_t number = add_numbers(more);
    was_traced_ = true;
    places_[i].traced = static_cast<std::uint32_t>(work_.traced.size());
    places_[i].traced_count = static_cast<std::uint32_t>(more);
    take_piece(arc, 0, places_[i]);
    for (std::size_t k = 1; k <= more; ++k, ++number) {
      Place& place = work_.traced.emplace_back();
      place.number = number;
      place.axis = place.line = arc.axes[k];
      place.fixed = !(arc.cells[k - 1] == arc.cells[k]);
      work_.points[number] = arc.points[k];
      work_.motions[number] = Motion{rise_of(arc.points[k], place.axis)};
      take_piece(arc, k, place);
    }
  }

  void take_piece(const TracedArc& arc, std::size_t k, Place& place) {
    place.cell = arc.cells[k];
    place.fits = true;
    place.error = limits_.tolerance;
    work_.pieces[place.number] = arc.pieces[k];
  }

  /// Has points put between two places: where the piece is known, as many as its error asks for, since that is of order
  /// six in the step.
  void split(std::size_t i) {
    Place& place = places_[i];
    const SectionPoint& a = point_of(place);
    const SectionPoint& b = point_of(places_[i + 1]);
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
      moving.at = {is_known ? work_.uv[place.uv].at(t) : Vec2((1.0 - t) * a.uv + t * b.uv), place.cell};
      work_.moving.push_back(moving);
    }
  }

  bool drop(std::size_t i) {
    if (places_[i].fixed) return false;
    places_[i].dropped = true;
    places_[i - 1].fits = false;
    return true;
  }

  /// Brings the points that are to be put between others onto the section. They have the last numbers.
  void move_between() {
    std::vector<MovingPoint>& moving = work_.moving;
    const std::uint32_t number = add_numbers(moving.size());
    for (std::size_t k = 0; k < moving.size(); ++k) moving[k].point = &work_.points[number + k];
    for (std::size_t first = 0; first < moving.size(); first += kLanes) {
      const std::size_t count = std::min<std::size_t>(kLanes, moving.size() - first);
      move_points(surface_, sign_, z_, kSplitLimits, {moving.data() + first, count});
    }
  }

  bool insert_mended() {
    std::vector<Place>& mended = work_.mended;
    mended.clear();
    std::size_t next = 0;
    auto number = static_cast<std::uint32_t>(work_.points.size() - work_.moving.size());
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const Place& place = places_[i];
      if (!place.dropped) mended.push_back(place);
      mended.back().parts = 1;
      mended.back().traced_count = 0;
      const auto traced = work_.traced.begin() + static_cast<std::ptrdiff_t>(place.traced);
      mended.insert(mended.end(), traced, traced + static_cast<std::ptrdiff_t>(place.traced_count));
      for (int part = 1; part < place.parts; ++part, ++next, ++number) {
        const MovingPoint& moved = work_.moving[next];
        if (!moved.found || !surface_.holds(place.cell, moved.at.uv, -1)) return false;
        work_.motions[number] = Motion{moved.velocity};
        add_between(number, place, places_[i + 1]);
      }
    }
    std::swap(places_, mended);
    return true;
  }

  /// A point put between two others keeps to a line if they do.
  void add_between(std::uint32_t number, const Place& before, const Place& after) {
    Place& place = work_.mended.emplace_back();
    place.number = number;
    place.cell = before.cell;
    const SectionPoint& point = work_.points[number];
    if (before.line != after.line || !moves_well(point, before.line)) return;
    place.line = before.line;
    work_.motions[number].velocity = rise_of(point, place.line);
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
    carried_.lines.resize(points);
    carried_.errors.resize(points - 1);
    for (std::size_t i = 0; i < points; ++i) {
      const Place& place = places_[i];
      arc.points[i] = point_of(place);
      arc.axes[i] = place.axis;
      carried_.motions[i] = work_.motions[place.number];
      carried_.lines[i] = place.line;
      if (i + 1 == points) break;
      arc.cells[i] = place.cell;
      arc.pieces[i] = work_.pieces[place.number];
      carried_.errors[i] = place.error;
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
  bool was_traced_ = false;
  CarriedArc& carried_;
  std::vector<Place>& places_;
  CarryWork& work_;
};

}  // namespace

void CarriedArc::start(double height) {
  z = height;
  last_step = step_before = 0.0;
  lines = arc.axes;
  errors.assign(arc.pieces.size(), std::numeric_limits<double>::infinity());
  const std::size_t last = arc.points.size() - 1;
  for (std::size_t before = 0; before < last;) {
    std::size_t after = before + 1;
    while (after < last && arc.axes[after] < 0) ++after;
    if (arc.axes[before] == arc.axes[after]) {
      for (std::size_t i = before + 1; i < after; ++i) {
        if (moves_well(arc.points[i], arc.axes[before])) lines[i] = arc.axes[before];
      }
    }
    before = after;
  }
  motions.clear();
  for (std::size_t i = 0; i <= last; ++i) motions.push_back(Motion{rise_of(arc.points[i], lines[i])});
}

double CarriedArc::speed() const {
  double square = 0.0;
  for (std::size_t i = 1; i + 1 < arc.points.size(); ++i) {
    const Vec2& at = arc.points[i].xy;
    const double shorter =
        std::min((arc.points[i - 1].xy - at).squaredNorm(), (arc.points[i + 1].xy - at).squaredNorm());
    const double moved = length_of(arc.points[i], motions[i].velocity);
    square = std::max(square, moved * moved / shorter);
  }
  return std::sqrt(square);
}

bool carry(const SectionSurface& surface, double sign, const SectionPoint& begin, const SectionPoint& end, double z,
           const TraceLimits& limits, bool same_band, CarryWork& work, CarriedArc& carried) {
  return Carrier(surface, sign, z, limits, same_band, work, carried).run(begin, end);
}

}  // namespace lamella::span
