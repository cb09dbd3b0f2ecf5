#pragma once

#include <cstddef>
#include <vector>

#include "core/progress.h"
#include "model/support_function.h"

namespace lamella {

/// The paper's scheme (section 3, step 1): the model is turned about axes that the user names, in steps, to the least
/// build height: min H(angle), 0 < angle < 360 degrees.
struct AxisScan {
  std::vector<Vec3> axes;  ///< of the machine frame, any length but zero, in the order in which they are tried
  double step = 1.0;       ///< degree
};

/// One turn that lowered the height.
struct AxisTurn {
  std::size_t axis = 0;
  double angle = 0.0;   ///< degree
  double height = 0.0;  ///< mm, after it
};

struct AxisScanResult {
  Mat3 turn = Mat3::Identity();
  double height = 0.0;  ///< mm, exact
  std::vector<AxisTurn> turns;
  std::size_t heights = 0;  ///< computed
};

/// Tries all angles of the first axis and keeps the best, then those of the next one from there, round after round
/// until no axis lowers the height any more (with one axis: one round). Throws UsageError without an axis, for axes
/// that are zero or not finite and for steps outside [0.001, 180]; Cancelled.
[[nodiscard]] AxisScanResult scan_axes(const SupportFunction& support, const AxisScan& scan,
                                       const Progress& progress = {});

}  // namespace lamella
