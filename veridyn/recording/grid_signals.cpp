#include "veridyn/recording/grid_signals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

double noise_floor(const Channel& channel) {
  const double rate = channel.rate_Hz();
  if (!(rate > 0.0)) return 0.0;
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
