#include "veridyn/vehicle/manoeuvre/piecewise_linear.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"

namespace veridyn::vehicle {

PiecewiseLinear::PiecewiseLinear(double constant) : time_{0.0}, value_{constant} {}

PiecewiseLinear::PiecewiseLinear(std::vector<double> time, std::vector<double> value)
    : time_(std::move(time)), value_(std::move(value)) {
  if (time_.size() != value_.size()) {
    throw InputError("signal", fmt::format("has {} times and {} values", time_.size(), value_.size()));
  }
  for (std::size_t i = 0; i < time_.size(); ++i) {
    if (!std::isfinite(time_[i]) || !std::isfinite(value_[i])) {
      throw InputError("signal", fmt::format("sample {} is not finite", i + 1));
    }
    if (i > 0 && !(time_[i] > time_[i - 1])) {
      throw InputError("signal", fmt::format("sample {} at {:g} s is not after the one before", i + 1, time_[i]));
    }
  }
}

double PiecewiseLinear::operator()(double time) const {
  if (time_.empty()) return 0.0;
  const auto after = std::upper_bound(time_.begin(), time_.end(), time);
  if (after == time_.begin()) return value_.front();
  if (after == time_.end()) return value_.back();
  const auto i = static_cast<std::size_t>(after - time_.begin());
  const double share = (time - time_[i - 1]) / (time_[i] - time_[i - 1]);
  return value_[i - 1] + share * (value_[i] - value_[i - 1]);
}

}  // namespace veridyn::vehicle
