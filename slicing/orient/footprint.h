#pragma once

#include <optional>
#include <vector>

#include "model/support_function.h"

namespace lamella {

/// How the assembly lies on the plate once it is known what points up.
struct Lying {
  Mat3 turn = Mat3::Identity();  ///< from the present frame to the machine's
  Vec3 size = Vec3::Zero();      ///< mm along the machine's axes, exact
};

/// Turns `up` to +z and then about z so that the rectangle x y that it takes is least; where that doesn't go into
/// `room` (mm along x and y), so that the larger of x / room.x and y / room.y is least. The angle is found with
/// `points` of the solids, among 0, 90 degrees and those at which a side of their outline lies along an axis (steps of
/// a degree where the outline is round, and to fit in the room); no turn about z where that gains less than 0.1 %.
[[nodiscard]] Lying lay_down(const SupportFunction& support, const std::vector<Vec3>& points, const Vec3& up,
                             const std::optional<Vec2>& room);

}  // namespace lamella
