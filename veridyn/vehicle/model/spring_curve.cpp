#include "veridyn/vehicle/model/spring_curve.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "veridyn/core/error.hpp"

namespace veridyn::vehicle {

SpringCurve::SpringCurve(std::vector<double> travel, std::vector<double> force)
    : travel_(std::move(travel)), force_(std::move(force)) {
  if (travel_.size() != force_.size())
    throw InputError("spring", fmt::format("has {} travels and {} forces", travel_.size(), force_.size()));
  if (travel_.size() < 2) throw InputError("spring", "needs at least two rows");
  for (std::size_t i = 0; i < travel_.size(); ++i) {
    const bool finite = std::isfinite(travel_[i]) && std::isfinite(force_[i]);
    if (finite && (i == 0 || (travel_[i] > travel_[i - 1] && force_[i] > force_[i - 1]))) continue;
    throw InputError("spring", fmt::format("row {} ({:g} m, {:g} N): travel and force must be finite and increase",
                                           i + 1, travel_[i], force_[i]));
  }
  const std::size_t last = travel_.size() - 1;
  const auto width = [&](std::size_t i) { return travel_[i + 1] - travel_[i]; };
  const auto secant = [&](std::size_t i) { return (force_[i + 1] - force_[i]) / width(i); };
  slope_.resize(travel_.size());
  slope_.front() = secant(0);
  slope_.back() = secant(last - 1);
  for (std::size_t i = 1; i < last; ++i) {
    const double before = 2.0 * width(i) + width(i - 1), after = width(i) + 2.0 * width(i - 1);
    slope_[i] = (before + after) / (before / secant(i - 1) + after / secant(i));
  }
  at_rest_ = along(0.0);
}

double SpringCurve::rate(double travel) const {
  if (travel <= travel_.front()) return slope_.front();
  if (travel >= travel_.back()) return slope_.back();
  std::size_t i = 0;
  while (travel >= travel_[i + 1]) ++i;
  const double width = travel_[i + 1] - travel_[i], secant = (force_[i + 1] - force_[i]) / width;
  const double p = (travel - travel_[i]) / width;
  return slope_[i] + p * (2.0 * (3.0 * secant - 2.0 * slope_[i] - slope_[i + 1]) +
                          p * 3.0 * (slope_[i] + slope_[i + 1] - 2.0 * secant));
}

SpringCurve SpringCurve::scaled(double length, double force) const {
  if (empty()) return {};
  std::vector<double> travel = travel_, forces = force_;
  for (double& one : travel) one *= length;
  for (double& one : forces) one *= force;
  return {std::move(travel), std::move(forces)};
}

}  // namespace veridyn::vehicle
