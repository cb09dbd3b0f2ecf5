#pragma once

#include <cmath>
#include <limits>

namespace lamella {

/// How a tool moves along a straight line. Every move begins and ends at rest: it gains speed evenly, keeps it, and
/// loses it evenly (docs/methods/build-plan.md, equation 3).
struct RampedMotion {
  double speed = 0.0;                                             ///< mm/s that it reaches, more than 0
  double acceleration = std::numeric_limits<double>::infinity();  ///< mm/s^2; infinite: no time is lost

  bool operator==(const RampedMotion&) const = default;

  /// s from rest to rest over `length` mm, 0 or more.
  [[nodiscard]] double time(double length) const {
    if (length * acceleration >= speed * speed) return length / speed + speed / acceleration;
    return 2.0 * std::sqrt(length / acceleration);
  }
};

}  // namespace lamella
