#include "veridyn/numerics/resample.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/filters.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::numerics {
namespace {

struct Samples {
  std::vector<double> time;
  std::vector<double> value;
};

Samples usable_samples(std::span<const double> time, std::span<const double> value, bool last_of_equal_counts) {
  if (time.size() != value.size()) {
    throw InputError("resample", fmt::format("{} stamps for {} values; must be equal", time.size(), value.size()));
  }
  Samples samples;
  samples.time.reserve(time.size());
  samples.value.reserve(time.size());
  double previous = -kInfinity;
  double equal = 0.0;
  for (std::size_t k = 0; k < time.size(); ++k) {
    if (!std::isfinite(time[k]) || time[k] < previous) {
      throw InputError(fmt::format("resample: sample {}", k),
                       fmt::format("stamp {} after {}; must be finite and never decrease", time[k], previous));
    }
    previous = time[k];
    if (!std::isfinite(value[k])) continue;
    if (!samples.time.empty() && samples.time.back() == time[k]) {
      equal += 1.0;
      double& kept = samples.value.back();
      kept = last_of_equal_counts ? value[k] : kept + (value[k] - kept) / equal;
      continue;
    }
    equal = 1.0;
    samples.time.push_back(time[k]);
    samples.value.push_back(value[k]);
  }
  return samples;
}

// Slope at the end of a stretch: the three-point formula, limited so that the cubic keeps the data's shape.
double end_slope(double h0, double h1, double d0, double d1) {
  double slope = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
  if (slope * d0 <= 0.0) return 0.0;
  if (d0 * d1 <= 0.0 && std::abs(slope) > 3.0 * std::abs(d0)) slope = 3.0 * d0;
  return slope;
}

std::vector<double> pchip_slopes(const Samples& s, const std::vector<char>& gap_after) {
  const std::size_t n = s.time.size();
  std::vector<double> slope(n, 0.0);
  const auto h = [&](std::size_t i) { return s.time[i + 1] - s.time[i]; };
  const auto d = [&](std::size_t i) { return (s.value[i + 1] - s.value[i]) / h(i); };
  for (std::size_t i = 0; i < n; ++i) {
    const bool left = i > 0 && !gap_after[i - 1];
    const bool right = i + 1 < n && !gap_after[i];
    if (left && right) {
      const double before = d(i - 1), after = d(i);
      if (before * after > 0.0) {
        const double w1 = 2.0 * h(i) + h(i - 1), w2 = h(i) + 2.0 * h(i - 1);
        slope[i] = (w1 + w2) / (w1 / before + w2 / after);
      }
    } else if (right) {
      const bool third = i + 2 < n && !gap_after[i + 1];
      slope[i] = third ? end_slope(h(i), h(i + 1), d(i), d(i + 1)) : d(i);
    } else if (left) {
      const bool third = i > 1 && !gap_after[i - 2];
      slope[i] = third ? end_slope(h(i - 1), h(i - 2), d(i - 1), d(i - 2)) : d(i - 1);
    }
  }
  return slope;
}

std::vector<double> interpolate(const Samples& s, const UniformGrid& grid, Interpolation method, double gap_limit) {
  std::vector<double> out(grid.count, kNaN);
  const std::size_t n = s.time.size();
  if (n == 0) return out;
  std::vector<char> gap_after(n, 1);
  for (std::size_t i = 0; i + 1 < n; ++i) gap_after[i] = s.time[i + 1] - s.time[i] > gap_limit ? 1 : 0;
  const std::vector<double> slope =
      method == Interpolation::kPchip ? pchip_slopes(s, gap_after) : std::vector<double>();
  // Grid moments are begin + k step in floating point: a moment within a millionth of a step of a sample is that
  // sample.
  const double near = 1e-6 * grid.step;
  std::size_t i = 0;
  for (std::size_t k = 0; k < grid.count; ++k) {
    const double t = grid.at(k);
    if (t < s.time.front() - near) continue;
    if (t > s.time.back() + near) break;
    while (i + 1 < n && s.time[i + 1] <= t) ++i;
    if (std::abs(t - s.time[i]) <= near || n == 1) {
      out[k] = s.value[i];
      continue;
    }
    if (i + 1 < n && std::abs(s.time[i + 1] - t) <= near) {
      out[k] = s.value[i + 1];
      continue;
    }
    if (i + 1 >= n || gap_after[i]) continue;
    const double h = s.time[i + 1] - s.time[i];
    const double u = (t - s.time[i]) / h;
    switch (method) {
      case Interpolation::kHold:
        out[k] = s.value[i];
        break;
      case Interpolation::kLinear:
        out[k] = s.value[i] + u * (s.value[i + 1] - s.value[i]);
        break;
      case Interpolation::kPchip: {
        const double v = 1.0 - u;
        out[k] = v * v * (1.0 + 2.0 * u) * s.value[i] + u * u * (1.0 + 2.0 * v) * s.value[i + 1] +
                 u * v * h * (v * slope[i] - u * slope[i + 1]);
        break;
      }
    }
  }
  return out;
}

}  // namespace

UniformGrid UniformGrid::covering(double from, double to, double step) {
  if (!(step > 0.0) || !std::isfinite(step)) throw InputError("grid.step", fmt::format("is {}; must be > 0", step));
  UniformGrid grid;
  grid.step = step;
  const double first = std::ceil(from / step - 1e-6);
  const double last = std::floor(to / step + 1e-6);
  grid.begin = first * step;
  grid.count = last >= first ? static_cast<std::size_t>(last - first) + 1 : 0;
  return grid;
}

std::vector<double> resample(std::span<const double> time, std::span<const double> value, const UniformGrid& grid,
                             const ResampleOptions& options) {
  if (!(grid.step > 0.0)) throw InputError("resample.grid.step", fmt::format("is {}; must be > 0", grid.step));
  const bool hold = options.interpolation == Interpolation::kHold;
  const Samples samples = usable_samples(time, value, hold);
  if (samples.time.size() < 2) return interpolate(samples, grid, options.interpolation, 0.0);
  std::vector<double> intervals(samples.time.size() - 1);
  for (std::size_t k = 0; k < intervals.size(); ++k) intervals[k] = samples.time[k + 1] - samples.time[k];
  const double interval = median(intervals);
  const double gap_limit = options.gap_limit_s > 0.0 ? options.gap_limit_s : 5.0 * interval;
  if (hold || !options.anti_alias || grid.step <= 1.25 * interval) {
    return interpolate(samples, grid, options.interpolation, gap_limit);
  }
  // Evenly at about the samples' own rate, then low-pass, then the grid: a whole number of fine steps a grid step.
  const double fine_per_step = std::ceil(grid.step / interval);
  const double fine_rate = fine_per_step / grid.step;
  const UniformGrid fine{
      grid.begin - std::floor((grid.begin - samples.time.front()) * fine_rate) / fine_rate, 1.0 / fine_rate,
      static_cast<std::size_t>(std::max(0.0, std::floor((samples.time.back() - samples.time.front()) * fine_rate))) +
          2};
  const std::vector<double> even = interpolate(samples, fine, options.interpolation, gap_limit);
  const double nyquist = 0.5 / grid.step;
  const std::vector<double> smooth =
      filter(even, low_pass({.rate_Hz = fine_rate, .pass_Hz = 0.8 * nyquist, .stop_Hz = nyquist}));
  std::vector<double> out(grid.count, kNaN);
  const auto offset = static_cast<std::ptrdiff_t>(std::llround((grid.begin - fine.begin) * fine_rate));
  const auto stride = static_cast<std::ptrdiff_t>(fine_per_step);
  for (std::size_t k = 0; k < grid.count; ++k) {
    const std::ptrdiff_t index = offset + static_cast<std::ptrdiff_t>(k) * stride;
    if (index >= 0 && index < signed_index(smooth.size())) out[k] = smooth[index];
  }
  return out;
}

void unwrap_angles(std::span<double> angle) {
  double previous = kNaN;
  for (double& a : angle) {
    if (!std::isfinite(a)) continue;
    if (std::isfinite(previous)) a -= kFullTurn * std::round((a - previous) / kFullTurn);
    previous = a;
  }
}

}  // namespace veridyn::numerics
