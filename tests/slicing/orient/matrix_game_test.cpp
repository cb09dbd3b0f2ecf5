#include "slicing/orient/matrix_game.h"

#include <gtest/gtest.h>
#include <random>
#include <vector>

namespace lamella {
namespace {

double value_at(const std::vector<Vec3>& pieces, const Vec3& weights) {
  double value = -1e300;
  for (const Vec3& piece : pieces) value = std::max(value, piece.dot(weights));
  return value;
}

TEST(MatrixGame, FindsTheLeastValueOfConvexPiecesOverATriangle) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<Vec3> pieces(1 + trial % 9);
    for (Vec3& piece : pieces) piece = Vec3(5.0 + unit(random), 5.0 + unit(random), 5.0 + unit(random));
    MatrixGame game(pieces.front());
    for (int round = 0; round < 50; ++round) {
      const auto worst = std::max_element(pieces.begin(), pieces.end(), [&](const Vec3& a, const Vec3& b) {
        return a.dot(game.place()) < b.dot(game.place());
      });
      EXPECT_LE(game.bound(), value_at(pieces, game.place()) + 1e-12);
      if (worst->dot(game.place()) <= game.value() + 1e-13) break;
      ASSERT_TRUE(game.add(*worst)) << trial;
    }
    // A place whose value is the bound, and a bound that no place is below: the least.
    EXPECT_GE(game.place().minCoeff(), 0.0);
    EXPECT_NEAR(game.place().sum(), 1.0, 1e-12);
    EXPECT_NEAR(value_at(pieces, game.place()), game.bound(), 1e-12) << trial;
    for (int i = 0; i < 1000; ++i) {
      const Vec3 weights = Vec3(unit(random), unit(random), unit(random)).cwiseAbs();
      EXPECT_GE(value_at(pieces, weights / weights.sum()), game.bound() - 1e-12) << trial;
    }
  }
}

TEST(MatrixGame, OnePieceIsLeastAtItsLowestCorner) {
  const MatrixGame game(Vec3(3.0, 1.0, 2.0));
  EXPECT_DOUBLE_EQ(game.bound(), 1.0);
  EXPECT_EQ(game.place(), Vec3::UnitY());
}

}  // namespace
}  // namespace lamella
