#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <type_traits>

#include "model/bspline.h"
#include "model/critical_detail.h"
#include "model/curve_extrema.h"
#include "model/evaluate.h"
#include "model/iso_line.h"

namespace lamella {

namespace {

/// Pieces along which the height doesn't leave the accuracy of a level, by the poles of the Bezier pieces.
std::vector<Interval> flat_pieces(const BSplineCurve<3>& curve, const Interval& range, const Vec3& direction) {
  const BSplineCurve<3> fine = refine(curve, bezier_knots(curve.knots, curve.degree));
  std::vector<Interval> flat;
  for (int span = fine.degree; span < static_cast<int>(fine.poles.size()); ++span) {
    const Interval piece{std::max(fine.knots[span], range.lo), std::min(fine.knots[span + 1], range.hi)};
    if (!(piece.lo < piece.hi)) continue;
    Interval height{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (int i = span - fine.degree; i <= span; ++i) {
      height.lo = std::min(height.lo, direction.dot(fine.poles[i]));
      height.hi = std::max(height.hi, direction.dot(fine.poles[i]));
    }
    if (height.length() <= kLevelAccuracy) flat.push_back(piece);
  }
  return flat;
}

std::vector<Interval> flat_pieces(const Line<3>& line, const Interval& range, const Vec3& direction) {
  const double slope = std::abs(direction.dot(line.direction));
  if (slope * range.length() <= kLevelAccuracy || slope <= kParallel * line.direction.norm()) return {range};
  return {};
}

std::vector<Interval> flat_pieces(const Ellipse<3>& ellipse, const Interval& range, const Vec3& direction) {
  const double amplitude = std::hypot(direction.dot(ellipse.major), direction.dot(ellipse.minor));
  if (2.0 * amplitude <= kLevelAccuracy) return {range};
  return {};
}

/// Other conics bend everywhere.
template <class Conic>
std::vector<Interval> flat_pieces(const Conic&, const Interval&, const Vec3&) {
  return {};
}

/// Knots are reported as places of extrema whether or not the height just passes through there.
bool passes_through(const BSplineCurve<3>& curve, double t, const Vec3& direction) {
  const double room = room_between_knots(curve.knots, t);
  const auto slope = [&](double at) { return room * direction.dot(evaluate<3>(Curve3(curve), at).dt); };
  const double before = slope(t - 1e-6 * room);
  const double after = slope(t + 1e-6 * room);
  // Near a stationary place the slope is smaller than this, unless it bends very sharply.
  const double least = 1e-5 * std::max(std::abs(slope(t - 0.5 * room)), std::abs(slope(t + 0.5 * room)));
  return (before > least && after > least) || (before < -least && after < -least);
}

/// One line on which a B-spline surface is only continuous.
class Crease {
 public:
  Crease(const BSplineSurface& spline, bool along_v, double knot, CriticalCollector& collector)
      : spline_(spline), along_v_(along_v), knot_(knot), collector_(collector) {
    room_across_ = room_between_knots(along_v ? spline.knots_u : spline.knots_v, knot);
  }

  void search() {
    const Interval domain = along_v_ ? spline_.domain_v() : spline_.domain_u();
    const Interval wanted = collector_.range(along_v_ ? 1 : 0);
    const Interval range{std::max(domain.lo, wanted.lo), std::min(domain.hi, wanted.hi)};
    if (!(range.lo < range.hi)) return;
    const StationaryParameters found = find_stationary(iso_curve(spline_, along_v_, knot_), range, Vec3::UnitZ());
    for (const Interval& piece : found.flat) add_flat(piece);
    turns_ = found.isolated;
    turns_.insert(turns_.end(), {range.lo, range.hi});
    for (const Interval& piece : found.flat) turns_.insert(turns_.end(), {piece.lo, piece.hi});
    std::sort(turns_.begin(), turns_.end());
    const std::vector<double> others = crease_knots(spline_, !along_v_, range);
    for (const double t : found.isolated) {
      add_isolated(t, std::binary_search(others.begin(), others.end(), t));
    }
  }

 private:
  [[nodiscard]] Vec2 place(double across, double along) const {
    return along_v_ ? Vec2(across, along) : Vec2(along, across);
  }

  /// The height's slopes in the four corners where the crease and its point at `t` meet, each row made comparable by
  /// the sizes of the neighbouring pieces.
  struct Slopes {
    Eigen::Array4d across;  ///< the first two before the crease, the others beyond it
    Eigen::Array4d along;
    double negligible;  ///< rounding, and no more than the search in patches looks over
  };

  [[nodiscard]] Slopes slopes_at(double t, double room) const {
    Slopes slopes;
    // A few roundings away, so that each evaluation uses the polynomial on its side.
    const double beside = 4e-16 * std::max(std::abs(knot_), room_across_);
    const double beyond = 4e-16 * std::max(std::abs(t), room);
    const double height = std::abs(evaluate_point(collector_.surface(), place(knot_, t)).z());
    for (int k = 0; k < 4; ++k) {
      const Vec2 uv = place(knot_ + (k < 2 ? -beside : beside), t + (k % 2 == 0 ? -beyond : beyond));
      const SurfacePoint at = evaluate(collector_.surface(), uv);
      slopes.across[k] = (along_v_ ? at.du.z() : at.dv.z()) * room_across_;
      slopes.along[k] = (along_v_ ? at.dv.z() : at.du.z()) * room;
    }
    const double steepest = std::max(slopes.across.abs().maxCoeff(), slopes.along.abs().maxCoeff());
    slopes.negligible = 1e-11 * steepest + 1e-14 * height + 1e-12;
    return slopes;
  }

  static bool have_one_sign(const Eigen::Array4d& slopes, double negligible) {
    return slopes.minCoeff() > negligible || slopes.maxCoeff() < -negligible;
  }

  /// A section just passes where the surface rises on both sides of the crease in the same direction; level stretches
  /// where a side has no slope are found with its patch.
  [[nodiscard]] bool is_critical_across(const Slopes& slopes) const {
    return slopes.across.abs().minCoeff() > slopes.negligible && !have_one_sign(slopes.across, slopes.negligible);
  }

  void add_flat(const Interval& piece) {
    constexpr int kSamples = 9;
    bool critical = false;
    for (int i = 0; i < kSamples && !critical; ++i) {
      const double t = piece.lo + (i + 0.5) / kSamples * piece.length();
      critical = is_critical_across(slopes_at(t, piece.length()));
    }
    if (critical) collector_.add_level(evaluate_point(collector_.surface(), place(knot_, piece.middle())).z());
  }

  void add_isolated(double t, bool corner) {
    const double room = room_between_knots(along_v_ ? spline_.knots_v : spline_.knots_u, t);
    const Slopes slopes = slopes_at(t, room);
    if (corner) {
      add_corner(t, room, slopes);
    } else if (is_critical_across(slopes)) {
      collector_.add_point(place(knot_, t), kind_along(t, slopes.across[0] < 0.0));
    }
  }

  /// Of a point on a crease that is a valley or a ridge: between two of its turns the height along it is monotone, so
  /// that the next ones tell whether it rises from the point or falls, however near they or the knots are. What doesn't
  /// differ by more than rounding is passed over; if all of it doesn't, an extremum is the safe answer.
  [[nodiscard]] CriticalKind kind_along(double t, bool valley) const {
    const auto height = [&](double at) { return evaluate_point(collector_.surface(), place(knot_, at)).z(); };
    const double z = height(t);
    const double noise = 1e-14 * (1.0 + std::abs(z));
    const double way = valley ? 1.0 : -1.0;
    const auto opposes = [&](auto turn, auto last) {
      for (; turn != last; ++turn) {
        const double rise = way * (height(*turn) - z);
        if (std::abs(rise) > noise) return rise < 0.0;
      }
      return false;
    };
    const auto after = std::upper_bound(turns_.begin(), turns_.end(), t);
    const auto before = std::lower_bound(turns_.begin(), turns_.end(), t);
    if (opposes(after, turns_.end()) || opposes(std::reverse_iterator(before), turns_.rend())) {
      return CriticalKind::saddle;
    }
    return valley ? CriticalKind::minimum : CriticalKind::maximum;
  }

  /// Between two of the four arms of the creases the height rises as a linear function does, so that its sign changes
  /// once if it differs on the arms, and else not at all.
  [[nodiscard]] Ring ring_at_corner(double t, double room, const Slopes& slopes) const {
    const Eigen::Array4d rise(slopes.across[2], slopes.along[1], -slopes.across[0], -slopes.along[0]);
    if (!(rise.abs().minCoeff() > slopes.negligible)) {
      return look_around(collector_.surface(), place(knot_, t), 1e-6 * place(room_across_, room));
    }
    Ring ring{0, (rise > 0.0).any(), (rise < 0.0).any()};
    for (int k = 0; k < 4; ++k) ring.changes += (rise[k] > 0.0) != (rise[(k + 1) % 4] > 0.0) ? 1 : 0;
    return ring;
  }

  /// Where two creases cross.
  void add_corner(double t, double room, const Slopes& slopes) {
    const double least = slopes.negligible;
    if (have_one_sign(slopes.across, least) || have_one_sign(slopes.along, least)) return;
    // Stationary in one of the patches, which is searched for itself.
    if ((slopes.across.abs() <= least && slopes.along.abs() <= least).any()) return;
    const Ring ring = ring_at_corner(t, room, slopes);
    if (ring.changes == 2) return;
    collector_.add_point(place(knot_, t), ring.above || ring.below ? kind_of(ring) : CriticalKind::saddle);
  }

  const BSplineSurface& spline_;
  bool along_v_;
  double knot_;
  double room_across_;
  std::vector<double> turns_;  ///< ascending: where the height along the crease may turn, and the ends of it
  CriticalCollector& collector_;
};

}  // namespace

double room_between_knots(const std::vector<double>& knots, double t) {
  double room = std::numeric_limits<double>::infinity();
  for (const double knot : knots) {
    if (knot != t) room = std::min(room, std::abs(knot - t));
  }
  return room;
}

StationaryParameters find_stationary(const Curve3& curve, const Interval& range, const Vec3& direction) {
  StationaryParameters found;
  const auto* spline = std::get_if<BSplineCurve<3>>(&curve);
  found.flat = std::visit([&](const auto& c) { return flat_pieces(c, range, direction); }, curve);
  found.isolated = critical_parameters(curve, range, direction);
  std::erase_if(found.isolated, [&](double t) {
    const auto holds = [&](const Interval& piece) { return piece.contains(t); };
    return std::any_of(found.flat.begin(), found.flat.end(), holds) ||
           (spline != nullptr && passes_through(*spline, t, direction));
  });
  return found;
}

void search_creases(const BSplineSurface& surface, CriticalCollector& collector) {
  for (const bool along_v : {true, false}) {
    const Interval domain = along_v ? surface.domain_u() : surface.domain_v();
    const Interval wanted = collector.range(along_v ? 0 : 1);
    const Interval range{std::max(domain.lo, wanted.lo), std::min(domain.hi, wanted.hi)};
    for (const double knot : crease_knots(surface, along_v, range)) Crease(surface, along_v, knot, collector).search();
  }
}

}  // namespace lamella
