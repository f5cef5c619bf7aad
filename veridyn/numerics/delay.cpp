#include "veridyn/numerics/delay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::numerics {
namespace {

constexpr std::ptrdiff_t kSincHalfWidth = 12;

struct Centred {
  std::vector<double> value;  // zero where missing
  std::vector<double> known;  // 1 or 0
  double power = 0.0;
};

Centred centre(std::span<const double> x) {
  double sum = 0.0, count = 0.0;
  for (const double v : x) {
    if (std::isfinite(v)) sum += v, count += 1.0;
  }
  Centred c{std::vector<double>(x.size(), 0.0), std::vector<double>(x.size(), 0.0), 0.0};
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (!std::isfinite(x[k])) continue;
    c.value[k] = x[k] - sum / count;
    c.known[k] = 1.0;
    c.power += c.value[k] * c.value[k];
  }
  return c;
}

// sum a_k b_{k+lag} over the known pairs, normalised by their powers.
double correlation_at(const Centred& a, const Centred& b, std::ptrdiff_t lag) {
  const auto n = signed_index(a.value.size());
  const std::ptrdiff_t begin = std::max<std::ptrdiff_t>(0, -lag);
  const std::ptrdiff_t end = std::min(n, n - lag);
  double ab = 0.0, aa = 0.0, bb = 0.0;
  for (std::ptrdiff_t k = begin; k < end; ++k) {
    const auto j = static_cast<std::size_t>(k + lag);
    ab += a.value[k] * b.value[j];
    aa += a.value[k] * a.value[k] * b.known[j];
    bb += b.value[j] * b.value[j] * a.known[k];
  }
  return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : 0.0;
}

double interpolated(const std::vector<double>& c, double position) {
  const auto centre_index = static_cast<std::ptrdiff_t>(std::floor(position));
  // Over the sum of the weights, which a short sinc leaves 1e-3 off one: as much as a slow signal's peak is high.
  double sum = 0.0, weights = 0.0;
  for (std::ptrdiff_t j = centre_index - kSincHalfWidth + 1; j <= centre_index + kSincHalfWidth; ++j) {
    const double u = position - static_cast<double>(j);
    const double taper = std::cos(0.5 * kPi * u / static_cast<double>(kSincHalfWidth));
    const double sinc = std::abs(u) < 1e-12 ? 1.0 : std::sin(kPi * u) / (kPi * u);
    const double weight = sinc * taper * taper;
    sum += weight * c[j];
    weights += weight;
  }
  return sum / weights;
}

/// Where the sampled correlation c, of sign `sign`, is largest: golden-section search one lag to either side of `peak`.
double refined_peak(const std::vector<double>& c, double peak, double sign) {
  const double ratio = 0.5 * (std::sqrt(5.0) - 1.0);
  double low = std::max(peak - 1.0, static_cast<double>(kSincHalfWidth));
  double high = std::min(peak + 1.0, static_cast<double>(c.size() - 1) - static_cast<double>(kSincHalfWidth));
  for (int i = 0; i < 60; ++i) {
    const double left = high - ratio * (high - low), right = low + ratio * (high - low);
    if (sign * interpolated(c, left) > sign * interpolated(c, right)) {
      high = right;
    } else {
      low = left;
    }
  }
  return 0.5 * (low + high);
}

/// Mean square bandwidth [rad^2/s^2]: the curvature of the reference's own autocorrelation.
double mean_square_bandwidth(const Centred& a, double rate_Hz) {
  double slope2 = 0.0;
  for (std::size_t k = 1; k < a.value.size(); ++k) {
    const double step = (a.value[k] - a.value[k - 1]) * a.known[k] * a.known[k - 1];
    slope2 += step * step;
  }
  return slope2 * rate_Hz * rate_Hz / a.power;
}

/// The standard deviation of a delay [s]: from the mean square bandwidth and from how many independent samples differ.
double delay_sigma(const Centred& a, const Centred& b, const DelayEstimate& found, double rate_Hz) {
  const double c2 = std::max(found.correlation * found.correlation, 1e-12);
  const double bandwidth2 = found.bandwidth_rad_s * found.bandwidth_rad_s;
  const auto n = signed_index(a.value.size());
  const auto lag = static_cast<std::ptrdiff_t>(std::llround(found.delay_s * rate_Hz));
  std::vector<double> mismatch;
  for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(0, -lag); k < std::min(n, n - lag); ++k) {
    const auto j = static_cast<std::size_t>(k + lag);
    if (a.known[k] * b.known[j] > 0.0)
      mismatch.push_back(b.value[j] / std::sqrt(b.power) - found.correlation * a.value[k] / std::sqrt(a.power));
  }
  const double samples = std::max(1.0, effective_sample_size_variance(mismatch));
  return std::sqrt((1.0 - std::min(c2, 1.0)) / (c2 * samples * bandwidth2));
}

}  // namespace

DelayEstimate estimate_delay(std::span<const double> reference, std::span<const double> delayed, double rate_Hz,
                             const DelayOptions& options) {
  if (reference.size() != delayed.size()) {
    throw InputError("estimate_delay",
                     fmt::format("signals have {} and {} samples; must be equal", reference.size(), delayed.size()));
  }
  if (!(rate_Hz > 0.0)) throw InputError("estimate_delay.rate_Hz", fmt::format("is {}; must be > 0", rate_Hz));
  DelayEstimate result;
  const auto n = signed_index(reference.size());
  const auto max_lag = static_cast<std::ptrdiff_t>(std::ceil(options.max_delay_s * rate_Hz));
  const std::ptrdiff_t span = max_lag + kSincHalfWidth;  // lags beyond the search serve the interpolation
  if (n < 4 * span) {
    result.reason = "the signals are shorter than eight times the largest delay";
    return result;
  }
  const Centred a = centre(reference);
  const Centred b = centre(delayed);
  if (!(a.power > 0.0) || !(b.power > 0.0)) {
    result.reason = "one of the signals is constant";
    return result;
  }
  std::vector<double> c;
  c.reserve(static_cast<std::size_t>(2 * span + 1));
  for (std::ptrdiff_t lag = -span; lag <= span; ++lag) c.push_back(correlation_at(a, b, lag));
  std::ptrdiff_t peak = 0;
  for (std::ptrdiff_t lag = -max_lag; lag <= max_lag; ++lag) {
    if (std::abs(c[lag + span]) > std::abs(c[peak + span])) peak = lag;
  }
  const double sign = c[peak + span] < 0.0 ? -1.0 : 1.0;
  const double position = refined_peak(c, static_cast<double>(peak + span), sign);
  result.delay_s = (position - static_cast<double>(span)) / rate_Hz;
  result.correlation = std::clamp(interpolated(c, position), -1.0, 1.0);
  result.at_zero = c[span];
  for (std::ptrdiff_t i = span - max_lag; i <= span + max_lag; ++i) {
    const double here = std::abs(c[i]);
    const bool maximum = here >= std::abs(c[i - 1]) && here >= std::abs(c[i + 1]);
    if (maximum && std::abs(static_cast<double>(i) - position) > 1.5) {
      result.side_peak = std::max(result.side_peak, here / std::abs(result.correlation));
    }
  }
  result.bandwidth_rad_s = std::sqrt(mean_square_bandwidth(a, rate_Hz));
  result.sigma_s = delay_sigma(a, b, result, rate_Hz);
  if (std::abs(result.correlation) < options.min_correlation) {
    result.reason = "the signals correlate too little";
  } else if (std::abs(peak) == max_lag) {
    result.reason = "the correlation still rises at the end of the search";
    result.at_end = true;
  } else if (result.side_peak > options.max_side_peak) {
    result.reason = "another delay fits as well (the signal repeats itself)";
  } else {
    result.determined = true;
  }
  return result;
}

}  // namespace veridyn::numerics
