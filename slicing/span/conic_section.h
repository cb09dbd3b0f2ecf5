#pragma once

#include <optional>

#include "model/surface.h"
#include "slicing/span/arc_piece.h"

namespace lamella::span {

/// An arc of a conic, less than half a turn, as a rational Bezier curve of degree 2:
/// ((1-t)^2 begin + 2 w t (1-t) pole + t^2 end) / ((1-t)^2 + 2 w t (1-t) + t^2).
struct ConicArc {
  Vec2 begin = Vec2::Zero();
  Vec2 pole = Vec2::Zero();  ///< where the tangents of both ends meet
  Vec2 end = Vec2::Zero();
  double weight = 1.0;  ///< positive: less than 1 of an ellipse, 1 of a parabola, more of a hyperbola
};

/// The exact section of a cone or cylinder in any position at height z that a traced piece stands for, with its ends
/// moved onto it. Nothing for other surfaces, where the piece is straight to rounding or next to an apex, and where it
/// isn't within 1e-6 mm of the section.
[[nodiscard]] std::optional<ConicArc> conic_arc(const Surface& surface, double z, const ArcPiece& piece);

}  // namespace lamella::span
