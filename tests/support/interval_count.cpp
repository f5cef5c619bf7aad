#include "tests/support/interval_count.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/numerics/statistics.hpp"

namespace veridyn::test {

bool IntervalCount::add(const estimation::Parameter& parameter, double truth) {
  const double error = parameter.value - truth, half = 0.5 * (parameter.high95 - parameter.low95);
  const bool holds = truth >= parameter.low95 && truth <= parameter.high95;
  const bool identified = parameter.status == estimation::ParameterStatus::kIdentified;
  held_ += holds ? 1 : 0;
  identified_ += identified ? 1 : 0;
  wrong_ += identified && !holds && std::abs(error) > 0.1 * std::abs(truth) ? 1 : 0;
  ranks_.push_back(0.5 * std::erfc(numerics::kNormal95 * error / half / std::sqrt(2.0)));
  if (truth != 0.0) {
    widths_.push_back(half / std::abs(truth));
    errors_.push_back(std::abs(error / truth));
  }
  return holds;
}

double IntervalCount::coverage() const { return static_cast<double>(held_) / static_cast<double>(ranks_.size()); }

double IntervalCount::median_error() const { return numerics::median(errors_); }

double IntervalCount::median_half_width() const { return numerics::median(widths_); }

double IntervalCount::rank_chi_square() const {
  std::array<double, 10> bins{};
  for (const double rank : ranks_) bins[std::min<std::size_t>(9, static_cast<std::size_t>(10.0 * rank))] += 1.0;
  const double expected = 0.1 * static_cast<double>(ranks_.size());
  double sum = 0.0;
  for (const double n : bins) sum += (n - expected) * (n - expected) / expected;
  return sum;
}

}  // namespace veridyn::test
