#include "model/critical_points.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "model/critical_detail.h"
#include "model/evaluate.h"

namespace lamella {

namespace {

/// The height of a surface of a frame and a meridian (radius r(v), height h(v)) is
/// z(u, v) = origin + lean r(v) cos(u - top) + rise h(v).
struct Tilt {
  double origin;
  double lean;  ///< sine of the angle between the frame's Z and z
  double rise;  ///< and its cosine
  double top;

  explicit Tilt(const Frame& frame)
      : origin(frame.origin.z()),
        lean(std::hypot(frame.x.z(), frame.y.z())),
        rise(frame.z.z()),
        top(std::atan2(frame.y.z(), frame.x.z())) {}

  /// The u at which cos(u - top) is `side`, 1 or -1.
  [[nodiscard]] double at_side(int side) const { return side > 0 ? top : top + kPi; }
};

void search(const Plane&, CriticalCollector&) {}

/// Cylinders and cones: z_u vanishes along the two rulings that lean the most, and there z_v is constant.
void search_rulings(const Tilt& tilt, double radius, double half_angle, CriticalCollector& collector) {
  const Interval v = collector.range(1);
  for (const int side : {1, -1}) {
    const double slope = side * tilt.lean * std::sin(half_angle) + tilt.rise * std::cos(half_angle);
    const bool horizontal = std::abs(slope) < kParallel || std::abs(slope) * v.length() <= kLevelAccuracy;
    if (!horizontal || copies_within(tilt.at_side(side), kTwoPi, collector.range(0)).empty()) continue;
    collector.add_level(tilt.origin + side * tilt.lean * radius + slope * v.middle());
  }
}

void search(const Cylinder& cylinder, CriticalCollector& collector) {
  search_rulings(Tilt(cylinder.frame), cylinder.radius, 0.0, collector);
}

void search(const Cone& cone, CriticalCollector& collector) {
  search_rulings(Tilt(cone.frame), cone.radius, cone.half_angle, collector);
}

void search(const Sphere& sphere, CriticalCollector& collector) {
  const Tilt tilt(sphere.frame);
  const Interval u = collector.range(0);
  for (const int side : {1, -1}) {
    const CriticalKind kind = side > 0 ? CriticalKind::maximum : CriticalKind::minimum;
    const double v = side * std::atan2(tilt.rise, tilt.lean);
    if (tilt.lean < 1e-9) {
      // At a pole every u is the same place.
      collector.add_point({u.middle(), std::copysign(0.5 * kPi, v)}, kind);
    } else {
      collector.add_copies({tilt.at_side(side), v}, kind);
    }
  }
}

CriticalKind kind_of_curvatures(double uu, double vv, double negligible) {
  if (!(std::abs(uu) > negligible)) return CriticalKind::flat;
  if ((uu > 0.0) != (vv > 0.0)) return CriticalKind::saddle;
  return uu > 0.0 ? CriticalKind::minimum : CriticalKind::maximum;
}

/// Where u is at a side, the meridian circle has its highest and its lowest point.
void search_sides(const Torus& torus, const Tilt& tilt, CriticalCollector& collector) {
  for (const int side : {1, -1}) {
    for (const int end : {1, -1}) {
      const double v = std::atan2(end * tilt.rise, end * side * tilt.lean);
      const double radius = torus.major_radius + torus.minor_radius * std::cos(v);
      const double bend = -side * tilt.lean * radius;
      const double size = torus.major_radius + torus.minor_radius;
      collector.add_copies({tilt.at_side(side), v}, kind_of_curvatures(bend, -end, kParallel * size));
    }
  }
}

/// A vertical torus touches horizontal planes along circles; so does, as far as levels can tell, one that hardly leans.
void search_circles(const Torus& torus, const Tilt& tilt, CriticalCollector& collector) {
  for (const int end : {1, -1}) {
    if (copies_within(end * 0.5 * kPi, kTwoPi, collector.range(1)).empty()) continue;
    collector.add_level(tilt.origin + end * torus.minor_radius * tilt.rise);
  }
}

/// Where a spindle torus meets its axis, z_u vanishes for all u, and z_v for some if the axis leans far enough.
void search_apexes(const Torus& torus, const Tilt& tilt, CriticalCollector& collector) {
  if (torus.major_radius > torus.minor_radius) return;
  const double apex = std::acos(-torus.major_radius / torus.minor_radius);
  for (const int end : {1, -1}) {
    if (copies_within(end * apex, kTwoPi, collector.range(1)).empty()) continue;
    collector.add_level(tilt.origin + end * torus.minor_radius * std::sin(apex) * tilt.rise);
    const double cosine = end * std::cos(apex) * tilt.rise / (std::sin(apex) * tilt.lean);
    if (!(std::abs(cosine) < 1.0)) continue;
    for (const int way : {1, -1}) {
      collector.add_copies({tilt.top + way * std::acos(cosine), end * apex}, CriticalKind::saddle);
    }
  }
}

void search(const Torus& torus, CriticalCollector& collector) {
  const Tilt tilt(torus.frame);
  const double wobble = tilt.lean * (torus.major_radius + torus.minor_radius);
  // Up to ten times the accuracy of levels both are given: the points are there, but not where to a millionth.
  if (wobble <= 10.0 * kLevelAccuracy) search_circles(torus, tilt, collector);
  if (wobble > kLevelAccuracy) search_sides(torus, tilt, collector);
  search_apexes(torus, tilt, collector);
}

void search(const Extrusion& extrusion, CriticalCollector& collector) { search_extrusion(extrusion, collector); }

void search(const Revolution& revolution, CriticalCollector& collector) { search_revolution(revolution, collector); }

/// Heights of parts far from z = 0 lose digits in differences; taken from the middle they don't.
double middle_height(const BSplineSurface& spline) {
  Interval range{spline.poles.front().z(), spline.poles.front().z()};
  for (const Vec3& pole : spline.poles) {
    range.lo = std::min(range.lo, pole.z());
    range.hi = std::max(range.hi, pole.z());
  }
  return range.middle();
}

void search_spline(const BSplineSurface& spline, CriticalCollector& collector) {
  const double reference = middle_height(spline);
  BSplineSurface lowered = spline;
  for (Vec3& pole : lowered.poles) pole.z() -= reference;
  const Interval u = collector.range(0);
  const Interval v = collector.range(1);
  RationalForm form;
  for (BezierPatch& patch : split_to_bezier(lowered)) {
    const bool apart = patch.u.hi <= u.lo || patch.u.lo >= u.hi || patch.v.hi <= v.lo || patch.v.lo >= v.hi;
    if (apart) continue;
    const bool whole = u.lo <= patch.u.lo && patch.u.hi <= u.hi && v.lo <= patch.v.lo && patch.v.hi <= v.hi;
    form.patches.push_back(whole ? std::move(patch) : restrict_to(patch, u, v));
  }
  search_patches(form, reference, collector);
  search_creases(spline, collector);
}

void search(const BSplineSurface& spline, CriticalCollector& collector) { search_spline(spline, collector); }

void search(const FittedSurface& fitted, CriticalCollector& collector) { search_spline(fitted.fit, collector); }

template <class Spline>
bool is_finite_spline(const Spline& spline) {
  const auto finite_point = [](const Vec3& point) { return point.allFinite(); };
  return std::all_of(spline.poles.begin(), spline.poles.end(), finite_point);
}

bool are_finite(const std::vector<double>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
}

bool is_finite(const BSplineSurface& spline) {
  return is_finite_spline(spline) && are_finite(spline.knots_u) && are_finite(spline.knots_v) &&
         are_finite(spline.weights);
}

bool is_finite(const Curve3& curve) {
  const auto* spline = std::get_if<BSplineCurve<3>>(&curve);
  return spline == nullptr || (is_finite_spline(*spline) && are_finite(spline->knots) && are_finite(spline->weights));
}

/// Other surfaces have numbers enough in common with any of their points.
bool is_finite(const Surface& surface, const Vec2& somewhere) {
  const bool net_is = std::visit(
      [](const auto& shape) -> bool {
        using Shape = std::decay_t<decltype(shape)>;
        if constexpr (std::is_same_v<Shape, BSplineSurface>) return is_finite(shape);
        if constexpr (std::is_same_v<Shape, FittedSurface>) return is_finite(shape.fit);
        if constexpr (std::is_same_v<Shape, Extrusion>) return is_finite(shape.basis);
        if constexpr (std::is_same_v<Shape, Revolution>) return is_finite(shape.meridian);
        return true;
      },
      surface);
  return net_is && evaluate_point(surface, somewhere).allFinite();
}

}  // namespace

CriticalPoints find_critical_points(const Surface& surface, const Box2& uv_bounds) {
  if (uv_bounds.min().allFinite() && uv_bounds.max().allFinite() && uv_bounds.isEmpty()) return {};
  CriticalCollector collector(surface, uv_bounds);
  if (!uv_bounds.sizes().allFinite() || !is_finite(surface, uv_bounds.center())) {
    collector.give_up();
  } else {
    std::visit([&](const auto& shape) { search(shape, collector); }, surface);
  }
  return collector.take();
}

}  // namespace lamella
