#pragma once

#include <cstddef>

namespace veridyn::numerics {

/// Which part of a work this process computes, of several that run whenever they like: items `index`, `index + count`,
/// ... Nothing waits for the others.
struct ProcessShare {
  std::size_t index = 0;  ///< below `count`
  std::size_t count = 1;  ///< 0: computes nothing, only reads what is there

  [[nodiscard]] bool computes(std::size_t item) const { return count > 0 && item % count == index; }
};

}  // namespace veridyn::numerics
