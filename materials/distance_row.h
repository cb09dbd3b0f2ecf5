#pragma once

#include <vector>

#include "materials/field.h"
#include "materials/part_distance.h"

namespace lamella {

/// What DistanceRow must reach.
struct DistanceLimits {
  double farthest = 0.0;   ///< mm: distances beyond it need not be told apart; may be infinite
  double tolerance = 0.0;  ///< mm
};

/// The distance along a piece of a row as cubics between few exact values (docs/methods/graded-materials.md): the
/// nearest point gives the slope along with the distance, so that where the surface is smooth long intervals will do.
class DistanceRow {
 public:
  /// `distance` must outlive it.
  DistanceRow(const PartDistance& distance, const DistanceLimits& limits);

  /// Lays the cubics along a piece of a row. The result depends on the piece alone.
  void build(const RowPiece& piece);

  /// mm, at most `farthest`; `x` in the range of the piece.
  [[nodiscard]] double at(double x) const;

  /// Exact distances that were asked for so far.
  [[nodiscard]] std::size_t queries() const { return queries_; }

 private:
  struct Node {
    double x = 0.0;
    double distance = 0.0;     ///< infinite if it is farther than was asked for
    double slope = 0.0;        ///< by x
    Vec3 foot = Vec3::Zero();  ///< the nearest point, where one was found
    bool is_deep = false;      ///< from here to the next node it is farther than `farthest`, for certain
  };

  [[nodiscard]] Node node_at(double x, double most);
  [[nodiscard]] double farthest_from(const Node& node, double x) const;
  [[nodiscard]] Node end_node(double x, double toward);
  void refine(const Node& from, const Node& to, bool may_guess);
  [[nodiscard]] static double split(const Node& from, const Node& to);
  [[nodiscard]] static double cubic(const Node& from, const Node& to, double x);

  const PartDistance& distance_;
  DistanceLimits limits_;
  double step_;  ///< mm: cubics aren't longer
  RowPiece piece_;
  std::vector<Node> nodes_;
  std::size_t queries_ = 0;
};

}  // namespace lamella
