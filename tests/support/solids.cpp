#include "tests/support/solids.h"

#include <array>
#include <cmath>

#include "tests/support/solid_builder.h"

namespace lamella::test {

namespace {

constexpr Interval kFullTurn{0.0, kTwoPi};

Frame frame_at(const Vec3& origin) { return {origin, Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}; }

/// z down, right-handed.
Frame frame_below(const Vec3& origin) { return {origin, Vec3::UnitX(), -Vec3::UnitY(), -Vec3::UnitZ()}; }

using Loop2 = std::vector<std::pair<std::size_t, bool>>;

Loop2 polygon(SolidPlan& plan, const std::vector<std::size_t>& corners) {
  Loop2 loop;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    loop.push_back(plan.line(corners[i], corners[(i + 1) % corners.size()]));
  }
  return loop;
}

/// Plane face over a polygon, counterclockwise seen from outside, with `holes` cut out.
FacePlan polygon_face(SolidPlan& plan, const std::vector<std::size_t>& corners, const std::vector<Loop2>& holes = {}) {
  const Vec3& a = plan.vertices[corners[0]];
  const Vec3 x = (plan.vertices[corners[1]] - a).normalized();
  const Vec3 z = x.cross(plan.vertices[corners[2]] - a).normalized();
  std::vector<Loop2> loops{polygon(plan, corners)};
  loops.insert(loops.end(), holes.begin(), holes.end());
  return planar_face(plan, {a, x, z.cross(x), z}, loops);
}

/// Corner k of a box has x from bit 0, y from bit 1, z from bit 2. Faces are -x, +x, -y, +y, -z, +z.
constexpr std::array<std::array<std::size_t, 4>, 6> kBoxFaces = {
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

void add_box_corners(SolidPlan& plan, const Vec3& lo, const Vec3& hi) {
  for (int k = 0; k < 8; ++k) {
    plan.vertex({k & 1 ? hi.x() : lo.x(), k & 2 ? hi.y() : lo.y(), k & 4 ? hi.z() : lo.z()});
  }
}

std::vector<FacePlan> box_faces(SolidPlan& plan, const Loop2& bottom_hole = {}, const Loop2& top_hole = {}) {
  std::vector<FacePlan> faces;
  for (std::size_t i = 0; i < kBoxFaces.size(); ++i) {
    const auto& corners = kBoxFaces[i];
    std::vector<Loop2> holes;
    if (i == 4 && !bottom_hole.empty()) holes.push_back(bottom_hole);
    if (i == 5 && !top_hole.empty()) holes.push_back(top_hole);
    faces.push_back(polygon_face(plan, {corners.begin(), corners.end()}, holes));
  }
  return faces;
}

double box_volume(const Vec3& lo, const Vec3& hi) { return (hi - lo).prod(); }

double box_area(const Vec3& lo, const Vec3& hi) {
  const Vec3 d = hi - lo;
  return 2.0 * (d.x() * d.y() + d.y() * d.z() + d.z() * d.x());
}

struct Circle {
  std::size_t vertex;
  std::size_t edge;
};

/// A circle about the vertical through `center`, starting at +x.
Circle add_circle(SolidPlan& plan, const Vec3& center, double radius) {
  const std::size_t vertex = plan.vertex(center + radius * Vec3::UnitX());
  const Ellipse<3> curve{center, radius * Vec3::UnitX(), radius * Vec3::UnitY()};
  return {vertex, plan.edge(curve, kFullTurn, vertex, vertex)};
}

std::size_t add_seam_line(SolidPlan& plan, std::size_t from, std::size_t to) {
  const Vec3 way = plan.vertices[to] - plan.vertices[from];
  return plan.edge(Line<3>{plan.vertices[from], way.normalized()}, {0.0, way.norm()}, from, to);
}

/// The one-face shell of a sphere about `center`.
FacePlan sphere_face(SolidPlan& plan, const Vec3& center, double radius) {
  const std::size_t south = plan.vertex(center - radius * Vec3::UnitZ());
  const std::size_t north = plan.vertex(center + radius * Vec3::UnitZ());
  const Interval latitude{-0.5 * kPi, 0.5 * kPi};
  const Ellipse<3> meridian{center, radius * Vec3::UnitX(), radius * Vec3::UnitZ()};
  const std::size_t seam = plan.edge(meridian, latitude, south, north);
  const std::size_t bottom = plan.degenerate_edge(kFullTurn, south);
  const std::size_t top = plan.degenerate_edge(kFullTurn, north);
  return rectangle_face(Sphere{frame_at(center), radius}, kFullTurn, latitude, plan, bottom, seam, top, seam);
}

/// Lateral face between two circles about z, v measured along the surface from the lower one.
FacePlan lateral_face(SolidPlan& plan, const Surface& surface, const Circle& lower, const Circle& upper) {
  const std::size_t seam = add_seam_line(plan, lower.vertex, upper.vertex);
  return rectangle_face(surface, kFullTurn, plan.edges[seam].range, plan, lower.edge, seam, upper.edge, seam);
}

/// Heights of the dome's 4 x 4 net: corners h, border h + bump / 2, inner h + bump.
double dome_height(int i, int j, double h, double bump) {
  const int rim = (i == 0 || i == 3) + (j == 0 || j == 3);
  return h + bump * (1.0 - 0.5 * rim);
}

BSplineSurface dome_surface(double a, double b, double h, double bump) {
  BSplineSurface top{3, 3, 4, 4, {0, 0, 0, 0, 1, 1, 1, 1}, {0, 0, 0, 0, 1, 1, 1, 1}, {}, {}};
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) top.poles.emplace_back(a * i / 3.0, b * j / 3.0, dome_height(i, j, h, bump));
  }
  return top;
}

/// The border of the dome's top through poles first, first + step, ...
std::size_t dome_edge(SolidPlan& plan, const BSplineSurface& top, std::size_t first, std::size_t step,
                      std::size_t start, std::size_t end) {
  BSplineCurve<3> curve{3, top.knots_u, {}, {}};
  for (std::size_t i = 0; i < 4; ++i) curve.poles.push_back(top.poles[first + i * step]);
  return plan.edge(curve, {0.0, 1.0}, start, end);
}

/// Side wall of the dome: from bottom corner `from` to `to`, closed on top by `rim` used in the sense `forward`.
FacePlan dome_wall(SolidPlan& plan, std::size_t from, std::size_t to, std::size_t rim, bool forward) {
  const Vec3 x = (plan.vertices[to] - plan.vertices[from]).normalized();
  const Vec3 y = Vec3::UnitZ();
  const Frame frame{plan.vertices[from], x, y, x.cross(y)};
  const Loop2 loop{plan.line(from, to), plan.line(to, to + 4), {rim, forward}, plan.line(from + 4, from)};
  return planar_face(plan, frame, {loop});
}

}  // namespace

Placement Placement::turned(const Vec3& axis, double angle, const Vec3& translation) {
  return {Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix(), translation};
}

Placement Placement::mirrored(const Vec3& normal, const Vec3& translation) {
  const Vec3 n = normal.normalized();
  return {Mat3::Identity() - 2.0 * n * n.transpose(), translation};
}

KnownSolid add_box(Scene& scene, const Vec3& lo, const Vec3& hi, const SolidOptions& options) {
  SolidPlan plan;
  add_box_corners(plan, lo, hi);
  plan.shells.push_back(box_faces(plan));
  return {enter(scene, plan, options), box_volume(lo, hi), box_area(lo, hi)};
}

KnownSolid add_cylinder(Scene& scene, double radius, double height, const SolidOptions& options) {
  SolidPlan plan;
  const Vec3 top_center = height * Vec3::UnitZ();
  const Circle lower = add_circle(plan, Vec3::Zero(), radius);
  const Circle upper = add_circle(plan, top_center, radius);
  plan.shells.push_back({lateral_face(plan, Cylinder{Frame{}, radius}, lower, upper),
                         planar_face(plan, frame_below(Vec3::Zero()), {{{lower.edge, false}}}),
                         planar_face(plan, frame_at(top_center), {{{upper.edge, true}}})});
  return {enter(scene, plan, options), kPi * radius * radius * height, kTwoPi * radius * (radius + height)};
}

KnownSolid add_frustum(Scene& scene, double r0, double r1, double height, const SolidOptions& options) {
  SolidPlan plan;
  const Vec3 top_center = height * Vec3::UnitZ();
  const Circle lower = add_circle(plan, Vec3::Zero(), r0);
  const Circle upper = add_circle(plan, top_center, r1);
  const Cone cone{Frame{}, r0, std::atan2(r1 - r0, height)};
  plan.shells.push_back({lateral_face(plan, cone, lower, upper),
                         planar_face(plan, frame_below(Vec3::Zero()), {{{lower.edge, false}}}),
                         planar_face(plan, frame_at(top_center), {{{upper.edge, true}}})});
  const double volume = kPi * height * (r0 * r0 + r0 * r1 + r1 * r1) / 3.0;
  const double area = kPi * (r0 * r0 + r1 * r1 + (r0 + r1) * std::hypot(height, r1 - r0));
  return {enter(scene, plan, options), volume, area};
}

KnownSolid add_cone(Scene& scene, double radius, double height, const SolidOptions& options) {
  SolidPlan plan;
  const Circle lower = add_circle(plan, Vec3::Zero(), radius);
  const std::size_t apex = plan.vertex(height * Vec3::UnitZ());
  const Circle upper{apex, plan.degenerate_edge(kFullTurn, apex)};
  const Cone cone{Frame{}, radius, -std::atan2(radius, height)};
  plan.shells.push_back(
      {lateral_face(plan, cone, lower, upper), planar_face(plan, frame_below(Vec3::Zero()), {{{lower.edge, false}}})});
  const double area = kPi * radius * (radius + std::hypot(radius, height));
  return {enter(scene, plan, options), kPi * radius * radius * height / 3.0, area};
}

KnownSolid add_sphere(Scene& scene, double radius, const SolidOptions& options) {
  SolidPlan plan;
  plan.shells.push_back({sphere_face(plan, Vec3::Zero(), radius)});
  return {enter(scene, plan, options), 4.0 / 3.0 * kPi * radius * radius * radius, 4.0 * kPi * radius * radius};
}

KnownSolid add_torus(Scene& scene, double major, double minor, const SolidOptions& options) {
  SolidPlan plan;
  const Circle equator = add_circle(plan, Vec3::Zero(), major + minor);
  const Ellipse<3> meridian{major * Vec3::UnitX(), minor * Vec3::UnitX(), minor * Vec3::UnitZ()};
  const std::size_t tube = plan.edge(meridian, kFullTurn, equator.vertex, equator.vertex);
  plan.shells.push_back({rectangle_face(Torus{Frame{}, major, minor}, kFullTurn, kFullTurn, plan, equator.edge, tube,
                                        equator.edge, tube)});
  return {enter(scene, plan, options), 2.0 * kPi * kPi * major * minor * minor, 4.0 * kPi * kPi * major * minor};
}

KnownSolid add_dome(Scene& scene, double a, double b, double h, double bump, const SolidOptions& options) {
  SolidPlan plan;
  add_box_corners(plan, Vec3::Zero(), {a, b, h});
  const BSplineSurface top = dome_surface(a, b, h, bump);
  const std::size_t south = dome_edge(plan, top, 0, 4, 4, 5);
  const std::size_t north = dome_edge(plan, top, 3, 4, 6, 7);
  const std::size_t west = dome_edge(plan, top, 0, 1, 4, 6);
  const std::size_t east = dome_edge(plan, top, 12, 1, 5, 7);
  constexpr Interval kUnit{0.0, 1.0};
  plan.shells.push_back({polygon_face(plan, {0, 2, 3, 1}), dome_wall(plan, 0, 1, south, false),
                         dome_wall(plan, 1, 3, east, false), dome_wall(plan, 3, 2, north, true),
                         dome_wall(plan, 2, 0, west, true),
                         rectangle_face(top, kUnit, kUnit, plan, south, east, north, west)});
  // The mean of a Bernstein polynomial is the mean of its coefficients: 4 inner, 8 border, 4 corner ones of 16.
  return {enter(scene, plan, options), a * b * (h + 0.5 * bump), std::nullopt};
}

KnownSolid add_box_with_hole(Scene& scene, const Vec3& lo, const Vec3& hi, double hole_radius,
                             const SolidOptions& options) {
  SolidPlan plan;
  add_box_corners(plan, lo, hi);
  const Vec3 middle = 0.5 * (lo + hi);
  const Vec3 below{middle.x(), middle.y(), lo.z()};
  const Vec3 above{middle.x(), middle.y(), hi.z()};
  const Circle lower = add_circle(plan, below, hole_radius);
  const Circle upper = add_circle(plan, above, hole_radius);
  auto faces = box_faces(plan, {{lower.edge, true}}, {{upper.edge, false}});
  FacePlan wall = lateral_face(plan, Cylinder{frame_at(below), hole_radius}, lower, upper);
  wall.same_sense = false;
  faces.push_back(std::move(wall));
  plan.shells.push_back(std::move(faces));
  const double height = hi.z() - lo.z();
  const double disc = kPi * hole_radius * hole_radius;
  return {enter(scene, plan, options), box_volume(lo, hi) - disc * height,
          box_area(lo, hi) - 2.0 * disc + kTwoPi * hole_radius * height};
}

KnownSolid add_box_with_void(Scene& scene, const Vec3& lo, const Vec3& hi, double void_radius,
                             const SolidOptions& options) {
  SolidPlan plan;
  add_box_corners(plan, lo, hi);
  plan.shells.push_back(box_faces(plan));
  FacePlan cavity = sphere_face(plan, 0.5 * (lo + hi), void_radius);
  cavity.same_sense = false;
  plan.shells.push_back({std::move(cavity)});
  const double r2 = void_radius * void_radius;
  return {enter(scene, plan, options), box_volume(lo, hi) - 4.0 / 3.0 * kPi * r2 * void_radius,
          box_area(lo, hi) + 4.0 * kPi * r2};
}

Scene touching_boxes() {
  Scene scene;
  SolidOptions left;
  left.name = "left";
  left.color = Color{0.8, 0.2, 0.2};
  add_box(scene, Vec3::Zero(), Vec3::Ones(), left);
  SolidOptions right;
  right.name = "right";
  right.color = Color{0.2, 0.2, 0.8};
  add_box(scene, {1.0, 0.0, 0.0}, {2.0, 1.0, 1.0}, right);
  return scene;
}

Scene overlapping_boxes() {
  Scene scene;
  SolidOptions first;
  first.name = "first";
  first.color = Color{0.9, 0.6, 0.1};
  add_box(scene, Vec3::Zero(), Vec3::Constant(2.0), first);
  SolidOptions second;
  second.name = "second";
  second.color = Color{0.1, 0.6, 0.9};
  add_box(scene, Vec3::Ones(), Vec3::Constant(3.0), second);
  return scene;
}

}  // namespace lamella::test
