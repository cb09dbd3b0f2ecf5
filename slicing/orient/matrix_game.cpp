#include "slicing/orient/matrix_game.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace lamella {

namespace {

/// Weights of corners below it are pivoted away; far above the rounding of a 4 x 4 solve.
constexpr double kNegative = -1e-11;

}  // namespace

// The dual in its rows: sum of share * value(row) over pieces - slack(row) - v = 0 for each corner, the shares of the
// pieces add up to 1, v as large as can be. v is always in the basis, beside three columns.

MatrixGame::MatrixGame(const Vec3& values) {
  int lowest = 0;
  values.minCoeff(&lowest);
  basis_[0] = {values, false};
  for (int row = 0, next = 1; row < 3; ++row) {
    if (row != lowest) basis_[next++] = {-Vec3::Unit(row), true};
  }
  update();
  settle();
}

Eigen::Matrix4d MatrixGame::basis_matrix() const {
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 3; ++i) matrix.col(i) = as_vector(basis_[i]);
  matrix.col(3) << -1.0, -1.0, -1.0, 0.0;
  return matrix;
}

Vec4 MatrixGame::as_vector(const Column& column) {
  Vec4 vector;
  vector << column.values, column.is_slack ? 0.0 : 1.0;
  return vector;
}

void MatrixGame::update() {
  const Eigen::PartialPivLU<Eigen::Matrix4d> lu(basis_matrix());
  const Vec4 solution = lu.solve(Vec4(Vec4::UnitW()));
  shares_ = solution.head<3>();
  // Prices y of the rows: y . column = 0 for the columns in, 1 for v.
  const Vec4 prices = lu.transpose().solve(Vec4(Vec4::UnitW()));
  place_ = -prices.head<3>();
  value_ = prices[3];
  // Whatever rounding did: a mix of pieces with shares of 0 or more bounds f by its least corner.
  Vec3 mix = Vec3::Zero();
  double total = 0.0;
  for (int i = 0; i < 3; ++i) {
    if (basis_[i].is_slack) continue;
    const double share = std::max(shares_[i], 0.0);
    mix += share * basis_[i].values;
    total += share;
  }
  bound_ = (mix / total).minCoeff();
}

bool MatrixGame::enter(const Column& column) {
  const Eigen::PartialPivLU<Eigen::Matrix4d> lu(basis_matrix());
  const Vec4 change = lu.solve(as_vector(column));
  int leaving = -1;
  double least = 0.0;
  for (int i = 0; i < 3; ++i) {
    if (!(change[i] > 1e-13 * change.cwiseAbs().maxCoeff())) continue;
    const double ratio = std::max(shares_[i], 0.0) / change[i];
    if (leaving < 0 || ratio < least) {
      leaving = i;
      least = ratio;
    }
  }
  if (leaving < 0) return false;
  const MatrixGame before = *this;
  basis_[leaving] = column;
  update();
  const bool is_sound = place_.allFinite() && std::isfinite(value_) && std::isfinite(bound_);
  if (!is_sound) *this = before;
  return is_sound;
}

bool MatrixGame::settle() {
  // Three rows: a few pivots; the limit is against cycles of rounding.
  for (int pivots = 0; pivots < 12; ++pivots) {
    int row = 0;
    if (!(place_.minCoeff(&row) < kNegative)) break;
    if (!enter({-Vec3::Unit(row), true})) return false;
  }
  place_ = place_.cwiseMax(0.0);
  place_ /= place_.sum();
  return true;
}

bool MatrixGame::add(const Vec3& values) {
  const MatrixGame before = *this;
  if (enter({values, false}) && settle()) return true;
  *this = before;
  return false;
}

}  // namespace lamella
