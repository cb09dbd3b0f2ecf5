#pragma once

#include <vector>

#include "core/geometry.h"
#include "model/critical_points.h"
#include "model/curve.h"
#include "model/rational_form.h"
#include "model/surface.h"

/// What the parts of find_critical_points() share.
namespace lamella {

/// A set of critical points whose heights differ by no more than this, in mm, has one level.
inline constexpr double kLevelAccuracy = 1e-7;
/// Components of unit vectors below this are nothing but rounding.
inline constexpr double kParallel = 1e-12;

/// value + k period inside `range`, ascending; just `value`, if inside, without a period. At most 4096.
[[nodiscard]] std::vector<double> copies_within(double value, double period, const Interval& range);

/// Gathers what is found, brings points home to the surface, and drops repetitions at the end.
class CriticalCollector {
 public:
  CriticalCollector(const Surface& surface, const Box2& uv_bounds);

  [[nodiscard]] const Surface& surface() const { return surface_; }
  /// The bounds asked for, padded by 1e-9.
  [[nodiscard]] const Box2& bounds() const { return bounds_; }
  [[nodiscard]] Interval range(int axis) const { return {bounds_.min()[axis], bounds_.max()[axis]}; }

  /// A point that is known exactly, if within bounds.
  void add_point(const Vec2& uv, CriticalKind kind);
  /// Its every copy by the surface's periods.
  void add_copies(const Vec2& uv, CriticalKind kind);
  /// A point near `uv`: Newton's method improves it, the second derivatives tell its kind.
  void add_near(const Vec2& uv);
  /// `exact` levels are preferred to others within the accuracy of levels.
  void add_level(double z, bool exact = true) { (exact ? exact_levels_ : levels_).push_back(z); }
  void give_up() { found_.complete = false; }

  /// Everything found, without repetitions.
  [[nodiscard]] CriticalPoints take();

 private:
  void merge_points();
  void merge_levels();

  const Surface& surface_;
  Box2 bounds_;
  CriticalPoints found_;
  std::vector<double> exact_levels_;
  std::vector<double> levels_;
};

/// By the signs of the second derivatives, made comparable by `size`, the size of the surface's parameter range.
[[nodiscard]] CriticalKind kind_by_curvature(const Surface& surface, const Vec2& uv, const Vec2& size);

/// How the height around a place compares to the height there.
struct Ring {
  int changes = 0;     ///< of its sign, going round
  bool above = false;  ///< somewhere
  bool below = false;
};
[[nodiscard]] Ring look_around(const Surface& surface, const Vec2& uv, const Vec2& radius);

[[nodiscard]] CriticalKind kind_of(const Ring& ring);

/// Where along a curve the height direction . C is stationary.
struct StationaryParameters {
  std::vector<double> isolated;  ///< extrema, inflections, and corners where the slope changes sign
  std::vector<Interval> flat;    ///< whole pieces along which the height stays within kLevelAccuracy
};
[[nodiscard]] StationaryParameters find_stationary(const Curve3& curve, const Interval& range, const Vec3& direction);

/// Smallest distance from `t` to another knot.
[[nodiscard]] double room_between_knots(const std::vector<double>& knots, double t);

void search_extrusion(const Extrusion& extrusion, CriticalCollector& collector);
void search_revolution(const Revolution& revolution, CriticalCollector& collector);

/// Branch and bound over Bezier nets of the surface whose z is `reference` below the surface's.
void search_patches(const RationalForm& form, double reference, CriticalCollector& collector);

/// Extrema, saddles and horizontal stretches along the lines where a B-spline surface is only continuous.
void search_creases(const BSplineSurface& surface, CriticalCollector& collector);

}  // namespace lamella
