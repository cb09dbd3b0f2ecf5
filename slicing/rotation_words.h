#pragma once

#include <array>
#include <string>

#include "core/geometry.h"

namespace lamella {

/// Attributes of <orientation> in build.xml and plan.xml, row by row.
inline constexpr std::array<const char*, 9> kTurnNames{"xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"};

/// The nine numbers row by row, separated by blanks, in the fewest digits that read back as the same: what formats
/// with keys and values have as "rotation".
[[nodiscard]] std::string rotation_text(const Mat3& turn);

}  // namespace lamella
