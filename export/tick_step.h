#pragma once

#include <cmath>

namespace lamella {

/// The step of 1, 2 or 5 times a power of ten, the least that gives at most `ticks` ticks over `range` > 0.
[[nodiscard]] inline double tick_step(double range, double ticks) {
  const double raw = range / ticks;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (raw <= factor * power * (1.0 + 1e-9)) return factor * power;
  }
  return 10.0 * power;
}

}  // namespace lamella
