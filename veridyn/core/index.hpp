#pragma once

#include <concepts>
#include <cstddef>

namespace veridyn {

/// A signed index, Eigen's or that of a model's list, as the standard containers take it: `bodies[at(joint.child)]`.
[[nodiscard]] constexpr std::size_t at(std::signed_integral auto index) { return static_cast<std::size_t>(index); }

/// The index of a standard container as Eigen takes it: `force(signed_index(wheel))`.
[[nodiscard]] constexpr std::ptrdiff_t signed_index(std::unsigned_integral auto index) {
  return static_cast<std::ptrdiff_t>(index);
}

}  // namespace veridyn
