#include "slicing/span/flatten.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace lamella::span {
namespace {

double distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 way = b - a;
  const double square = way.squaredNorm();
  const double t = square > 0.0 ? std::min(1.0, std::max(0.0, way.dot(p - a) / square)) : 0.0;
  return (a + t * way - p).norm();
}

/// Largest distance of densely sampled points of the piece from the chord of their stretch; equal steps of t.
double deviation(const ArcPiece& piece, const std::vector<Vec2>& inner) {
  std::vector<Vec2> points{piece.at(0.0)};
  points.insert(points.end(), inner.begin(), inner.end());
  points.push_back(piece.at(1.0));
  double worst = 0.0;
  const auto chords = static_cast<int>(points.size()) - 1;
  for (int i = 0; i < chords; ++i) {
    for (int k = 0; k <= 50; ++k) {
      const Vec2 at = piece.at((i + k / 50.0) / chords);
      worst = std::max(worst, distance_to_segment(at, points[i], points[i + 1]));
    }
  }
  return worst;
}

ArcPiece random_piece(std::mt19937& random) {
  std::uniform_real_distribution<double> coefficient(-3.0, 3.0);
  ArcPiece piece;
  for (int k = 0; k < 6; ++k) {
    piece.x[k] = coefficient(random);
    piece.y[k] = coefficient(random);
  }
  return piece;
}

TEST(Flatten, RandomQuinticsKeepToTheChordError) {
  std::mt19937 random(3);
  for (int i = 0; i < 500; ++i) {
    const ArcPiece piece = random_piece(random);
    for (const double chord_error : {1.0, 0.1, 1e-2, 1e-4}) {
      std::vector<Vec2> points;
      flatten(piece, chord_error, points);
      EXPECT_LE(deviation(piece, points), chord_error * (1.0 + 1e-12)) << i;
    }
  }
}

TEST(Flatten, TakesNoMoreChordsThanAParabolaNeeds) {
  ArcPiece parabola;
  parabola.x = {0.0, 8.0};
  parabola.y = {0.0, 4.0, -4.0};  // height 1 at the middle
  for (const int chords : {1, 3, 10, 100}) {
    std::vector<Vec2> points;
    flatten(parabola, 1.0000001 / (chords * chords), points);
    EXPECT_EQ(points.size(), static_cast<std::size_t>(chords - 1));
  }
}

TEST(Flatten, AStraightPieceAtUnevenSpeedIsOneChord) {
  ArcPiece piece;
  piece.x = {1.0, 1.0, 0.5, 0.25};
  piece.y = {2.0, 2.0, 1.0, 0.5};
  std::vector<Vec2> points;
  flatten(piece, 1e-9, points);
  EXPECT_TRUE(points.empty());
}

TEST(Flatten, SeesAStretchThatRunsBeyondItsChord) {
  ArcPiece piece;
  piece.x = {0.0, 4.0, -4.0};  // to 1 and back to 0
  std::vector<Vec2> points;
  flatten(piece, 0.01, points);
  ASSERT_FALSE(points.empty());
  EXPECT_LE(deviation(piece, points), 0.01);
}

TEST(Flatten, BoundsTheDistanceFromTheChord) {
  std::mt19937 random(5);
  for (int i = 0; i < 500; ++i) {
    const ArcPiece piece = random_piece(random);
    EXPECT_GE(chord_distance(piece, 0.0, 1.0) * (1.0 + 1e-12), deviation(piece, {}));
  }
}

}  // namespace
}  // namespace lamella::span
