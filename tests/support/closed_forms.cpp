#include "tests/support/closed_forms.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella::test {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Where (o + t d)^T diag(w) (o + t d) < c.
std::vector<Interval> quadric_spans(const Ray& ray, const Vec3& w, double c) {
  const Vec3& o = ray.origin;
  const Vec3& d = ray.direction;
  return below_zero(w.dot(d.cwiseProduct(d)), w.dot(o.cwiseProduct(d)), w.dot(o.cwiseProduct(o)) - c);
}

long double value_at(const std::vector<long double>& polynomial, long double t) {
  long double sum = 0.0L;
  for (std::size_t i = polynomial.size(); i-- > 0;) sum = sum * t + polynomial[i];
  return sum;
}

/// The root between two points of different sign: Newton's iteration, halving where it leaves the bracket.
long double find_root(const std::vector<long double>& polynomial, const std::vector<long double>& derivative,
                      long double lo, long double hi) {
  const bool is_negative = value_at(polynomial, lo) < 0.0L;
  long double t = 0.5L * (lo + hi);
  for (int step = 0; step < 200 && lo < t && t < hi; ++step) {
    const long double value = value_at(polynomial, t);
    ((value < 0.0L) == is_negative ? lo : hi) = t;
    const long double next = t - value / value_at(derivative, t);
    const long double last = t;
    t = next > lo && next < hi ? next : 0.5L * (lo + hi);
    if (std::abs(t - last) <= 1e-19L * std::abs(t)) break;
  }
  return t;
}

}  // namespace

std::vector<Interval> below_zero(double a, double b, double c) {
  if (a == 0.0) {
    if (b == 0.0) return c < 0.0 ? std::vector<Interval>{{-kInfinity, kInfinity}} : std::vector<Interval>{};
    const double root = -0.5 * c / b;
    return {b > 0.0 ? Interval{-kInfinity, root} : Interval{root, kInfinity}};
  }
  const double discriminant = b * b - a * c;
  if (discriminant <= 0.0) return a > 0.0 ? std::vector<Interval>{} : std::vector<Interval>{{-kInfinity, kInfinity}};
  // Without cancellation: one root by the larger sum, the other by Vieta.
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  const double first = std::min(q / a, c / q);
  const double second = std::max(q / a, c / q);
  if (a > 0.0) return {{first, second}};
  return {{-kInfinity, first}, {second, kInfinity}};
}

std::vector<Interval> intersect(const std::vector<Interval>& spans, Interval with) {
  std::vector<Interval> result;
  for (const Interval& span : spans) {
    const Interval both{std::max(span.lo, with.lo), std::min(span.hi, with.hi)};
    if (both.lo < both.hi) result.push_back(both);
  }
  return result;
}

Interval slab_span(double o, double d, double lo, double hi) {
  if (d == 0.0) return o >= lo && o < hi ? Interval{-kInfinity, kInfinity} : Interval{0.0, 0.0};
  return {std::min((lo - o) / d, (hi - o) / d), std::max((lo - o) / d, (hi - o) / d)};
}

std::vector<Interval> box_spans(const Ray& ray, const Vec3& lo, const Vec3& hi) {
  std::vector<Interval> spans{{-kInfinity, kInfinity}};
  for (int k = 0; k < 3; ++k) spans = intersect(spans, slab_span(ray.origin[k], ray.direction[k], lo[k], hi[k]));
  return spans;
}

std::vector<Interval> ellipsoid_spans(const Ray& ray, const Vec3& half_axes) {
  return quadric_spans(ray, half_axes.cwiseProduct(half_axes).cwiseInverse(), 1.0);
}

std::vector<Interval> sphere_spans(const Ray& ray, double radius) {
  return quadric_spans(ray, Vec3::Ones(), radius * radius);
}

std::vector<Interval> cylinder_spans(const Ray& ray, double half_x, double half_y, double height) {
  const Vec3 weights(1.0 / (half_x * half_x), 1.0 / (half_y * half_y), 0.0);
  return intersect(quadric_spans(ray, weights, 1.0), slab_span(ray.origin.z(), ray.direction.z(), 0.0, height));
}

std::vector<Interval> cylinder_spans(const Ray& ray, double radius, double height) {
  return intersect(quadric_spans(ray, Vec3(1.0, 1.0, 0.0), radius * radius),
                   slab_span(ray.origin.z(), ray.direction.z(), 0.0, height));
}

std::vector<Interval> frustum_spans(const Ray& ray, double r0, double r1, double height) {
  const double slope = (r1 - r0) / height;
  const Ray from_apex{ray.origin + Vec3(0.0, 0.0, r0 / slope), ray.direction};
  return intersect(quadric_spans(from_apex, Vec3(1.0, 1.0, -slope * slope), 0.0),
                   slab_span(ray.origin.z(), ray.direction.z(), 0.0, height));
}

std::vector<Interval> hyperboloid_spans(const Ray& ray, double waist, double slope, double half_height) {
  return intersect(quadric_spans(ray, Vec3(1.0, 1.0, -slope * slope), waist * waist),
                   slab_span(ray.origin.z(), ray.direction.z(), -half_height, half_height));
}

std::vector<Interval> ring_spans(const Ray& ray, double major, double wide, double high) {
  // With q = x^2 + y^2: (q + R^2 - a^2 + (a z / b)^2)^2 < 4 R^2 q. Measured from the point nearest to the origin, so
  // that the powers of t stay small.
  const double middle = -ray.origin.dot(ray.direction);
  const Vec3 o = ray.at(middle);
  const Vec3& d = ray.direction;
  const long double stretch = static_cast<long double>(wide) / high;
  const auto horizontal = [](const Vec3& a, const Vec3& b) {
    return static_cast<long double>(a.x()) * b.x() + static_cast<long double>(a.y()) * b.y();
  };
  const auto upright = [&](const Vec3& a, const Vec3& b) { return stretch * stretch * a.z() * b.z(); };
  const long double q[3] = {horizontal(o, o), 2.0L * horizontal(o, d), horizontal(d, d)};
  const long double r2 = static_cast<long double>(major) * major;
  const long double p[3] = {q[0] + upright(o, o) + r2 - static_cast<long double>(wide) * wide,
                            q[1] + 2.0L * upright(o, d), q[2] + upright(d, d)};
  const std::vector<long double> quartic{p[0] * p[0] - 4.0L * r2 * q[0], 2.0L * p[0] * p[1] - 4.0L * r2 * q[1],
                                         p[1] * p[1] + 2.0L * p[0] * p[2] - 4.0L * r2 * q[2], 2.0L * p[1] * p[2],
                                         p[2] * p[2]};
  const std::vector<long double> roots = real_roots(quartic);
  std::vector<Interval> spans;
  for (std::size_t k = 0; k + 1 < roots.size(); ++k) {
    if (value_at(quartic, 0.5L * (roots[k] + roots[k + 1])) >= 0.0L) continue;
    spans.push_back({middle + static_cast<double>(roots[k]), middle + static_cast<double>(roots[k + 1])});
  }
  return spans;
}

std::vector<long double> real_roots(const std::vector<long double>& polynomial) {
  if (polynomial.size() < 2) return {};
  // Cauchy's bound on the roots.
  long double reach = 0.0L;
  for (std::size_t i = 0; i + 1 < polynomial.size(); ++i) {
    reach = std::max(reach, 1.0L + std::abs(polynomial[i] / polynomial.back()));
  }
  std::vector<long double> derivative;
  for (std::size_t i = 1; i < polynomial.size(); ++i) derivative.push_back(static_cast<long double>(i) * polynomial[i]);
  std::vector<long double> stops{-reach};
  for (const long double turn : real_roots(derivative)) stops.push_back(turn);
  stops.push_back(reach);
  std::vector<long double> roots;
  for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
    const bool is_negative = value_at(polynomial, stops[i]) < 0.0L;
    if (is_negative == (value_at(polynomial, stops[i + 1]) < 0.0L)) continue;
    roots.push_back(find_root(polynomial, derivative, stops[i], stops[i + 1]));
  }
  return roots;
}

}  // namespace lamella::test
