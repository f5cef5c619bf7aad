#pragma once

#include <algorithm>
#include <cstddef>
#include <ranges>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn {

/// The value below or at which `rank` of the values lie, so that 0 is the smallest; rank < their number, and none is
/// NaN. Leaves `values` in another order, the smaller ones before the place of that rank.
template <std::ranges::random_access_range Values>
[[nodiscard]] auto value_of_rank(Values&& values, std::size_t rank) {
  VERIDYN_ASSERT(rank < std::ranges::size(values));
  const auto place = std::ranges::begin(values) + signed_index(rank);
  std::ranges::nth_element(values, place);
  return *place;
}

/// The middle one of the values, one of themselves: the upper of the two when their number is even (the median of
/// `numerics::median` is then their mean). Not empty and without NaN; leaves them in another order.
template <std::ranges::random_access_range Values>
[[nodiscard]] auto upper_median(Values&& values) {
  return value_of_rank(values, std::ranges::size(values) / 2);
}

}  // namespace veridyn
