#pragma once

#include "core/error.h"

namespace lamella {

inline constexpr const char* kPlanNamespace = "urn:lamella:plan:1";

inline const char* severity_word(Severity severity) {
  return severity == Severity::note ? "note" : severity == Severity::warning ? "warning" : "error";
}

}  // namespace lamella
