#pragma once

#include <vector>

#include "slicing/span/arc_piece.h"

namespace lamella::span {

/// Appends points of a piece to `points`, at t in (0, 1), both ends left out, so that every point of the piece lies
/// within `chord_error` (mm, above zero) of the chord of its stretch, and the other way round.
void flatten(const ArcPiece& piece, double chord_error, std::vector<Vec2>& points);

/// A bound of the distance between a piece's stretch from t0 to t1 and its chord, mm.
[[nodiscard]] double chord_distance(const ArcPiece& piece, double t0, double t1);

}  // namespace lamella::span
