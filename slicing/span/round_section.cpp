#include "slicing/span/round_section.h"

#include <algorithm>
#include <cmath>

namespace lamella::span {

namespace {

/// Below this the ellipses of a leaning cylinder get so long that their centre loses digits (1e-2: two of them).
constexpr double kLeastRise = 1e-2;

/// An axis counts as vertical when it leans by rounding only.
constexpr double kVertical = 1e-14;

constexpr double kLongestStep = 0.6;  // radians of one quintic

bool is_vertical(const Frame& frame) {
  return std::abs(frame.x.z()) <= kVertical && std::abs(frame.y.z()) <= kVertical;
}

Vec2 flat(const Vec3& v) { return v.head<2>(); }

double root_of(double square) { return std::sqrt(std::max(0.0, square)); }

PlaneEllipse circle(const Frame& frame, double radius) {
  return {flat(frame.origin), radius * flat(frame.x), radius * flat(frame.y)};
}

PlaneEllipse section_of(const Sphere& sphere, double z) {
  const double height = z - sphere.frame.origin.z();
  const double radius = root_of((sphere.radius - height) * (sphere.radius + height));
  return {flat(sphere.frame.origin), Vec2(radius, 0.0), Vec2(0.0, radius)};
}

PlaneEllipse section_of(const Cylinder& cylinder, double z) {
  const Frame& f = cylinder.frame;
  const double per_rise = 1.0 / f.z.z();
  return {flat(f.origin) + ((z - f.origin.z()) * per_rise) * flat(f.z),
          cylinder.radius * (flat(f.x) - (f.x.z() * per_rise) * flat(f.z)),
          cylinder.radius * (flat(f.y) - (f.y.z() * per_rise) * flat(f.z))};
}

double length_at(const Cone& cone, double z) {
  return (z - cone.frame.origin.z()) / (std::cos(cone.half_angle) * cone.frame.z.z());
}

PlaneEllipse section_of(const Cone& cone, double z) {
  return circle(cone.frame, cone.radius + length_at(cone, z) * std::sin(cone.half_angle));
}

PlaneEllipse section_of(const Torus& torus, double z, bool inner) {
  const double height = z - torus.frame.origin.z();
  const double reach = root_of((torus.minor_radius - height) * (torus.minor_radius + height));
  return circle(torus.frame, torus.major_radius + (inner ? -reach : reach));
}

/// Quintic with the positions, tangents and curvatures of the ellipse over one step.
ArcPiece piece_of(const PlaneEllipse& ellipse, double from, double step) {
  const auto slope = [&](double a) -> Vec2 {
    return (std::cos(a) * ellipse.sine - std::sin(a) * ellipse.cosine) * step;
  };
  const auto bend = [&](double a) -> Vec2 { return (ellipse.center - ellipse.at(a)) * (step * step); };
  const double to = from + step;
  const Vec2 p = ellipse.at(from), d = slope(from), h = 0.5 * bend(from);
  const Vec2 rest = ellipse.at(to) - p - d - h;
  const Vec2 slope_rest = slope(to) - d - 2.0 * h;
  const Vec2 bend_rest = bend(to) - 2.0 * h;
  const Vec2 c3 = 10.0 * rest - 4.0 * slope_rest + 0.5 * bend_rest;
  const Vec2 c4 = -15.0 * rest + 7.0 * slope_rest - bend_rest;
  const Vec2 c5 = 6.0 * rest - 3.0 * slope_rest + 0.5 * bend_rest;
  return {{p.x(), d.x(), h.x(), c3.x(), c4.x(), c5.x()}, {p.y(), d.y(), h.y(), c3.y(), c4.y(), c5.y()}};
}

}  // namespace

double PlaneEllipse::angle_of(const Vec2& xy) const {
  const Vec2 arm = xy - center;
  // Cramer's rule without its determinant, whose sign alone matters.
  const double c = arm.x() * sine.y() - arm.y() * sine.x();
  const double s = cosine.x() * arm.y() - cosine.y() * arm.x();
  const double side = cosine.x() * sine.y() - cosine.y() * sine.x() < 0.0 ? -1.0 : 1.0;
  return std::atan2(side * s, side * c);
}

bool has_round_sections(const Surface& surface) {
  if (std::holds_alternative<Sphere>(surface)) return true;
  if (const auto* cylinder = std::get_if<Cylinder>(&surface)) return std::abs(cylinder->frame.z.z()) >= kLeastRise;
  if (const auto* cone = std::get_if<Cone>(&surface)) return is_vertical(cone->frame);
  const auto* torus = std::get_if<Torus>(&surface);
  // A spindle's two circles are not told apart by being inner and outer.
  return torus != nullptr && is_vertical(torus->frame) && torus->major_radius > torus->minor_radius;
}

PlaneEllipse round_section(const Surface& surface, double z, bool inner) {
  if (const auto* sphere = std::get_if<Sphere>(&surface)) return section_of(*sphere, z);
  if (const auto* cylinder = std::get_if<Cylinder>(&surface)) return section_of(*cylinder, z);
  if (const auto* cone = std::get_if<Cone>(&surface)) return section_of(*cone, z);
  return section_of(std::get<Torus>(surface), z, inner);
}

Vec2 round_parameters(const Surface& surface, double z, bool inner, double angle) {
  if (const auto* sphere = std::get_if<Sphere>(&surface)) {
    const Frame& f = sphere->frame;
    Vec3 arm = Vec3::Zero();
    arm << section_of(*sphere, z).at(angle) - flat(f.origin), z - f.origin.z();
    const Vec3 local = Vec3(arm.dot(f.x), arm.dot(f.y), arm.dot(f.z)) / sphere->radius;
    return {std::atan2(local.y(), local.x()), std::asin(std::clamp(local.z(), -1.0, 1.0))};
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&surface)) {
    const Frame& f = cylinder->frame;
    const double side = cylinder->radius * (std::cos(angle) * f.x.z() + std::sin(angle) * f.y.z());
    return {angle, (z - f.origin.z() - side) / f.z.z()};
  }
  if (const auto* cone = std::get_if<Cone>(&surface)) return {angle, length_at(*cone, z)};
  const auto& torus = std::get<Torus>(surface);
  const double height = (z - torus.frame.origin.z()) * torus.frame.z.z() / torus.minor_radius;
  const double v = std::asin(std::clamp(height, -1.0, 1.0));
  return {angle, inner ? kPi - v : v};
}

void append_pieces(const EllipseArc& arc, double tolerance, std::vector<ArcPiece>& pieces) {
  const double size = std::max(arc.ellipse.cosine.norm(), arc.ellipse.sine.norm());
  // Hermite's remainder in the middle: 1/6! of the sixth derivative times (step / 2)^6 is size * step^6 / 46080.
  const double step = std::min(kLongestStep, std::pow(46080.0 * tolerance / size, 1.0 / 6.0));
  const int count = std::max(1, static_cast<int>(std::ceil(std::abs(arc.sweep) / step)));
  for (int i = 0; i < count; ++i) {
    pieces.push_back(piece_of(arc.ellipse, arc.begin + arc.sweep * i / count, arc.sweep / count));
  }
}

}  // namespace lamella::span
