#include "slicing/span/conic_section.h"

#include <Eigen/Dense>
#include <cmath>
#include <gtest/gtest.h>
#include <optional>
#include <random>

#include "core/geometry.h"

namespace lamella::span {
namespace {

/// An upright frame leaning by `lean` radians, turned about z by `turn`.
Frame leaning(double lean, double turn) {
  Frame frame;
  frame.origin = Vec3(3.0, -7.0, 2.0);
  frame.z = Vec3(std::sin(lean) * std::cos(turn), std::sin(lean) * std::sin(turn), std::cos(lean));
  frame.x = frame.z.unitOrthogonal();
  frame.y = frame.z.cross(frame.x);
  return frame;
}

/// Where the ruling at angle u meets height z, by the surfaces' own equations.
Vec3 point_on(const Cone& cone, double u, double z) {
  const Vec3 around = std::cos(u) * cone.frame.x + std::sin(u) * cone.frame.y;
  const Vec3 base = cone.frame.origin + cone.radius * around;
  const Vec3 ruling = std::sin(cone.half_angle) * around + std::cos(cone.half_angle) * cone.frame.z;
  return base + (z - base.z()) / ruling.z() * ruling;
}
Vec3 point_on(const Cylinder& cylinder, double u, double z) {
  const Vec3 base =
      cylinder.frame.origin + cylinder.radius * (std::cos(u) * cylinder.frame.x + std::sin(u) * cylinder.frame.y);
  return base + (z - base.z()) / cylinder.frame.z.z() * cylinder.frame.z;
}

double residual(const Cone& cone, const Vec3& p) {
  const Vec3 d = p - cone.frame.origin;
  const double along = d.dot(cone.frame.z);
  return (d - along * cone.frame.z).norm() - std::abs(cone.radius + along * std::tan(cone.half_angle));
}
double residual(const Cylinder& cylinder, const Vec3& p) {
  const Vec3 d = p - cylinder.frame.origin;
  return (d - d.dot(cylinder.frame.z) * cylinder.frame.z).norm() - cylinder.radius;
}

/// The quintic through six points of the section between two angles.
template <typename Round>
ArcPiece piece_of(const Round& surface, double u, double step, double z) {
  Eigen::Matrix<double, 6, 6> powers;
  Eigen::Matrix<double, 6, 2> points;
  for (int i = 0; i < 6; ++i) {
    const double t = i / 5.0;
    points.row(i) = point_on(surface, u + t * step, z).template head<2>();
    for (int k = 0; k < 6; ++k) powers(i, k) = std::pow(t, k);
  }
  const Eigen::Matrix<double, 6, 2> c = powers.fullPivLu().solve(points);
  ArcPiece piece;
  for (int k = 0; k < 6; ++k) {
    piece.x[static_cast<std::size_t>(k)] = c(k, 0);
    piece.y[static_cast<std::size_t>(k)] = c(k, 1);
  }
  return piece;
}

/// All of the arc lies on the surface, next to the piece.
template <typename Round>
void expect_exact(const Round& surface, const ArcPiece& piece, const ConicArc& arc, double z) {
  EXPECT_LT((arc.begin - piece.at(0.0)).norm(), 1e-8);
  EXPECT_LT((arc.end - piece.at(1.0)).norm(), 1e-8);
  for (double t = 0.0; t <= 1.0; t += 0.0625) {
    const double first = (1.0 - t) * (1.0 - t);
    const double middle = 2.0 * arc.weight * t * (1.0 - t);
    const Vec2 at = (first * arc.begin + middle * arc.pole + t * t * arc.end) / (first + middle + t * t);
    ASSERT_LT(std::abs(residual(surface, Vec3(at.x(), at.y(), z))), 1e-10);
    double nearest = 1.0;
    for (double s = 0.0; s <= 1.0; s += 1.0 / 256) nearest = std::min(nearest, (piece.at(s) - at).norm());
    ASSERT_LT(nearest, 0.01 * (arc.end - arc.begin).norm());
  }
}

TEST(ConicArc, OfLeaningConesIsTheirExactSection) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  int ellipses = 0;
  int hyperbolas = 0;
  for (int n = 0; n < 400; ++n) {
    const double lean = 0.05 + 1.5 * share(random);
    const double half_angle = (share(random) < 0.5 ? -1.0 : 1.0) * (0.1 + 1.2 * share(random));
    const Cone cone{leaning(lean, 6.0 * share(random)), 4.0, half_angle};
    const double u = kTwoPi * share(random);
    const double z = 2.0 + share(random);
    const ArcPiece piece = piece_of(cone, u, 0.02, z);
    const double size = (piece.at(1.0) - piece.at(0.0)).norm();
    if (!(size < 0.5 && size > 0.01)) continue;  // a ruling that is nearly level, or the apex
    const std::optional<ConicArc> arc = conic_arc(cone, z, piece);
    ASSERT_TRUE(arc) << n;
    expect_exact(cone, piece, *arc, z);
    // Steeper than the flattest ruling cuts both ways.
    const bool is_ellipse = lean + std::abs(half_angle) < kPi / 2;
    EXPECT_EQ(arc->weight < 1.0, is_ellipse) << n;
    ++(is_ellipse ? ellipses : hyperbolas);
  }
  EXPECT_GT(ellipses, 50);
  EXPECT_GT(hyperbolas, 50);
}

TEST(ConicArc, OfACylinderThatIsNearlyLevelIsItsExactSection) {
  const Cylinder cylinder{leaning(kPi / 2 - 1e-3, 0.4), 5.0};
  for (const double u : {0.3, 1.0, 2.0, 4.0}) {
    const ArcPiece piece = piece_of(cylinder, u, 1e-4, 4.0);
    const std::optional<ConicArc> arc = conic_arc(cylinder, 4.0, piece);
    if (!arc) continue;
    expect_exact(cylinder, piece, *arc, 4.0);
    EXPECT_LT(arc->weight, 1.0);
  }
  EXPECT_TRUE(conic_arc(cylinder, 4.0, piece_of(cylinder, 1.0, 0.1, 4.0)));
}

TEST(ConicArc, IsNoneWhereThePieceIsNotOnTheSection) {
  const Cone cone{leaning(0.5, 0.0), 4.0, 0.3};
  ArcPiece piece = piece_of(cone, 1.0, 0.2, 2.0);
  ASSERT_TRUE(conic_arc(cone, 2.0, piece));
  EXPECT_FALSE(conic_arc(cone, 2.1, piece));
  piece.x[0] += 1e-5;
  EXPECT_FALSE(conic_arc(cone, 2.0, piece));
  piece.x[0] = std::nan("");
  EXPECT_FALSE(conic_arc(cone, 2.0, piece));
  EXPECT_FALSE(conic_arc(Sphere{leaning(0.0, 0.0), 4.0}, 2.0, piece));
}

/// A straight piece, a ruling that lies in the layer, is no conic.
TEST(ConicArc, IsNoneOfRulings) {
  const Cone cone{leaning(kPi / 2 - 0.3, 0.0), 4.0, 0.3};
  ArcPiece line;
  line.x = {1.0, 1.0};
  line.y = {2.0, 0.5};
  EXPECT_FALSE(conic_arc(cone, 2.0, line));
}

}  // namespace
}  // namespace lamella::span
