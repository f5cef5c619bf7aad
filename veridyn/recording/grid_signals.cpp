#include "veridyn/recording/grid_signals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/numerics/noise.hpp"

namespace veridyn::recording {

std::pair<std::size_t, std::size_t> grid_indices(const numerics::UniformGrid& grid, const TimeSpan& span) {
  const auto index = [&](double t, double rounding) {
    const double k = std::floor((t - grid.begin) / grid.step + rounding);
    return static_cast<std::size_t>(std::clamp(k, 0.0, static_cast<double>(grid.count)));
  };
  return {index(span.begin, 1.0 - 1e-6), index(span.end, 1.0 + 1e-6)};
}

double grid_rate(const Channel& reference, double chosen_Hz) {
  return chosen_Hz > 0.0 ? chosen_Hz : std::min(kHighestGridRate_Hz, std::round(reference.rate_Hz()));
}

numerics::UniformGrid grid_over(const Channel& reference, double rate_Hz, std::string_view place) {
  const TimeSpan span = reference.span();
  if (!(span.duration() * rate_Hz <= static_cast<double>(kLongestGrid))) {
    throw InputError(place, fmt::format("its {} spans {:.4g} s, at {:g} Hz more than {} samples: are its stamps in "
                                        "another unit? (key `unit` of [data.time])",
                                        reference.name, span.duration(), rate_Hz, kLongestGrid));
  }
  return numerics::UniformGrid::covering(span.begin, span.end, 1.0 / rate_Hz);
}

std::vector<double> on_grid(const Channel& channel, const numerics::UniformGrid& grid, Holes holes,
                            numerics::Interpolation interpolation) {
  numerics::ResampleOptions options;
  options.interpolation = interpolation;
  if (holes == Holes::kOfHalfASecond) {
    const double rate = channel.rate_Hz();
    options.gap_limit_s = std::max(0.5, rate > 0.0 ? 3.0 / rate : 0.0);
  }
  return numerics::resample(channel.times(), channel.value, grid, options);
}

std::vector<double> angle_on_grid(const Channel& channel, const numerics::UniformGrid& grid, Holes holes) {
  Channel unwrapped = channel;
  numerics::unwrap_angles(unwrapped.value);
  return on_grid(unwrapped, grid, holes);
}

double noise_floor(std::span<const double> values, double rate_Hz) {
  const double low = numerics::measurement_noise(values, rate_Hz, 0.2 * rate_Hz).sd;
  const double high = numerics::measurement_noise(values, rate_Hz, 0.4 * rate_Hz).sd;
  const double variance = 2.0 * high * high - low * low;
  return variance > 0.25 * high * high && low > high ? std::sqrt(variance) : std::min(low, high);
}

namespace {

/// A channel's values in the places of its own clock; NaN where one was lost. Nothing is interpolated: a value between
/// two samples has less noise than either. Nothing where stamps are not a tenth of an interval from places.
std::optional<std::vector<double>> in_places(const Channel& channel, double rate_Hz) {
  constexpr double kOffPlace = 0.1;
  const std::span<const double> stamps = channel.times();
  const auto place = [&](std::size_t i) { return (stamps[i] - stamps.front()) * rate_Hz; };
  std::vector<double> values(std::min(static_cast<std::size_t>(place(stamps.size() - 1)) + 2, kLongestGrid), kNaN);
  std::size_t off = 0;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const auto at = static_cast<std::size_t>(std::llround(place(i)));
    if (at < values.size()) values[at] = channel.value[i];
    // From the last one: a rate that is not exact drifts off its places.
    const double since = i == 0 ? 0.0 : place(i) - place(i - 1);
    if (std::abs(since - std::round(since)) > kOffPlace) ++off;
  }
  return off * 10 > stamps.size() ? std::nullopt : std::optional(std::move(values));
}

/// White noise of samples with many holes, by fourth differences of five in a row: 70 times its variance, while what is
/// slower than a tenth of the rate is left to (2 pi f / rate)^8.
double noise_by_differences(std::span<const double> x) {
  double squares = 0.0, count = 0.0;
  for (std::size_t k = 4; k < x.size(); ++k) {
    const double d = x[k - 4] - 4.0 * x[k - 3] + 6.0 * x[k - 2] - 4.0 * x[k - 1] + x[k];
    if (!std::isfinite(d)) continue;
    squares += d * d;
    count += 1.0;
  }
  return count > 30.0 ? std::sqrt(squares / (70.0 * count)) : 0.0;
}

}  // namespace

double noise_floor(const Channel& channel) {
  const double rate = channel.rate_Hz();
  if (!(rate > 0.0)) return 0.0;
  if (const std::optional<std::vector<double>> values = in_places(channel, rate)) {
    // Where hardly any stretch is whole, what the whole ones show is chance.
    constexpr double kMostLost = 0.02;
    const auto lost = std::ranges::count_if(*values, [](double v) { return !std::isfinite(v); });
    if (static_cast<double>(lost) > kMostLost * static_cast<double>(values->size()))
      if (const double noise = noise_by_differences(*values); noise > 0.0) return noise;
    if (const double noise = noise_floor(*values, rate); noise > 0.0) return noise;
  }
  numerics::UniformGrid grid = numerics::UniformGrid::covering(channel.span().begin, channel.span().end, 1.0 / rate);
  grid.count = std::min(grid.count, kLongestGrid);
  return noise_floor(on_grid(channel, grid, Holes::kOfTheSensor, numerics::Interpolation::kLinear), rate);
}

GivenNoise read_noise(const StudyTable& table, std::span<const StandardChannel> channels) {
  GivenNoise given;
  for (const StandardChannel& channel : channels) {
    if (table.has(channel.name)) given.emplace_back(channel.name, table.positive(channel.name, channel.unit));
  }
  return given;
}

StudyKey noise_key(std::string otherwise) {
  return {"noise",
          "SI",
          "by the standard names of channels",
          std::move(otherwise),
          "standard deviation of a channel's white noise per sample",
          true};
}

std::optional<double> given_noise(const GivenNoise& given, std::string_view channel) {
  for (const auto& [name, sd] : given) {
    if (name == channel) return sd;
  }
  return std::nullopt;
}

}  // namespace veridyn::recording
