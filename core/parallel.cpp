#include "core/parallel.h"

#include <algorithm>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include "core/ordered_pipeline.h"

namespace lamella {

int count_threads(int threads) {
  // TBB warns on stderr when asked for more workers than the machine has.
  const int cores = tbb::info::default_concurrency();
  return threads > 0 ? std::min(threads, cores) : cores;
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body, int threads) {
  tbb::task_arena arena(count_threads(threads));
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, count, body); });
}

void parallel_for_within(std::size_t count, const std::function<void(std::size_t)>& body) {
  tbb::this_task_arena::isolate([&] { tbb::parallel_for(std::size_t{0}, count, body); });
}

void ordered_pipeline(std::size_t count, std::size_t in_flight, const PipelineStage& work, const PipelineStage& finish,
                      int threads) {
  std::size_t next = 0;
  const auto begin = [&](tbb::flow_control& flow) {
    if (next == count) flow.stop();
    return next++;
  };
  // Items enter and leave in order, so those between are consecutive and no two of them share a slot.
  const auto in_parallel = [&](std::size_t item) {
    work(item, item % in_flight);
    return item;
  };
  const auto in_order = [&](std::size_t item) { finish(item, item % in_flight); };
  tbb::task_arena arena(count_threads(threads));
  arena.execute([&] {
    tbb::parallel_pipeline(in_flight,
                           tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order, begin) &
                               tbb::make_filter<std::size_t, std::size_t>(tbb::filter_mode::parallel, in_parallel) &
                               tbb::make_filter<std::size_t, void>(tbb::filter_mode::serial_in_order, in_order));
  });
}

}  // namespace lamella
