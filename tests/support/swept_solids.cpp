#include "tests/support/swept_solids.h"

#include <cmath>

#include "tests/support/solid_builder.h"

namespace lamella::test {

namespace {

constexpr Interval kFullTurn{0.0, kTwoPi};

Frame frame_at(double z) { return {z * Vec3::UnitZ(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}; }
/// z down, right-handed.
Frame frame_below(double z) { return {z * Vec3::UnitZ(), Vec3::UnitX(), -Vec3::UnitY(), -Vec3::UnitZ()}; }

struct Rim {
  std::size_t vertex;
  std::size_t edge;
};

/// A closed edge that starts at center + major.
Rim add_rim(SolidPlan& plan, const Vec3& center, const Vec3& major, const Vec3& minor) {
  const std::size_t vertex = plan.vertex(center + major);
  return {vertex, plan.edge(Ellipse<3>{center, major, minor}, kFullTurn, vertex, vertex)};
}

/// The circle about z through a point.
Rim add_circle(SolidPlan& plan, const Vec3& through) {
  const Vec3 major(through.x(), through.y(), 0.0);
  return add_rim(plan, through.z() * Vec3::UnitZ(), major, Vec3::UnitZ().cross(major));
}

/// A side that runs once round between two rims, and the two flat ends.
void close_with_discs(SolidPlan& plan, const Surface& side, Interval v, const Rim& lower, const Rim& upper,
                      std::size_t seam) {
  plan.shells.push_back({rectangle_face(side, kFullTurn, v, plan, lower.edge, seam, upper.edge, seam),
                         planar_face(plan, frame_below(plan.vertices[lower.vertex].z()), {{{lower.edge, false}}}),
                         planar_face(plan, frame_at(plan.vertices[upper.vertex].z()), {{{upper.edge, true}}})});
}

}  // namespace

KnownSolid add_extruded_ellipse(Scene& scene, double half_x, double half_y, double height,
                                const SolidOptions& options) {
  SolidPlan plan;
  const Vec3 major = half_x * Vec3::UnitX();
  const Vec3 minor = half_y * Vec3::UnitY();
  const Rim lower = add_rim(plan, Vec3::Zero(), major, minor);
  const Rim upper = add_rim(plan, height * Vec3::UnitZ(), major, minor);
  const Interval v{0.0, height};
  const std::size_t seam = plan.edge(Line<3>{major, Vec3::UnitZ()}, v, lower.vertex, upper.vertex);
  close_with_discs(plan, Extrusion{Ellipse<3>{Vec3::Zero(), major, minor}, Vec3::UnitZ()}, v, lower, upper, seam);
  return {enter(scene, plan, options), kPi * half_x * half_y * height, std::nullopt};
}

KnownSolid add_revolved_ring(Scene& scene, double major, double wide, double high, const SolidOptions& options) {
  SolidPlan plan;
  const Ellipse<3> meridian{major * Vec3::UnitX(), wide * Vec3::UnitX(), high * Vec3::UnitZ()};
  const Rim equator = add_circle(plan, (major + wide) * Vec3::UnitX());
  const std::size_t tube = plan.edge(meridian, kFullTurn, equator.vertex, equator.vertex);
  const Revolution ring{meridian, Vec3::Zero(), Vec3::UnitZ()};
  plan.shells.push_back({rectangle_face(ring, kFullTurn, kFullTurn, plan, equator.edge, tube, equator.edge, tube)});
  return {enter(scene, plan, options), 2.0 * kPi * kPi * major * wide * high, std::nullopt};
}

KnownSolid add_revolved_ellipsoid(Scene& scene, double radius, double half_height, const SolidOptions& options) {
  SolidPlan plan;
  const Interval latitude{-0.5 * kPi, 0.5 * kPi};
  const Ellipse<3> meridian{Vec3::Zero(), radius * Vec3::UnitX(), half_height * Vec3::UnitZ()};
  const std::size_t south = plan.vertex(-half_height * Vec3::UnitZ());
  const std::size_t north = plan.vertex(half_height * Vec3::UnitZ());
  const std::size_t seam = plan.edge(meridian, latitude, south, north);
  const std::size_t bottom = plan.degenerate_edge(kFullTurn, south);
  const std::size_t top = plan.degenerate_edge(kFullTurn, north);
  const Revolution surface{meridian, Vec3::Zero(), Vec3::UnitZ()};
  plan.shells.push_back({rectangle_face(surface, kFullTurn, latitude, plan, bottom, seam, top, seam)});
  return {enter(scene, plan, options), 4.0 / 3.0 * kPi * radius * radius * half_height, std::nullopt};
}

KnownSolid add_revolved_line(Scene& scene, const Vec3& from, const Vec3& to, const SolidOptions& options) {
  SolidPlan plan;
  const Rim lower = add_circle(plan, from);
  const Rim upper = add_circle(plan, to);
  const Line<3> meridian{from, to - from};
  const Interval v{0.0, 1.0};
  const std::size_t seam = plan.edge(meridian, v, lower.vertex, upper.vertex);
  close_with_discs(plan, Revolution{meridian, Vec3::Zero(), Vec3::UnitZ()}, v, lower, upper, seam);
  // The squared radius along z is that of a linear function of z with values in the plane.
  const Vec2 a = from.head<2>();
  const Vec2 b = to.head<2>();
  const double squares = (a.squaredNorm() + a.dot(b) + b.squaredNorm()) / 3.0;
  return {enter(scene, plan, options), kPi * (to.z() - from.z()) * squares, std::nullopt};
}

}  // namespace lamella::test
