#pragma once

#include <cstddef>
#include <functional>

namespace lamella {

/// What happens to one item; `slot` is where its data may lie, in [0, in_flight).
using PipelineStage = std::function<void(std::size_t item, std::size_t slot)>;

/// Calls `work` for the items 0, 1, ... count - 1 on up to `threads` threads (0 or more than there are: all cores), in
/// no particular order, and `finish` for one after the other in ascending order, while others are worked on.
///
/// At most `in_flight` items, at least 1, have been begun and not been finished; no two of them have the same slot.
/// The first exception is rethrown here once the calls that run have returned; no new ones begin then.
void ordered_pipeline(std::size_t count, std::size_t in_flight, const PipelineStage& work, const PipelineStage& finish,
                      int threads = 0);

}  // namespace lamella
