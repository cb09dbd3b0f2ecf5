#pragma once

#include <atomic>

namespace lamella::apps {

/// From now on the first SIGINT or SIGTERM sets the flag, so that the run ends without leaving anything half-written;
/// the second ends the program at once.
void watch_signals();

/// Set by the first signal.
[[nodiscard]] const std::atomic<bool>& cancel_flag();

}  // namespace lamella::apps
