#pragma once

#include "apps/json.h"
#include "apps/orientation.h"

namespace lamella::apps {

/// docs/command.md, `lamella orient --json`.
[[nodiscard]] Json orient_json(const OrientRequest& request, const OrientOutcome& outcome);
/// What people read.
[[nodiscard]] std::string orient_text(const OrientRequest& request, const OrientOutcome& outcome);

}  // namespace lamella::apps
