#pragma once

#include <cstddef>
#include <functional>

namespace veridyn::numerics {

/// Calls `work(i)` for i = 0 .. count - 1, on `threads` threads (0: as many as the machine has). Items are handed out
/// one by one, so they may take different times; results that are stored by `i` do not depend on the number of threads.
/// Stops handing out when `proceed`, called on the calling thread between items, returns false.
/// The first exception of any item is thrown once all threads have ended.
/// @return whether all items were done
bool parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& work,
                  const std::function<bool(std::size_t done)>& proceed = {});

}  // namespace veridyn::numerics
