#include <algorithm>
#include <cmath>
#include <type_traits>

#include "model/critical_detail.h"
#include "model/evaluate.h"
#include "model/rational_form.h"

namespace lamella {

namespace {

void add_levels(const Curve3& curve, const StationaryParameters& found, double lift, CriticalCollector& collector) {
  for (const double t : found.isolated) collector.add_level(evaluate<3>(curve, t).point.z() + lift);
  for (const Interval& piece : found.flat) {
    collector.add_level(evaluate<3>(curve, piece.middle()).point.z() + lift);
  }
}

/// Points on the curve or its control polygon and vectors along it, whose plane is that of the curve.
struct CurveHull {
  std::vector<Vec3> points;
  std::vector<Vec3> vectors;
};

CurveHull hull_of(const Curve3& curve) {
  return std::visit(
      [&](const auto& c) -> CurveHull {
        using Shape = std::decay_t<decltype(c)>;
        if constexpr (std::is_same_v<Shape, Line<3>>) {
          return {{}, {c.direction}};
        } else if constexpr (std::is_same_v<Shape, Parabola<3>>) {
          return {{c.apex}, {c.axis, c.tangent}};
        } else if constexpr (std::is_same_v<Shape, BSplineCurve<3>>) {
          return {c.poles, {}};
        } else {
          return {{c.center}, {c.major, c.minor}};
        }
      },
      curve);
}

/// How a meridian lies to its axis.
struct MeridianPlane {
  Vec3 outward = Vec3::Zero();  ///< unit, at right angles to the axis
  double reach = 0.0;           ///< mm, about the largest distance from the axis
  bool planar = true;           ///< it lies in a plane with the axis
};

MeridianPlane plane_of(const Revolution& revolution, const Interval& range) {
  const Vec3& axis = revolution.axis_direction;
  const auto across = [&](const Vec3& way) -> Vec3 { return way - axis.dot(way) * axis; };
  CurveHull hull = hull_of(revolution.meridian);
  for (const double t : {range.lo, range.middle(), range.hi}) {
    hull.points.push_back(evaluate<3>(revolution.meridian, t).point);
  }
  for (const Vec3& point : hull.points) hull.vectors.push_back(point - revolution.axis_origin);
  MeridianPlane plane;
  double size = 0.0;
  for (const Vec3& way : hull.vectors) {
    const Vec3 arm = across(way);
    size = std::max(size, way.norm());
    if (!(arm.norm() > plane.reach)) continue;
    plane.reach = arm.norm();
    plane.outward = arm / plane.reach;
  }
  const Vec3 normal = axis.cross(plane.outward);
  for (const Vec3& way : hull.vectors) plane.planar = plane.planar && std::abs(normal.dot(way)) <= 1e-9 * size;
  return plane;
}

/// The meridian's corners sweep circles on which the surface is only continuous.
bool is_corner(const BSplineCurve<3>& meridian, double t) {
  return std::count(meridian.knots.begin(), meridian.knots.end(), t) >= meridian.degree;
}

void add_corner(const BSplineCurve<3>& meridian, const Vec2& uv, CriticalCollector& collector) {
  // Heights change at once across the circle, along it they only bend.
  const Vec2 radius(1e-3, 1e-6 * room_between_knots(meridian.knots, uv[1]));
  const Ring ring = look_around(collector.surface(), uv, radius);
  if (ring.changes != 2) collector.add_point(uv, kind_of(ring));
}

void add_meridian_point(const Curve3& meridian, const Vec2& uv, CriticalCollector& collector) {
  const auto* spline = std::get_if<BSplineCurve<3>>(&meridian);
  if (spline != nullptr && is_corner(*spline, uv[1])) {
    add_corner(*spline, uv, collector);
  } else {
    collector.add_near(uv);
  }
}

/// The horizontal projection of z on the planes at right angles to the axis; the axis isn't vertical.
Vec3 uphill_of(const Vec3& axis) { return (Vec3::UnitZ() - axis.z() * axis).normalized(); }

/// The angle by which `way` must be turned about the axis to point uphill.
double turn_uphill(const Vec3& axis, const Vec3& way) {
  const Vec3 uphill = uphill_of(axis);
  return std::atan2(axis.dot(way.cross(uphill)), way.dot(uphill));
}

/// A meridian in a plane with the axis is stationary in u where it is turned into the plane of axis and z; there its
/// height is that of the meridian along a direction turned the other way.
void search_turned(const Revolution& revolution, const MeridianPlane& plane, CriticalCollector& collector) {
  const Vec3& axis = revolution.axis_direction;
  const double turn = turn_uphill(axis, plane.outward);
  for (const int side : {1, -1}) {
    const double u = side > 0 ? turn : turn + kPi;
    const std::vector<double> turns = copies_within(u, kTwoPi, collector.range(0));
    if (turns.empty()) continue;
    const Vec3 direction = axis.z() * axis + side * uphill_of(axis).z() * plane.outward;
    const StationaryParameters found = find_stationary(revolution.meridian, collector.range(1), direction);
    for (const Interval& piece : found.flat) {
      collector.add_level(evaluate_point(collector.surface(), {u, piece.middle()}).z());
    }
    for (const double t : found.isolated) {
      for (const double copy : turns) add_meridian_point(revolution.meridian, {copy, t}, collector);
    }
  }
}

/// Other meridians, as of a hyperboloid by a skew line: the nets know how to search.
void search_skew(const Revolution& revolution, CriticalCollector& collector) {
  search_patches(rational_form(collector.surface(), collector.bounds()), 0.0, collector);
  const auto* spline = std::get_if<BSplineCurve<3>>(&revolution.meridian);
  if (spline == nullptr) return;
  for (const double t : spline->knots) {
    if (!is_corner(*spline, t) || !(t > spline->knots.front() && t < spline->knots.back())) continue;
    const Vec3 way = evaluate<3>(revolution.meridian, t).point - revolution.axis_origin;
    const double turn = turn_uphill(revolution.axis_direction, way);
    for (const double u : {turn, turn + kPi}) {
      for (const double copy : copies_within(u, kTwoPi, collector.range(0))) add_corner(*spline, {copy, t}, collector);
    }
  }
}

}  // namespace

void search_extrusion(const Extrusion& extrusion, CriticalCollector& collector) {
  const Interval v = collector.range(1);
  const double slope = extrusion.direction.z();
  if (std::abs(slope) > kParallel && std::abs(slope) * v.length() > kLevelAccuracy) return;
  const StationaryParameters found = find_stationary(extrusion.basis, collector.range(0), Vec3::UnitZ());
  add_levels(extrusion.basis, found, slope * v.middle(), collector);
}

void search_revolution(const Revolution& revolution, CriticalCollector& collector) {
  const Interval v = collector.range(1);
  const MeridianPlane plane = plane_of(revolution, v);
  const double lean = std::hypot(revolution.axis_direction.x(), revolution.axis_direction.y());
  const double wobble = lean * plane.reach;
  // Circles of critical points, or, as far as levels can tell, nearly; up to ten times that both are given.
  if (wobble <= 10.0 * kLevelAccuracy) {
    add_levels(revolution.meridian, find_stationary(revolution.meridian, v, Vec3::UnitZ()), 0.0, collector);
  }
  if (!(wobble > kLevelAccuracy)) return;
  if (plane.planar) {
    search_turned(revolution, plane, collector);
  } else {
    search_skew(revolution, collector);
  }
}

}  // namespace lamella
