/// Triangles that fill loops: they cover the area and nothing else, and close whatever is built on them.

#include "export/triangulate.h"

#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <random>

namespace lamella::test {
namespace {

using Loop = std::vector<Vec2>;

double cross(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

double area_of(const Loop& loop) {
  double sum = 0.0;
  for (std::size_t i = 1; i + 1 < loop.size(); ++i) sum += 0.5 * cross(loop[0], loop[i], loop[i + 1]);
  return sum;
}

/// A star with `tips` tips about a point; clockwise for a hole.
Loop star(const Vec2& centre, double inner, double outer, int tips, bool is_hole) {
  Loop loop;
  for (int i = 0; i < 2 * tips; ++i) {
    const double angle = (is_hole ? -1.0 : 1.0) * kPi * i / tips;
    loop.push_back(centre + (i % 2 == 0 ? outer : inner) * Vec2(std::cos(angle), std::sin(angle)));
  }
  return loop;
}

/// All triangles are counterclockwise, have together the loops' area, and use every side of a loop once and every other
/// side once in each direction.
void expect_filled(const std::vector<Loop>& loops) {
  std::vector<std::span<const Vec2>> spans(loops.begin(), loops.end());
  Loop points;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  double expected = 0.0;
  for (const Loop& loop : loops) {
    const auto first = static_cast<std::uint32_t>(points.size());
    const auto count = static_cast<std::uint32_t>(loop.size());
    for (std::uint32_t i = 0; i < count; ++i) --sides[{first + i, first + (i + 1) % count}];
    points.insert(points.end(), loop.begin(), loop.end());
    expected += area_of(loop);
  }
  double area = 0.0;
  for (const auto& [a, b, c] : triangulate(spans)) {
    const double twice = cross(points[a], points[b], points[c]);
    EXPECT_GE(twice, -1e-12);
    area += 0.5 * twice;
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) ++sides[{from, to}];
  }
  EXPECT_NEAR(area, expected, 1e-9 * std::abs(expected));
  for (const auto& [side, count] : sides) {
    const auto back = sides.find({side.second, side.first});
    EXPECT_EQ(count, back == sides.end() ? 0 : back->second) << side.first << " to " << side.second;
  }
}

TEST(Triangulate, FillsTrianglesSquaresAndStars) {
  expect_filled({{{0, 0}, {1, 0}, {0, 1}}});
  expect_filled({{{0, 0}, {1, 0}, {1, 1}, {0, 1}}});
  expect_filled({star({3, -2}, 1, 5, 7, false)});
}

TEST(Triangulate, LeavesHolesOpen) {
  expect_filled({star({0, 0}, 9, 10, 20, false), star({0, 0}, 1, 4, 9, true)});
  expect_filled({star({0, 0}, 9, 10, 20, false), star({-3, 0}, 1, 2, 5, true), star({3, 0}, 1, 2, 6, true),
                 star({0, 5}, 1, 2, 7, true), star({0, -5}, 1, 2, 8, true)});
}

TEST(Triangulate, FillsAGridOfHolesWhosePointsAreLevelWithEachOther) {
  std::vector<Loop> loops{{{0, 0}, {21, 0}, {21, 21}, {0, 21}}};
  for (int i = 0; i < 10; ++i) {
    for (int j = 0; j < 10; ++j) {
      const Vec2 p(1.0 + 2 * i, 1.0 + 2 * j);
      loops.push_back({p, p + Vec2(0, 1), p + Vec2(1, 1), p + Vec2(1, 0)});
    }
  }
  expect_filled(loops);
}

TEST(Triangulate, FillsWhereAHoleTouchesTheOuterLoopOrAnotherHole) {
  expect_filled({{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {{0, 2}, {1, 3}, {2, 2}, {1, 1}}});
  expect_filled({{{0, 0}, {8, 0}, {8, 4}, {0, 4}}, {{1, 2}, {2, 3}, {3, 2}, {2, 1}}, {{3, 2}, {4, 3}, {5, 2}, {4, 1}}});
}

TEST(Triangulate, FillsManyRandomStarsWithHoles) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(0.1, 0.9);
  std::uniform_int_distribution<int> tips(3, 40);
  for (int i = 0; i < 200; ++i) {
    std::vector<Loop> loops{star({0, 0}, 10 + 5 * share(random), 20, tips(random) + 40, false)};
    for (const Vec2& centre : {Vec2(-5, -5), Vec2(5, -4.5), Vec2(-4.5, 5), Vec2(5, 5), Vec2(0, 0)}) {
      if (share(random) < 0.3) continue;
      const double outer = 2.2 * share(random) + 0.1;
      loops.push_back(star(centre, outer * share(random), outer, tips(random), true));
    }
    expect_filled(loops);
  }
}

}  // namespace
}  // namespace lamella::test
