#pragma once

#include <CLI/CLI.hpp>
#include <optional>

#include "slicing/adaptive/layer_rules.h"

namespace lamella::apps {

void add_adaptive_options(CLI::App& verb);

/// What --adaptive asks for, without the machine; nothing if it isn't given. Throws UsageError on numbers that make no
/// sense, on --layer-height beside it and on its further options without it.
[[nodiscard]] std::optional<AdaptiveOptions> read_adaptive_options(const CLI::App& verb);

}  // namespace lamella::apps
