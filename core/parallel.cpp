#include "core/parallel.h"

#include <algorithm>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace lamella {

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body, int threads) {
  // TBB warns on stderr when asked for more workers than the machine has.
  const int cores = tbb::info::default_concurrency();
  tbb::task_arena arena(threads > 0 ? std::min(threads, cores) : cores);
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, count, body); });
}

}  // namespace lamella
