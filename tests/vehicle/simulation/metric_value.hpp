#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "veridyn/vehicle/simulation/manoeuvre_metrics.hpp"

namespace veridyn::vehicle::testing {

/// The metric of this name; NaN, and a failure, where it is not in the list.
inline double value(const std::vector<Metric>& list, std::string_view name) {
  const auto found = std::ranges::find_if(list, [&](const Metric& m) { return m.name == name; });
  EXPECT_NE(found, list.end()) << name;
  return found == list.end() ? std::nan("") : found->value;
}

}  // namespace veridyn::vehicle::testing
