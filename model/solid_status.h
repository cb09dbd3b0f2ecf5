#pragma once

#include <string>

#include "model/scene.h"

namespace lamella {

/// "ok", "open", "invalid" or "empty", as reports and outputs have it. A solid whose shells don't close is open
/// whatever the import said of it.
[[nodiscard]] std::string status_word(const SolidInfo& solid);

}  // namespace lamella
