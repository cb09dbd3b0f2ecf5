#pragma once

#include <string>

#include "slicing/store/store.h"

namespace lamella::apps {

/// "A:B", as --layers takes it: layers A to B - 1, either side may be missing. Throws UsageError.
[[nodiscard]] LayerRange parse_layers(const std::string& text);

/// The range cut to what the build has. Throws UsageError when it lies beyond.
[[nodiscard]] LayerRange clip(LayerRange range, std::size_t layers);

}  // namespace lamella::apps
