#pragma once

#include <array>

#include "core/geometry.h"

namespace lamella {

/// Minimises a convex function f(x) = max_D D . x over a triangle, its pieces D supplied one by one: the simplex method
/// on the dual, a game of three rows (the corners) against the pieces that are in.
///
/// At any time the mix of pieces in the basis is a lower bound of f over the triangle: its least value at a corner.
class MatrixGame {
 public:
  /// The first piece, by its values at the three corners.
  explicit MatrixGame(const Vec3& values);

  /// Weights of the corners, 0 or more, sum 1: where f, as far as it is known, is least.
  [[nodiscard]] const Vec3& place() const { return place_; }
  /// The value there of the pieces that are in; a further piece matters only if it is larger at place().
  [[nodiscard]] double value() const { return value_; }
  /// Rigorous but for rounding: f is at least this over the whole triangle.
  [[nodiscard]] double bound() const { return bound_; }

  /// Lets a piece in. False when the pivot is lost in rounding; the state is as before then.
  bool add(const Vec3& values);

 private:
  struct Column {
    Vec3 values = Vec3::Zero();  ///< at the corners; of a slack: minus the unit vector of its row
    bool is_slack = false;
  };

  [[nodiscard]] Eigen::Matrix4d basis_matrix() const;
  [[nodiscard]] static Vec4 as_vector(const Column& column);
  bool enter(const Column& column);
  /// Pivots slacks in until all weights of corners are 0 or more.
  bool settle();
  void update();

  std::array<Column, 3> basis_;
  Vec3 shares_ = Vec3::Zero();  ///< of the columns in the basis
  Vec3 place_ = Vec3::Zero();
  double value_ = 0.0;
  double bound_ = 0.0;
};

}  // namespace lamella
