#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "slicing/span/arc_piece.h"
#include "slicing/span/section_surface.h"

namespace lamella::span {

/// What the tracer knows of a face.
struct TraceLimits {
  double tolerance = 1e-7;  ///< mm: accepted error of an arc piece
  double longest = 1.0;     ///< mm: longest step
  double last = 10.0;       ///< tolerances that the last piece of an arc may be off
  double landing = 1e-5;    ///< mm: how far an end node may lie from the arc that ends there
  bool ellipses = true;     ///< ellipses stay what they are; else they become pieces as well
};

/// A traced arc: pieces.size() + 1 points.
struct TracedArc {
  std::vector<SectionPoint> points;
  std::vector<Cell> cells;        ///< one a piece
  std::vector<std::int8_t> axes;  ///< one a point: 0 or 1 where it lies on a knot u or v = const, else -1
  std::vector<ArcPiece> pieces;
  std::size_t target = 0;  ///< index of the target it ended on
  bool landed = false;

  void clear() {
    points.clear();
    cells.clear();
    axes.clear();
    pieces.clear();
    landed = false;
  }
};

inline constexpr std::size_t kNoTwin = static_cast<std::size_t>(-1);

/// Follows the section z = const of a surface from `start` along z x n until it meets one of `targets` (points of the
/// same section, at any period); false and what was traced when it doesn't. `start` itself may be a target: then the
/// arc runs once round. The target number `twin` is the start's own node seen from the other side of a seam: it counts
/// only once the arc has come round by a period. Steps end on the surface's knots, so that every piece is smooth; where
/// an arc runs along a knot with continuous second derivatives, a piece may cross it.
bool trace(const SectionSurface& surface, double sign, const SectionPoint& start, std::span<const SectionPoint> targets,
           const TraceLimits& limits, TracedArc& arc, std::size_t twin = kNoTwin);

}  // namespace lamella::span
