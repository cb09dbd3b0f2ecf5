#include "slicing/orient/footprint.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "slicing/orient/sphere.h"

namespace lamella {

namespace {

double cross(const Vec2& o, const Vec2& a, const Vec2& b) {
  return (a - o).x() * (b - o).y() - (a - o).y() * (b - o).x();
}

/// Corners of the convex hull, counterclockwise (Andrew 1979).
std::vector<Vec2> convex_hull(std::vector<Vec2> points) {
  std::sort(points.begin(), points.end(),
            [](const Vec2& a, const Vec2& b) { return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y()); });
  std::vector<Vec2> hull;
  const auto add = [&hull](const Vec2& point, std::size_t keep) {
    while (hull.size() > keep && cross(hull[hull.size() - 2], hull.back(), point) <= 0.0) hull.pop_back();
    hull.push_back(point);
  };
  for (const Vec2& point : points) add(point, 1);
  const std::size_t lower = hull.size();
  for (auto point = points.rbegin(); point != points.rend(); ++point) add(*point, lower);
  return hull;
}

Vec2 sides_at(const std::vector<Vec2>& hull, double angle) {
  const Vec2 x(std::cos(angle), std::sin(angle));
  const Vec2 y(-x.y(), x.x());
  Vec2 lo = Vec2::Constant(std::numeric_limits<double>::infinity());
  Vec2 hi = -lo;
  for (const Vec2& point : hull) {
    const Vec2 at(x.dot(point), y.dot(point));
    lo = lo.cwiseMin(at);
    hi = hi.cwiseMax(at);
  }
  return hi - lo;
}

Mat3 turned_about_z(const Mat3& turn, double angle) {
  // Axes of the machine seen from the plane's own: quarter turns to the last bit.
  const double quarter = std::round(angle / (0.5 * kPi));
  const bool is_quarter = std::abs(angle - quarter * 0.5 * kPi) < 1e-12;
  const double c = is_quarter ? std::round(std::cos(angle)) : std::cos(angle);
  const double s = is_quarter ? std::round(std::sin(angle)) : std::sin(angle);
  Mat3 about;
  about << c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0;
  return about * turn;
}

/// The angle of least cost; 0 unless another one gains more than 0.1 %.
double best_angle(const std::vector<double>& angles, const std::function<double(double)>& cost) {
  constexpr double kGain = 1e-3;
  double best = 0.0;
  double least = cost(0.0) * (1.0 - kGain);
  for (const double angle : angles) {
    const double own = cost(angle);
    if (!(own < least)) continue;
    least = own;
    best = angle;
  }
  return best;
}

}  // namespace

Lying lay_down(const SupportFunction& support, const std::vector<Vec3>& points, const Vec3& up,
               const std::optional<Vec2>& room) {
  const Mat3 upright = turn_upright(up);
  std::vector<Vec2> flat;
  flat.reserve(points.size());
  for (const Vec3& point : points) flat.emplace_back((upright * point).head<2>());
  const std::vector<Vec2> hull = convex_hull(std::move(flat));
  std::vector<double> angles{0.5 * kPi};
  // The hull of round bodies has many short sides, and steps of a degree do as well.
  constexpr std::size_t kMostSides = 200;
  for (std::size_t i = 0; i + 1 < hull.size() && hull.size() <= kMostSides; ++i) {
    const Vec2 side = hull[i + 1] - hull[i];
    const double angle = std::atan2(side.y(), side.x());
    angles.push_back(angle);
    angles.push_back(angle + 0.5 * kPi);
  }
  if (room || hull.size() > kMostSides) {
    for (int degree = 1; degree < 180; ++degree) angles.push_back(degree / 180.0 * kPi);
  }
  const double smallest = best_angle(angles, [&](double angle) { return sides_at(hull, angle).prod(); });
  double best = smallest;
  if (room) {
    const auto filling = [&](double angle) { return sides_at(hull, angle).cwiseQuotient(*room).maxCoeff(); };
    if (filling(smallest) > 1.0) best = smallest + 0.5 * kPi;
    if (filling(best) > 1.0) best = best_angle(angles, filling);
  }
  Lying lying;
  lying.turn = turned_about_z(upright, best);
  for (int axis = 0; axis < 3; ++axis) {
    lying.size[axis] = support.width(lying.turn.row(axis).transpose().normalized());
  }
  return lying;
}

}  // namespace lamella
