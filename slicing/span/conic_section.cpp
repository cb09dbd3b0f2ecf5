#include "slicing/span/conic_section.h"

#include <Eigen/Core>
#include <array>
#include <cmath>

namespace lamella::span {

namespace {

constexpr double kNear = 1e-6;       // mm
constexpr double kLeastTurn = 1e-7;  // sine of the angle between the tangents of both ends
constexpr int kNewtonSteps = 4;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// The points q of a plane, counted from an origin, with q.Hq + 2 g.q + c = 0.
class PlaneConic {
 public:
  PlaneConic(const Cone& cone, const Vec3& origin) {
    // (a.d)^2 = cos^2 |d|^2, d counted from the apex.
    const double cos = std::cos(cone.half_angle);
    const Vec3 d = origin - cone.frame.origin + (cone.radius / std::tan(cone.half_angle)) * cone.frame.z;
    set(cone.frame.z, 1.0, -cos * cos, d);
  }
  PlaneConic(const Cylinder& cylinder, const Vec3& origin) {
    // |d|^2 - (a.d)^2 = r^2, d counted from a point of the axis.
    set(cylinder.frame.z, -1.0, 1.0, origin - cylinder.frame.origin);
    c_ -= cylinder.radius * cylinder.radius;
  }

  [[nodiscard]] double value(const Vec2& q) const { return q.dot(h_ * q) + 2.0 * g_.dot(q) + c_; }
  [[nodiscard]] Vec2 gradient(const Vec2& q) const { return 2.0 * (h_ * q + g_); }
  /// d.Hd
  [[nodiscard]] double form(const Vec2& d) const { return d.dot(h_ * d); }

  /// The point of the conic next to q, which is near.
  [[nodiscard]] Vec2 project(Vec2 q) const {
    for (int i = 0; i < kNewtonSteps; ++i) {
      const Vec2 gradient = this->gradient(q);
      q -= value(q) / gradient.squaredNorm() * gradient;
    }
    return q;
  }

 private:
  /// along (a.d)^2 + all |d|^2, d moved by q.
  void set(const Vec3& axis, double along, double all, const Vec3& d) {
    const Vec2 flat = axis.head<2>();
    const double height = axis.dot(d);
    h_ = along * flat * flat.transpose() + all * Eigen::Matrix2d::Identity();
    g_ = along * height * flat + all * d.head<2>();
    c_ = along * height * height + all * d.squaredNorm();
  }

  Eigen::Matrix2d h_;
  Vec2 g_;
  double c_ = 0.0;
};

/// Ends and tangents of the arc from `begin` to `end`, which lie on the conic; `middle` is next to a point between.
std::optional<ConicArc> join(const PlaneConic& conic, const Vec2& begin, const Vec2& end, const Vec2& middle) {
  const std::array normals{conic.gradient(begin).normalized(), conic.gradient(end).normalized()};
  const double turn = cross(normals[0], normals[1]);
  if (!(std::abs(turn) > kLeastTurn)) return std::nullopt;
  const Vec2 chord = end - begin;
  const Vec2 tangent(-normals[0].y(), normals[0].x());
  ConicArc arc{begin, begin + chord.dot(normals[1]) / tangent.dot(normals[1]) * tangent, end, 1.0};
  // The pole's polar is the chord, so that on the line from the chord's middle M to it the conic's equation has no
  // mixed term: with F(M) = -chord.H chord / 4 and the pole's F the shoulder divides the line in the ratio of roots.
  const double square = 0.25 * conic.form(chord) / conic.value(arc.pole);
  arc.weight = std::sqrt(square);
  const Vec2 half = 0.5 * (begin + end);
  const bool same_side = (middle - half).dot(arc.pole - half) > 0.0;
  if (!(square > 0.0) || !std::isfinite(arc.weight) || !same_side) return std::nullopt;
  return arc;
}

}  // namespace

std::optional<ConicArc> conic_arc(const Surface& surface, double z, const ArcPiece& piece) {
  const Vec2 origin = piece.at(0.0);
  const Vec3 place(origin.x(), origin.y(), z);
  std::optional<PlaneConic> conic;
  if (const auto* cone = std::get_if<Cone>(&surface)) conic.emplace(*cone, place);
  if (const auto* cylinder = std::get_if<Cylinder>(&surface)) conic.emplace(*cylinder, place);
  if (!conic) return std::nullopt;
  std::array<Vec2, 3> points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2 traced = piece.at(0.5 * static_cast<double>(i)) - origin;
    points[i] = conic->project(traced);
    if (!((points[i] - traced).norm() <= kNear)) return std::nullopt;  // NaN too
  }
  std::optional<ConicArc> arc = join(*conic, points[0], points[2], points[1]);
  if (!arc) return std::nullopt;
  for (Vec2* point : {&arc->begin, &arc->pole, &arc->end}) *point += origin;
  return arc;
}

}  // namespace lamella::span
