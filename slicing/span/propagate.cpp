#include "slicing/span/propagate.h"

#include <algorithm>
#include <cmath>

namespace lamella::span {

namespace {

constexpr double kLargestTurn = 0.6;  // radians between neighbouring points

/// A longer correction than this share of the way that a point was moved means that the extrapolation is off.
constexpr double kCorrectionShare = 0.3;

/// The step along the free way of a point that changes z by dz.
Vec2 step_for(const SurfacePoint& at, int axis, double dz) {
  if (axis < 0) return steepest_step(at, dz);
  Vec2 step = Vec2::Zero();
  step[1 - axis] = dz / (axis == 0 ? at.dv.z() : at.du.z());
  return step;
}

class Carrier {
 public:
  Carrier(const SectionSurface& surface, double sign, double z, const TraceLimits& limits, CarriedArc& carried)
      : surface_(surface), sign_(sign), z_(z), limits_(limits), carried_(carried) {}

  bool run(const SectionPoint& begin, const SectionPoint& end) {
    const std::size_t last = carried_.arc.pieces.size();
    for (std::size_t i = 0; i <= last; ++i) {
      const Cell& cell = carried_.arc.cells[std::min(i, last - 1)];
      Place place{carried_.arc.points[i], cell, carried_.arc.axes[i], false, carried_.velocity[i], Vec2::Zero()};
      if (i == 0 || i == last) {
        place.fixed = true;
        if (!place_end(i == 0 ? begin : end, place)) return false;
      } else {
        // One between cells can't be spared.
        place.fixed = !(carried_.arc.cells[i - 1] == cell);
        if (!move_point(i, place)) {
          if (place.fixed) return false;
          continue;
        }
      }
      places_.push_back(place);
    }
    return join_places();
  }

 private:
  /// A point on its way to the new height.
  struct Place {
    SectionPoint point;
    Cell cell;  ///< of the piece that begins here
    int axis = -1;
    bool fixed = false;  ///< an end, or between two cells
    Vec2 velocity;
    Vec2 last_velocity;
  };

  bool place_end(const SectionPoint& given, Place& place) const {
    const Vec2& periods = surface_.periods();
    Vec2 uv = given.uv;
    for (int axis = 0; axis < 2; ++axis) {
      if (periods[axis] > 0.0)
        uv[axis] += periods[axis] * std::round((place.point.uv[axis] - uv[axis]) / periods[axis]);
    }
    // Beyond its cell the piece would go on analytically, the surface doesn't.
    if (!surface_.holds(place.cell, uv, -1)) return false;
    place.point = surface_.has_cells() ? section_point(surface_.evaluate(uv, place.cell), uv, sign_) : given;
    place.point.uv = uv;
    place.point.z = z_;
    return place.point.uv_bend.allFinite();
  }

  bool move_point(std::size_t i, Place& place) const {
    const double dz = z_ - carried_.z;
    Vec2 step = carried_.velocity[i] * dz;
    // Two layers may be nearly one, and say nothing then.
    if (!carried_.last_velocity.empty() && std::abs(dz) < 16.0 * std::abs(carried_.z - carried_.last_z)) {
      step += (carried_.velocity[i] - carried_.last_velocity[i]) * (0.5 * dz * dz / (carried_.z - carried_.last_z));
    }
    const std::vector<SectionPoint>& points = carried_.arc.points;
    const double scale = std::max((points[i + 1].xy - points[i].xy).norm(), (points[i - 1].xy - points[i].xy).norm());
    Vec2 uv = points[i].uv + step;
    SurfacePoint2 at = surface_.evaluate(uv, place.cell);
    const double moved = (at.du * step[0] + at.dv * step[1]).norm();
    Vec2 correction = step_for(at, place.axis, z_ - at.point.z());
    double off = (at.du * correction[0] + at.dv * correction[1]).norm();
    if (!(off <= kCorrectionShare * moved)) return false;
    for (int attempt = 0; off > kExactShift * scale; ++attempt) {
      if (attempt == 3) return false;
      uv += correction;
      at = surface_.evaluate(uv, place.cell);
      correction = step_for(at, place.axis, z_ - at.point.z());
      off = (at.du * correction[0] + at.dv * correction[1]).norm();
    }
    uv += correction;
    if (!surface_.holds(place.cell, uv, place.axis)) return false;
    shift(at, correction);
    place.point = section_point(at, uv, sign_);
    place.point.z = z_;
    place.last_velocity = carried_.velocity[i];
    place.velocity = step_for(at, place.axis, 1.0);
    return place.point.uv_bend.allFinite();
  }

  /// Joins the places to pieces; where two don't join, a place is put between them or the second one left out.
  bool join_places() {
    TracedArc& arc = carried_.arc;
    const std::size_t target = arc.target;
    arc.clear();
    carried_.velocity.clear();
    carried_.last_velocity.clear();
    keep(places_.front());
    for (std::size_t i = 0; i + 1 < places_.size();) {
      std::size_t next = i + 1;
      while (!join(places_[i], places_[next], kMaxHalvings)) {
        if (places_[next].fixed) return false;
        ++next;
      }
      i = next;
    }
    arc.target = target;
    arc.landed = true;
    carried_.last_z = carried_.z;
    carried_.z = z_;
    return true;
  }

  void keep(const Place& place) {
    carried_.arc.points.push_back(place.point);
    carried_.arc.axes.push_back(static_cast<std::int8_t>(place.axis));
    carried_.velocity.push_back(place.velocity);
    carried_.last_velocity.push_back(place.last_velocity);
  }

  bool join(const Place& a, const Place& b, int halvings) {
    SectionPoint end = b.point;
    // The end of this piece as its own cell sees it.
    if (!(a.cell == b.cell)) {
      end = section_point(surface_.evaluate(end.uv, a.cell), end.uv, sign_);
      end.z = z_;
    }
    ArcPiece piece;
    if (fits(a, end, piece)) {
      carried_.arc.pieces.push_back(piece);
      carried_.arc.cells.push_back(a.cell);
      keep(b);
      return true;
    }
    if (halvings == 0) return false;
    const Vec2 uv = 0.5 * (a.point.uv + end.uv);
    const double chord = (end.xy - a.point.xy).norm();
    const auto middle = correct(surface_, a.cell, uv, z_, sign_, -1, {0.3 * chord});
    if (!middle || !surface_.holds(a.cell, middle->uv, -1)) return false;
    Place between{*middle, a.cell, -1, false, rise_of(*middle, -1), Vec2::Zero()};
    between.point.z = z_;
    between.last_velocity = between.velocity;
    const std::size_t kept = carried_.arc.pieces.size();
    if (join(a, between, halvings - 1) && join(between, b, halvings - 1)) return true;
    drop_to(kept);
    return false;
  }

  bool fits(const Place& a, const SectionPoint& end, ArcPiece& piece) const {
    if (!(a.point.tangent.dot(end.tangent) > std::cos(kLargestTurn))) return false;
    const PieceFit fit = fit_piece(surface_, a.cell, a.point, end);
    piece = fit.piece;
    return fit.error <= 2.0 * limits_.tolerance;
  }

  void drop_to(std::size_t pieces) {
    carried_.arc.pieces.resize(pieces);
    carried_.arc.cells.resize(pieces);
    carried_.arc.points.resize(pieces + 1);
    carried_.arc.axes.resize(pieces + 1);
    carried_.velocity.resize(pieces + 1);
    carried_.last_velocity.resize(pieces + 1);
  }

  /// Corrections shorter than this share of a piece are taken from the second derivatives: what is left out is of third
  /// order, 1e-12 of the piece.
  static constexpr double kExactShift = 1e-4;
  static constexpr int kMaxHalvings = 3;

  const SectionSurface& surface_;
  double sign_;
  double z_;
  const TraceLimits& limits_;
  CarriedArc& carried_;
  std::vector<Place> places_;
};

}  // namespace

void CarriedArc::start(double height) {
  z = height;
  last_velocity.clear();
  velocity.clear();
  for (std::size_t i = 0; i < arc.points.size(); ++i) velocity.push_back(rise_of(arc.points[i], arc.axes[i]));
}

bool carry(const SectionSurface& surface, double sign, const SectionPoint& begin, const SectionPoint& end, double z,
           const TraceLimits& limits, CarriedArc& carried) {
  return Carrier(surface, sign, z, limits, carried).run(begin, end);
}

}  // namespace lamella::span
