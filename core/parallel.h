#pragma once

#include <cstddef>
#include <functional>

namespace lamella {

/// How many threads `threads` asks for: that many, but not more than there are cores; 0 means all cores.
[[nodiscard]] int count_threads(int threads);

/// Calls `body(i)` for i in [0, count) on up to `threads` threads (0 or more than there are: all cores), in no
/// particular order. The first exception of a body is rethrown here. The result must not depend on the order.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body, int threads = 0);

/// The same inside a body of parallel_for() or of ordered_pipeline(), with idle threads of that loop. While it waits
/// for them the calling thread takes on nothing else of the outer loop.
void parallel_for_within(std::size_t count, const std::function<void(std::size_t)>& body);

}  // namespace lamella
