#include "veridyn/recording/gravity.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::recording {

VerticalAcceleration vertical_acceleration(double median, const Unit& taken) {
  const estimation::Tolerance& t = estimation::info_of(estimation::Check::kGravity).tolerance;
  using Holds = VerticalAcceleration::Holds;
  VerticalAcceleration result{.median = median, .times_g = median / kGravity};
  const double ratio = std::abs(result.times_g);
  if (ratio > t.lowest && ratio < t.highest) {
    result.holds = Holds::kGravity;
    return result;
  }
  for (const Unit& truly : units_like(taken)) {
    const double in_unit = ratio * truly.scale / taken.scale;
    if (in_unit > t.low && in_unit < t.high) {
      result.holds = Holds::kGravity;
      result.unit = truly.name;
      return result;
    }
  }
  if (ratio < t.highest - 1.0)
    result.holds = Holds::kNothing;
  else if (ratio - 1.0 > t.lowest && ratio - 1.0 < t.highest)
    result.holds = Holds::kTwice;
  return result;
}

VerticalAcceleration vertical_acceleration(std::span<const double> samples, const Unit& taken) {
  std::vector<double> finite;
  std::ranges::copy_if(samples, std::back_inserter(finite), [](double v) { return std::isfinite(v); });
  return vertical_acceleration(finite.empty() ? kNaN : numerics::median(finite), taken);
}

}  // namespace veridyn::recording
