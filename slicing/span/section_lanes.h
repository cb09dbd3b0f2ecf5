#pragma once

#include <array>
#include <span>

#include "slicing/span/arc_piece.h"
#include "slicing/span/lane_kernel.h"

namespace lamella::span {

/// A point on its way to another height.
struct MovingPoint {
  CellPlace at;              ///< where it is looked for, and where it was found
  Vec2 step = Vec2::Zero();  ///< that led there
  Vec2 way = Vec2::Zero();  ///< direction in (u, v) of the line that it keeps to; zero where it may go the steepest way
  double scale = 0.0;       ///< mm: length of the pieces beside it
  bool found = false;
  SectionPoint* point = nullptr;  ///< where it is put once it is found
  Vec2 velocity = Vec2::Zero();   ///< d(u, v) / dz along its way
};

/// What a point on its way may need.
struct MoveLimits {
  double share = 0.0;  ///< of the step, that the first correction may be long; 0: any
  double reach = 0.0;  ///< in scales, that every correction may be long
  int rounds = 1;      ///< most evaluations
};

/// Brings at most kLanes points to the height z, side by side. A last correction below 1e-4 of the scale isn't
/// evaluated but taken from the second derivatives: to third order, 1e-12 of the piece, along the surface. Its length
/// is that of Newton's step, whose error in height is the square of it times half the bend along the way, 5e-9 of the
/// piece at a bend of one radian.
void move_points(const SectionSurface& surface, double sign, double z, const MoveLimits& limits,
                 std::span<MovingPoint> points);

/// What pieces are held to.
struct FitLimits {
  double turn = 0.0;      ///< radians: largest between the tangents of two neighbouring points
  double accepted = 0.0;  ///< mm: larger errors have the piece in (u, v) kept as well
};

/// Pieces fitted side by side.
struct PieceFits {
  std::array<ArcPiece, kLanes> pieces;
  std::array<ArcPiece, kLanes> uv;      ///< only where the error is larger than accepted
  std::array<double, kLanes> errors{};  ///< mm, as PieceFit has it; infinite where points can't be joined
};

/// Neighbouring points of an arc that are joined side by side, each to the next in its own cell.
class PointRun {
 public:
  PointRun(const SectionSurface& surface, double sign, const SectionPoint& first)
      : surface_(&surface), sign_(sign), points_{&first} {}

  /// Adds the piece to the next point; false if that was the last one that the run can take. Where the next piece lies
  /// in another cell, the point is seen from this one's, and the run ends.
  bool add(const Cell& cell, const SectionPoint& next, const Cell& next_cell);

  [[nodiscard]] std::size_t pieces() const { return count_; }
  [[nodiscard]] const SectionPoint& point(std::size_t i) const { return *points_[i]; }
  [[nodiscard]] const Cell& cell(std::size_t i) const { return cells_[i]; }
  [[nodiscard]] const SectionSurface& surface() const { return *surface_; }

 private:
  const SectionSurface* surface_;
  double sign_;
  std::size_t count_ = 0;
  std::array<const SectionPoint*, kLanes + 1> points_;
  std::array<Cell, kLanes> cells_;
  SectionPoint last_;  ///< as the cell sees it that is left there
};

/// Joins the points of a run: pieces and their (u, v), errors 0 or infinite.
void join_run(const PointRun& run, double largest_turn, PieceFits& fits);

/// Joins the points and measures the pieces as fit_piece does.
void fit_run(const PointRun& run, const FitLimits& limits, PieceFits& fits);

/// Measures how far points lie from a surface, across its section at their height and to first order about the point of
/// their (u, v).
class DistanceMeter {
 public:
  DistanceMeter(const SectionSurface& surface, double z) : surface_(&surface) { lanes_.z = z; }

  void add(const CellPlace& place, const Vec2& xy);
  /// The largest distance of all points so far, mm; NaN if one is.
  double largest();

 private:
  void flush();

  const SectionSurface* surface_;
  std::size_t count_ = 0;
  double largest_ = 0.0;
  std::array<CellPlace, kLanes> places_;
  MeasureLanes lanes_;
};

}  // namespace lamella::span
