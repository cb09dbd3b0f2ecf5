#include "model/project.h"

#include <gtest/gtest.h>
#include <vector>

#include "model/evaluate.h"
#include "tests/model/random_geometry.h"

namespace lamella {
namespace {

Frame turned() {
  Frame frame;
  frame.origin = Vec3(3, -2, 7);
  const Mat3 axes = Eigen::AngleAxisd(0.8, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  frame.x = axes.col(0);
  frame.y = axes.col(1);
  frame.z = axes.col(2);
  return frame;
}

TEST(Project, FindsTheParametersOfPointsOnElementarySurfaces) {
  const Box2 box(Vec2(0.3, -1.2), Vec2(0.3 + kTwoPi, 1.2));
  test::RandomGeometry random(5);
  const std::vector<Surface> surfaces{Plane{turned()}, Cylinder{turned(), 2.0}, Cone{turned(), 3.0, 0.4},
                                      Sphere{turned(), 5.0}, Torus{turned(), 6.0, 2.0}};
  for (const Surface& surface : surfaces) {
    for (int trial = 0; trial < 200; ++trial) {
      const Vec2 uv(random.real(box.min().x(), box.max().x()), random.real(box.min().y(), box.max().y()));
      const Vec2 found = project(surface, box, evaluate_point(surface, uv), 1e-9);
      EXPECT_NEAR(found.x(), uv.x(), 1e-9);
      EXPECT_NEAR(found.y(), uv.y(), 1e-9);
    }
  }
}

TEST(Project, FindsAPointOfASplineThatFoldsOverItself) {
  test::RandomGeometry random(9);
  for (int trial = 0; trial < 40; ++trial) {
    const BSplineSurface spline = random.surface(random.integer(1, 4), random.integer(1, 4), 5, trial % 2 == 0);
    const Box2 box(Vec2(spline.domain_u().lo, spline.domain_v().lo), Vec2(spline.domain_u().hi, spline.domain_v().hi));
    for (int k = 0; k < 5; ++k) {
      const Vec2 uv(random.real(box.min().x(), box.max().x()), random.real(box.min().y(), box.max().y()));
      const Vec3 point = evaluate_point(Surface{spline}, uv);
      const Vec2 found = project(Surface{spline}, box, point, 1e-9);
      EXPECT_LT((evaluate_point(Surface{spline}, found) - point).norm(), 1e-9);
    }
  }
}

TEST(Project, StaysInTheBoxAndFindsPoles) {
  const Box2 box(Vec2(0, -kPi / 2), Vec2(kTwoPi, kPi / 2));
  const Surface sphere = Sphere{Frame{}, 2.0};
  const Vec2 pole = project(sphere, box, Vec3(0, 0, 2), 1e-9);
  EXPECT_NEAR(pole.y(), kPi / 2, 1e-7);
  const Box2 corner(Vec2(0, 0), Vec2(0.5, 0.5));
  const Vec2 nearest = project(sphere, corner, Vec3(-1, 0.1, 0.3), 1e-9);
  EXPECT_TRUE(corner.contains(nearest));
}

}  // namespace
}  // namespace lamella
