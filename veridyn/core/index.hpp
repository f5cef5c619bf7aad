#pragma once

#include <concepts>
#include <cstddef>

namespace veridyn {

/// A signed index as a size, where sizes are compared or a template takes its type from it: `std::min(at(rows),
/// v.size())`. In a subscript an index needs neither of the two: the compiler converts it.
[[nodiscard]] constexpr std::size_t at(std::signed_integral auto index) { return static_cast<std::size_t>(index); }

/// A size as an index that can be compared with Eigen's: `row < signed_index(v.size())`.
[[nodiscard]] constexpr std::ptrdiff_t signed_index(std::unsigned_integral auto index) {
  return static_cast<std::ptrdiff_t>(index);
}

}  // namespace veridyn
