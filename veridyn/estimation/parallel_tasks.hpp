#pragma once

#include <cstddef>
#include <functional>

namespace veridyn::estimation {

/// Runs task(0), ..., task(count - 1) on up to `threads` threads (0: all cores). Tasks are handed out in order but may
/// end in any: a task writes to a place of its own, so that results do not depend on the number of threads. The first
/// exception is thrown again here once all threads have ended.
void parallel_tasks(std::size_t count, int threads, const std::function<void(std::size_t)>& task);

}  // namespace veridyn::estimation
