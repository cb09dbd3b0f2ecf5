#pragma once

#include <cstddef>
#include <functional>

namespace lamella {

/// Calls `body(i)` for i in [0, count) on up to `threads` threads (0 or more than there are: all cores), in no
/// particular order. The first exception of a body is rethrown here. The result must not depend on the order.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body, int threads = 0);

}  // namespace lamella
