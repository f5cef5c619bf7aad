#pragma once

#include <cstddef>
#include <vector>

namespace veridyn::numerics {

/// Which part of a work that several processes share is this process': items `index`, `index + count`, ...
struct ProcessShare {
  std::size_t index = 0;  ///< below `count`
  std::size_t count = 1;  ///< 0: computes nothing, only reads what is there
  /// The other processes run at the same time: what they compute is waited for.
  bool wait = false;
  double patience_s = 60.0;  ///< so long may a process that is waited for show no life

  [[nodiscard]] bool computes(std::size_t item) const { return count > 0 && item % count == index; }
  /// Which of the processes computes it; `count` > 0.
  [[nodiscard]] std::size_t owner(std::size_t item) const { return item % count; }
  /// The items 0 to `items` - 1, first those that this process computes: whoever goes through them in that order keeps
  /// no other process waiting.
  [[nodiscard]] std::vector<std::size_t> own_first(std::size_t items) const;
};

}  // namespace veridyn::numerics
