#pragma once

#include <functional>
#include <vector>

#include "core/geometry.h"

/// Where lines run inside solids, by their equations alone.
namespace lamella::test {

/// The exact spans of a line, ascending and disjoint.
using ExactSpans = std::function<std::vector<Interval>(const Ray&)>;

/// Where a t^2 + 2 b t + c < 0; unbounded spans when a < 0.
[[nodiscard]] std::vector<Interval> below_zero(double a, double b, double c);
[[nodiscard]] std::vector<Interval> intersect(const std::vector<Interval>& spans, Interval with);

/// Where lo <= o + t d < hi, the half-open slab.
[[nodiscard]] Interval slab_span(double o, double d, double lo, double hi);

[[nodiscard]] std::vector<Interval> box_spans(const Ray& ray, const Vec3& lo, const Vec3& hi);
/// The ellipsoid about the origin with these half axes.
[[nodiscard]] std::vector<Interval> ellipsoid_spans(const Ray& ray, const Vec3& half_axes);
[[nodiscard]] std::vector<Interval> sphere_spans(const Ray& ray, double radius);
/// The elliptic cylinder from z = 0 to `height`.
[[nodiscard]] std::vector<Interval> cylinder_spans(const Ray& ray, double half_x, double half_y, double height);
[[nodiscard]] std::vector<Interval> cylinder_spans(const Ray& ray, double radius, double height);
/// Cone frustum with radius r0 at z = 0 and r1 at z = height; r1 = 0 gives a cone.
[[nodiscard]] std::vector<Interval> frustum_spans(const Ray& ray, double r0, double r1, double height);
/// x^2 + y^2 < waist^2 + (slope z)^2 for |z| < half_height: a hyperboloid of one sheet.
[[nodiscard]] std::vector<Interval> hyperboloid_spans(const Ray& ray, double waist, double slope, double half_height);
/// The ring about z whose section is an ellipse with half axes `wide` (radially) and `high`; a torus where they agree.
[[nodiscard]] std::vector<Interval> ring_spans(const Ray& ray, double major, double wide, double high);

/// All real roots of the polynomial with these coefficients (ascending, the last not zero), each once, ascending.
[[nodiscard]] std::vector<long double> real_roots(const std::vector<long double>& polynomial);

}  // namespace lamella::test
