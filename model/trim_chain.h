#pragma once

#include <vector>

#include "model/bezier.h"
#include "model/scene.h"

namespace lamella {

/// Consecutive pieces of a loop in (u, v), each beginning where the one before it ends.
using Chain = std::vector<BezierCurve2>;

[[nodiscard]] Vec2 begin_of(const BezierCurve2& piece);
[[nodiscard]] Vec2 end_of(const BezierCurve2& piece);
[[nodiscard]] BezierCurve2 straight(const Vec2& begin, const Vec2& end);

/// Appends a straight piece from the chain's end to `to`, if that isn't there already.
void bridge(Chain& chain, const Vec2& to);
void move_by(Chain& chain, const Vec2& offset);

/// Whole periods from `from` to `to`, per coordinate; 0 where there is no period.
[[nodiscard]] Vec2 whole_periods(const Vec2& from, const Vec2& to, const Vec2& period);

/// True at a pole or an apex, where all u are one point: a step of a period along it is a true part of the loop.
[[nodiscard]] bool is_degenerate_step(const Face& face, const Vec2& at, const Vec2& step);

/// Closes all chains of a face, which have the region on their left. Those that end a period away from where they begin
/// run round the surface (a ring on a cylinder without a seam); they are joined in pairs by a seam, or to the pole or
/// apex they run around.
[[nodiscard]] std::vector<Chain> close_chains(const Face& face, std::vector<Chain> chains);

}  // namespace lamella
