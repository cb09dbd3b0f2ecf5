#pragma once

#include "core/error.h"

namespace lamella {

inline constexpr const char* kPlanNamespace = "urn:lamella:plan:1";
inline constexpr const char* kPlanVersion = "1.0";
inline constexpr const char* kTurnedPlanVersion = "1.1";  ///< of builds that were turned before they were sliced

inline constexpr const char* kWeighedPlanVersion = "1.2";  ///< that say how the tools were chosen

inline const char* severity_word(Severity severity) {
  return severity == Severity::note ? "note" : severity == Severity::warning ? "warning" : "error";
}

}  // namespace lamella
