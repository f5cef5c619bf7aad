#include "veridyn/report/figures/curves.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/rank.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::report {

namespace {

constexpr double kGapSpacings = 10.0;

double median_spacing(std::span<const double> time) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < time.size(); ++k) steps.push_back(time[k] - time[k - 1]);
  return upper_median(steps);
}

}  // namespace

std::vector<double> scaled(std::span<const double> values, double factor) {
  std::vector<double> result(values.begin(), values.end());
  for (double& value : result) value *= factor;
  return result;
}

bool any_finite(std::span<const double> values) {
  return std::any_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

std::vector<Window> windows_of(std::span<const double> time) {
  if (time.size() < 2) return {};
  const double limit = kGapSpacings * median_spacing(time);
  std::vector<Window> windows;
  std::size_t first = 0;
  for (std::size_t k = 1; k <= time.size(); ++k) {
    if (k < time.size() && time[k] - time[k - 1] <= limit) continue;
    if (time[k - 1] > time[first]) windows.push_back({.from = time[first], .to = time[k - 1]});
    first = k;
  }
  return windows;
}

std::vector<Span> spans_where(std::span<const double> time, const std::vector<bool>& holds, std::string_view label,
                              SpanTone tone) {
  VERIDYN_ASSERT(time.size() == holds.size());
  std::vector<Span> spans;
  bool open = false;
  for (std::size_t k = 0; k < time.size(); ++k) {
    if (holds[k] && !open) spans.push_back({.from = time[k], .to = time[k], .label = std::string(label), .tone = tone});
    if (holds[k]) spans.back().to = time[k];
    open = holds[k];
  }
  return spans;
}

Line followed_line(std::vector<double> value, std::span<const double> sigma, double largest) {
  VERIDYN_ASSERT(value.size() == sigma.size());
  const double limit = 4.0 * largest;
  Line line{.name = "on line", .y = std::move(value)};
  Band band;
  for (std::size_t k = 0; k < sigma.size(); ++k) {
    const bool shown = std::isfinite(sigma[k]) && std::abs(line.y[k]) <= limit;
    if (!shown) line.y[k] = kNaN;
    band.low.push_back(shown ? std::max(-limit, line.y[k] - numerics::kNormal95 * sigma[k]) : kNaN);
    band.high.push_back(shown ? std::min(limit, line.y[k] + numerics::kNormal95 * sigma[k]) : kNaN);
  }
  line.band = std::move(band);
  return line;
}

}  // namespace veridyn::report
