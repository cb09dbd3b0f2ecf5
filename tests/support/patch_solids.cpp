#include "tests/support/patch_solids.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "model/evaluate.h"
#include "tests/support/solid_builder.h"

namespace lamella::test {

namespace {

/// Rows: the Bernstein polynomials of one degree at equidistant points of [0, 1].
Eigen::MatrixXd bernstein_matrix(int degree) {
  Eigen::MatrixXd matrix(degree + 1, degree + 1);
  for (int i = 0; i <= degree; ++i) {
    const double t = degree == 0 ? 0.0 : static_cast<double>(i) / degree;
    double binomial = 1.0;
    for (int k = 0; k <= degree; ++k) {
      matrix(i, k) = binomial * std::pow(t, k) * std::pow(1.0 - t, degree - k);
      binomial = binomial * (degree - k) / (k + 1);
    }
  }
  return matrix;
}

std::vector<double> bezier_knots_of(int degree, Interval range) {
  std::vector<double> knots(static_cast<std::size_t>(degree) + 1, range.lo);
  knots.insert(knots.end(), static_cast<std::size_t>(degree) + 1, range.hi);
  return knots;
}

/// The border of a patch: v = const through pole row `first` (along u), or u = const.
BSplineCurve<3> border(const BSplineSurface& patch, bool along_u, bool last) {
  BSplineCurve<3> curve;
  curve.degree = along_u ? patch.degree_u : patch.degree_v;
  curve.knots = along_u ? patch.knots_u : patch.knots_v;
  const int count = along_u ? patch.count_u : patch.count_v;
  for (int k = 0; k < count; ++k) {
    const int i = along_u ? k : (last ? patch.count_u - 1 : 0);
    const int j = along_u ? (last ? patch.count_v - 1 : 0) : k;
    const auto pole = static_cast<std::size_t>(i * patch.count_v + j);
    curve.poles.push_back(patch.poles[pole]);
    if (!patch.weights.empty()) curve.weights.push_back(patch.weights[pole]);
  }
  return curve;
}

BSplineCurve<3> moved(BSplineCurve<3> curve, const Vec3& way) {
  for (Vec3& pole : curve.poles) pole += way;
  return curve;
}

/// The rim of a patch: corners (lo, lo), (hi, lo), (lo, hi), (hi, hi) in (u, v), and its four sides.
struct Rim {
  std::size_t corners[4];
  std::size_t bottom, right, top, left;
};

Rim add_rim(SolidPlan& plan, const BSplineSurface& patch, const Vec3& way) {
  const Interval u = patch.domain_u();
  const Interval v = patch.domain_v();
  Rim rim{};
  for (int k = 0; k < 4; ++k) {
    const std::size_t i = k & 1 ? static_cast<std::size_t>(patch.count_u - 1) : 0;
    const std::size_t j = k & 2 ? static_cast<std::size_t>(patch.count_v - 1) : 0;
    rim.corners[k] = plan.vertex(patch.poles[i * static_cast<std::size_t>(patch.count_v) + j] + way);
  }
  rim.bottom = plan.edge(moved(border(patch, true, false), way), u, rim.corners[0], rim.corners[1]);
  rim.top = plan.edge(moved(border(patch, true, true), way), u, rim.corners[2], rim.corners[3]);
  rim.left = plan.edge(moved(border(patch, false, false), way), v, rim.corners[0], rim.corners[2]);
  rim.right = plan.edge(moved(border(patch, false, true), way), v, rim.corners[1], rim.corners[3]);
  return rim;
}

/// Volume of what a patch sweeps along `way`, by the midpoint rule.
double swept_volume(const BSplineSurface& patch, const Vec3& way) {
  constexpr int kNodes = 200;
  double sum = 0.0;
  const Interval u = patch.domain_u();
  const Interval v = patch.domain_v();
  for (int i = 0; i < kNodes; ++i) {
    for (int j = 0; j < kNodes; ++j) {
      const Vec2 uv(u.lo + u.length() * (i + 0.5) / kNodes, v.lo + v.length() * (j + 0.5) / kNodes);
      sum += evaluate(patch, uv).normal().dot(way);
    }
  }
  return std::abs(sum) * u.length() * v.length() / (kNodes * kNodes);
}

}  // namespace

BSplineSurface polynomial_patch(const std::function<Vec3(double, double)>& at, int degree, Interval u, Interval v) {
  const Eigen::MatrixXd inverse = bernstein_matrix(degree).inverse();
  const int count = degree + 1;
  BSplineSurface patch{degree, degree, count, count, bezier_knots_of(degree, u), bezier_knots_of(degree, v), {}, {}};
  Eigen::MatrixXd values[3];
  for (int axis = 0; axis < 3; ++axis) values[axis].resize(count, count);
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      const Vec3 point = at(u.lo + u.length() * i / degree, v.lo + v.length() * j / degree);
      for (int axis = 0; axis < 3; ++axis) values[axis](i, j) = point[axis];
    }
  }
  for (Eigen::MatrixXd& grid : values) grid = inverse * grid * inverse.transpose();
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) patch.poles.emplace_back(values[0](i, j), values[1](i, j), values[2](i, j));
  }
  return patch;
}

KnownSolid add_swept_patch(Scene& scene, const BSplineSurface& patch, const Vec3& way, const SolidOptions& options) {
  SolidPlan plan;
  const Rim base = add_rim(plan, patch, Vec3::Zero());
  const Rim lid = add_rim(plan, patch, way);
  const double length = way.norm();
  std::size_t posts[4];
  for (int k = 0; k < 4; ++k) {
    posts[k] = plan.edge(Line<3>{plan.vertices[base.corners[k]], way / length}, {0.0, length}, base.corners[k],
                         lid.corners[k]);
  }
  const Vec2 middle(patch.domain_u().middle(), patch.domain_v().middle());
  const bool runs_along = evaluate(patch, middle).normal().dot(way) > 0.0;
  BSplineSurface lid_surface = patch;
  for (Vec3& pole : lid_surface.poles) pole += way;
  std::vector<FacePlan> faces;
  const auto add = [&](FacePlan face, bool same_sense) {
    face.same_sense = same_sense;
    faces.push_back(std::move(face));
  };
  const Interval u = patch.domain_u();
  const Interval v = patch.domain_v();
  add(rectangle_face(patch, u, v, plan, base.bottom, base.right, base.top, base.left), !runs_along);
  add(rectangle_face(lid_surface, u, v, plan, lid.bottom, lid.right, lid.top, lid.left), runs_along);
  // A side's normal, border x way, points outward where the border runs with the patch on its left seen against way.
  const auto add_side = [&](std::size_t low, std::size_t high, Interval range, int from, int to, bool with_loop) {
    const Extrusion side{plan.edges[low].curve, way / length};
    add(rectangle_face(side, range, {0.0, length}, plan, low, posts[to], high, posts[from]), with_loop == runs_along);
  };
  add_side(base.bottom, lid.bottom, u, 0, 1, true);
  add_side(base.right, lid.right, v, 1, 3, true);
  add_side(base.top, lid.top, u, 2, 3, false);
  add_side(base.left, lid.left, v, 0, 2, false);
  plan.shells.push_back(std::move(faces));
  return {enter(scene, plan, options), swept_volume(patch, way), std::nullopt};
}

KnownSolid add_pierced_dome(Scene& scene, double half, const SolidOptions& options) {
  SolidPlan plan;
  constexpr double kFloor = -2.0;
  const auto height = [](double x, double y) { return 1.0 - x * x - y * y; };
  const BSplineSurface dome =
      polynomial_patch([&](double x, double y) { return Vec3(x, y, height(x, y)); }, 2, {-1.0, 1.0}, {-1.0, 1.0});
  // Corners counterclockwise; [0] outer, [1] of the tunnel; below and above.
  const double sizes[2] = {1.0, half};
  std::size_t below[2][4];
  std::size_t above[2][4];
  std::size_t arcs[2][4];
  constexpr int kSign[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  for (int ring = 0; ring < 2; ++ring) {
    for (int k = 0; k < 4; ++k) {
      const Vec2 at(sizes[ring] * kSign[k][0], sizes[ring] * kSign[k][1]);
      below[ring][k] = plan.vertex({at.x(), at.y(), kFloor});
      above[ring][k] = plan.vertex({at.x(), at.y(), height(at.x(), at.y())});
    }
    for (int k = 0; k < 4; ++k) {
      const Vec3& a = plan.vertices[above[ring][k]];
      const Vec3& b = plan.vertices[above[ring][(k + 1) % 4]];
      // A parabola over the chord: its middle pole lies where the end tangents meet.
      const double rise = 2.0 * height(0.5 * (a.x() + b.x()), 0.5 * (a.y() + b.y())) - 0.5 * (a.z() + b.z());
      const Vec3 middle(0.5 * (a.x() + b.x()), 0.5 * (a.y() + b.y()), rise);
      const BSplineCurve<3> arc{2, {0, 0, 0, 1, 1, 1}, {a, middle, b}, {}};
      arcs[ring][k] = plan.edge(arc, {0.0, 1.0}, above[ring][k], above[ring][(k + 1) % 4]);
    }
  }
  std::vector<FacePlan> faces;
  using Uses = std::vector<std::pair<std::size_t, bool>>;
  Uses floor_loops[2];
  FacePlan top{dome, true, {{}, {}}};
  for (int ring = 0; ring < 2; ++ring) {
    const bool is_outer = ring == 0;
    for (int k = 0; k < 4; ++k) {
      // Walls seen from outside of the material: the tunnel's run the other way.
      const int from = is_outer ? k : (k + 1) % 4;
      const int to = is_outer ? (k + 1) % 4 : k;
      const Vec3 x = (plan.vertices[below[ring][to]] - plan.vertices[below[ring][from]]).normalized();
      const Vec3 up = Vec3::UnitZ();
      const Frame frame{plan.vertices[below[ring][from]], x, up, x.cross(up)};
      const Uses loop{plan.line(below[ring][from], below[ring][to]),
                      plan.line(below[ring][to], above[ring][to]),
                      {arcs[ring][k], !is_outer},
                      plan.line(above[ring][from], below[ring][from])};
      faces.push_back(planar_face(plan, frame, {loop}));
      floor_loops[ring].push_back(plan.line(below[ring][to], below[ring][from]));
      const Vec2 a = plan.vertices[above[ring][k]].head<2>();
      const Vec2 b = plan.vertices[above[ring][(k + 1) % 4]].head<2>();
      top.loops[ring].push_back({arcs[ring][k], is_outer, line_pcurve(a, b, {0.0, 1.0})});
    }
  }
  // Counterclockwise seen from outside: from below for the floor, so its outer loop and the holes run backwards.
  std::reverse(floor_loops[0].begin(), floor_loops[0].end());
  std::reverse(top.loops[1].begin(), top.loops[1].end());
  const Frame floor{{0.0, 0.0, kFloor}, Vec3::UnitX(), -Vec3::UnitY(), -Vec3::UnitZ()};
  faces.push_back(planar_face(plan, floor, {floor_loops[0], floor_loops[1]}));
  faces.push_back(std::move(top));
  plan.shells.push_back(std::move(faces));
  const auto under = [&](double s) { return 4.0 * s * s * (1.0 - kFloor) - 8.0 * s * s * s * s / 3.0; };
  return {enter(scene, plan, options), under(1.0) - under(half), std::nullopt};
}

}  // namespace lamella::test
