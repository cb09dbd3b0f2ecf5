#include "model/winding_tree.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "model/rational_form.h"
#include "tests/model/random_geometry.h"

namespace lamella {
namespace {

using test::RandomGeometry;

struct Loops {
  std::vector<BezierCurve2> pieces;
  std::vector<std::size_t> begin;

  void add(const std::vector<BezierCurve2>& loop) {
    begin.push_back(pieces.size());
    pieces.insert(pieces.end(), loop.begin(), loop.end());
  }
  [[nodiscard]] WindingTree tree() const { return {pieces, begin}; }
};

/// A closed chain of rational pieces with random control points, as tangled as may be.
std::vector<BezierCurve2> random_loop(RandomGeometry& random, int count, int max_degree) {
  std::vector<Vec2> corners;
  for (int i = 0; i < count; ++i) corners.push_back(random.point<2>(1.0));
  std::vector<BezierCurve2> loop;
  for (int i = 0; i < count; ++i) {
    BezierCurve2 piece{{0.0, 1.0}, {}};
    const int degree = random.integer(1, max_degree);
    for (int k = 0; k <= degree; ++k) {
      const Vec2 p = k == 0 ? corners[i] : k == degree ? corners[(i + 1) % count] : random.point<2>(1.0);
      const double w = k == 0 || k == degree ? 1.0 : random.real(0.2, 4.0);
      piece.net.emplace_back(w * p[0], w * p[1], w);
    }
    loop.push_back(piece);
  }
  return loop;
}

std::vector<BezierCurve2> circle(const Vec2& centre, double radius, bool clockwise = false) {
  const Ellipse<2> ellipse{centre, Vec2(radius, 0.0), Vec2(0.0, radius)};
  return rational_pieces(ellipse, clockwise ? Interval{kTwoPi, 0.0} : Interval{0.0, kTwoPi});
}

std::vector<BezierCurve2> polygon(const std::vector<Vec2>& corners) {
  std::vector<BezierCurve2> loop;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2& a = corners[i];
    const Vec2& b = corners[(i + 1) % corners.size()];
    loop.push_back({{0.0, 1.0}, {Vec3(a[0], a[1], 1.0), Vec3(b[0], b[1], 1.0)}});
  }
  return loop;
}

/// Winding number by the angles under which a dense polygon is seen, and how close the polygon comes.
struct Seen {
  int winding;
  double distance;
};

Seen see(const Loops& loops, const Vec2& point, int samples) {
  double angle = 0.0;
  double nearest = 1e300;
  for (const BezierCurve2& piece : loops.pieces) {
    Vec2 before = evaluate_point(piece, piece.t.lo) - point;
    for (int i = 1; i <= samples; ++i) {
      const Vec2 at = evaluate_point(piece, piece.t.lo + piece.t.length() * i / samples) - point;
      angle += std::atan2(before[0] * at[1] - before[1] * at[0], before.dot(at));
      nearest = std::min(nearest, at.norm());
      before = at;
    }
  }
  return {static_cast<int>(std::lround(angle / kTwoPi)), nearest};
}

TEST(WindingTree, EqualsTheAnglesSeenOnRandomTangledLoops) {
  RandomGeometry random(51);
  int compared = 0;
  int wound = 0;
  for (int round = 0; round < 40; ++round) {
    Loops loops;
    for (int k = random.integer(1, 3); k > 0; --k) loops.add(random_loop(random, random.integer(1, 8), 7));
    const WindingTree tree = loops.tree();
    for (int i = 0; i < 50; ++i) {
      const Vec2 point = random.point<2>(0.9);
      const Seen seen = see(loops, point, 150);
      if (seen.distance < 0.04) continue;
      const auto winding = tree.winding(point, Vec2::Zero());
      ASSERT_TRUE(winding.has_value());
      EXPECT_EQ(*winding, seen.winding);
      ++compared;
      wound += seen.winding != 0;
    }
  }
  EXPECT_GT(compared, 1000);
  EXPECT_GT(wound, 150);
}

TEST(WindingTree, TellsBothSidesOfACircleToAFewUlps) {
  RandomGeometry random(52);
  Loops loops;
  loops.add(circle(Vec2::Zero(), 1.0));
  const WindingTree tree = loops.tree();
  for (int i = 0; i < 5000; ++i) {
    const double angle = random.real(0.0, kTwoPi);
    const double offset = std::pow(10.0, random.real(-14.0, -1.0));
    const Vec2 direction(std::cos(angle), std::sin(angle));
    EXPECT_EQ(tree.winding((1.0 + offset) * direction, Vec2::Zero()), 0) << offset << " at " << angle;
    EXPECT_EQ(tree.winding((1.0 - offset) * direction, Vec2::Zero()), 1) << offset << " at " << angle;
  }
}

TEST(WindingTree, MeetsTheBoundaryExactlyWithinTheToleranceBox) {
  RandomGeometry random(53);
  Loops loops;
  loops.add(circle(Vec2::Zero(), 1.0));
  const WindingTree tree = loops.tree();
  int met = 0;
  int close = 0;
  for (int i = 0; i < 15000; ++i) {
    const double scale = std::pow(10.0, random.real(-12.0, -0.5));
    const Vec2 tolerance(scale * random.real(0.0, 1.0), scale * random.real(0.0, 1.0));
    const double angle = random.real(0.0, kTwoPi);
    const Vec2 point = (1.0 + 2.0 * scale * random.real(-1.0, 1.0)) * Vec2(std::cos(angle), std::sin(angle));
    const Vec2 away = point.cwiseAbs();
    const Vec2 least = (away - tolerance).cwiseMax(0.0);
    const Vec2 most = away + tolerance;
    if (std::min(std::abs(least.norm() - 1.0), std::abs(most.norm() - 1.0)) < 1e-14) continue;
    const bool expected = least.norm() <= 1.0 && most.norm() >= 1.0;
    EXPECT_EQ(!tree.winding(point, tolerance).has_value(), expected) << point.transpose() << " +- " << scale;
    met += expected;
    close += !expected;
  }
  EXPECT_GT(met, 3000);
  EXPECT_GT(close, 3000);
}

TEST(WindingTree, FindsPointsOnStraightPiecesWithoutTolerance) {
  Loops loops;
  loops.add(polygon({Vec2(0, 0), Vec2(4, 0), Vec2(4, 2), Vec2(0, 2)}));
  const WindingTree tree = loops.tree();
  for (const Vec2& point : {Vec2(0, 0), Vec2(4, 2), Vec2(1, 0), Vec2(4, 1), Vec2(3, 2), Vec2(0, 1.5)}) {
    EXPECT_FALSE(tree.winding(point, Vec2::Zero()).has_value()) << point.transpose();
  }
  EXPECT_EQ(tree.winding(Vec2(1, 1), Vec2::Zero()), 1);
  EXPECT_EQ(tree.winding(Vec2(-1, 0), Vec2::Zero()), 0);
  EXPECT_EQ(tree.winding(Vec2(-1, 2), Vec2::Zero()), 0);
  EXPECT_EQ(tree.winding(Vec2(5, 0), Vec2::Zero()), 0);
}

TEST(WindingTree, CountsRightWhereTheLevelRunsThroughVertices) {
  // A star: rays at the level of its corners pass through corners, and its spikes touch levels from both sides.
  std::vector<Vec2> corners;
  for (int i = 0; i < 16; ++i) {
    const double radius = i % 2 == 0 ? 4.0 : 2.0;
    corners.emplace_back(std::round(radius * 8 * std::cos(i * kPi / 8)),
                         std::round(radius * 8 * std::sin(i * kPi / 8)));
  }
  Loops loops;
  loops.add(polygon(corners));
  const WindingTree tree = loops.tree();
  for (int y = -33; y <= 33; ++y) {
    for (double x = -33.5; x < 34.0; x += 1.0) {
      const Seen seen = see(loops, Vec2(x, y), 20);
      const auto winding = tree.winding(Vec2(x, y), Vec2::Zero());
      if (winding) {
        EXPECT_EQ(*winding, seen.winding) << x << "," << y;
      } else {
        EXPECT_LT(seen.distance, 1.0);
      }
    }
  }
}

TEST(WindingTree, HandlesCuspsFoldsAndPiecesOfNoLength) {
  Loops loops;
  auto loop = polygon({Vec2(0, 0), Vec2(4, 0), Vec2(4, 4), Vec2(0, 4)});
  // Runs past its end and back; a piece that stays at a point; a loop of a single cubic with a cusp.
  loop.insert(loop.begin() + 1, {{0, 1}, {Vec3(4, 0, 1), Vec3(4, 0, 1)}});
  loop[2] = {{0, 1}, {Vec3(4, 0, 1), Vec3(4, 9, 1), Vec3(4, 4, 1)}};
  loops.add(loop);
  loops.add({{{0, 1}, {Vec3(1, 1, 1), Vec3(3, 3, 1), Vec3(1, 3, 1), Vec3(1, 1, 1)}}});
  const WindingTree tree = loops.tree();
  EXPECT_EQ(tree.winding(Vec2(3.5, 2), Vec2::Zero()), 1);
  EXPECT_EQ(tree.winding(Vec2(1.5, 2), Vec2::Zero()), 2);
  EXPECT_EQ(tree.winding(Vec2(5, 2), Vec2::Zero()), 0);
  EXPECT_FALSE(tree.winding(Vec2(4, 0), Vec2::Zero()).has_value());
}

TEST(WindingTree, TerminatesOnExtremeWeightsAndTinyLoops) {
  Loops loops;
  loops.add({{{0, 1}, {Vec3(0, 0, 1), Vec3(1e9, 1e9, 1e9), Vec3(2, 0, 1)}}, polygon({Vec2(2, 0), Vec2(0, 0)})[0]});
  loops.add(circle(Vec2(0.5, 0.2), 1e-15, true));
  const WindingTree tree = loops.tree();
  RandomGeometry random(54);
  for (int i = 0; i < 2000; ++i) {
    const Vec2 point(random.real(-0.1, 2.1), random.real(-0.1, 1.1));
    const double height = std::min(point[0], 2.0 - point[0]);
    const double inside = std::min(point[1], height - point[1]);
    if (std::abs(inside) < 1e-3) continue;
    EXPECT_EQ(tree.winding(point, Vec2::Zero()), inside > 0.0 ? -1 : 0) << point.transpose();
  }
  (void)tree.winding(Vec2(0.5, 0.2), Vec2::Zero());
}

TEST(WindingTree, HandlesThousandsOfHoles) {
  Loops loops;
  loops.add(polygon({Vec2(0, 0), Vec2(60, 0), Vec2(60, 60), Vec2(0, 60)}));
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j < 60; ++j) loops.add(circle(Vec2(i + 0.5, j + 0.5), 0.3, true));
  }
  const WindingTree tree = loops.tree();
  RandomGeometry random(55);
  for (int i = 0; i < 20000; ++i) {
    const Vec2 point(random.real(0.0, 60.0), random.real(0.0, 60.0));
    const Vec2 local(point[0] - std::floor(point[0]) - 0.5, point[1] - std::floor(point[1]) - 0.5);
    if (std::abs(local.norm() - 0.3) < 1e-9) continue;
    EXPECT_EQ(tree.winding(point, Vec2::Zero()), local.norm() < 0.3 ? 0 : 1);
  }
}

TEST(WindingTree, IsEmptyWithoutLoops) { EXPECT_EQ(WindingTree().winding(Vec2(0, 0), Vec2::Ones()), 0); }

TEST(WindingTree, SurvivesNotANumber) {
  Loops loops;
  loops.add(circle(Vec2::Zero(), 1.0));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(loops.tree().winding(Vec2(nan, 0.0), Vec2::Zero()), 0);
}

}  // namespace
}  // namespace lamella
