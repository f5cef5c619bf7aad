#include "veridyn/numerics/signal_band.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <utility>

#include "veridyn/numerics/filters.hpp"

namespace veridyn::numerics {
namespace {

constexpr double kNarrowest_Hz = 0.5;
constexpr double kWidestShare = 0.2;  // of the rate
/// From pass to stop band.
constexpr double kTransition = 1.5;
constexpr double kStandardErrors = 3.0;

/// The recording through a low-pass, and what that took off.
struct Smoothed {
  double pass_Hz = 0.0;
  double noise_gain = 1.0;
  std::vector<double> value;
  double removed = 0.0;  ///< variance of white noise of which it would be what was taken off
  double samples = 0.0;
};

Smoothed smoothed(const std::vector<double>& recorded, double rate_Hz, double pass_Hz) {
  const FirKernel kernel = low_pass({.rate_Hz = rate_Hz, .pass_Hz = pass_Hz, .stop_Hz = kTransition * pass_Hz});
  Smoothed out{pass_Hz, kernel.noise_gain(), filter(recorded, kernel)};
  double sum = 0.0;
  for (std::size_t k = 0; k < recorded.size(); ++k) {
    // Stretches shorter than the kernel stay as they are.
    if (!std::isfinite(out.value[k])) out.value[k] = recorded[k];
    const double off = recorded[k] - out.value[k];
    if (!std::isfinite(off)) continue;
    sum += off * off;
    out.samples += 1.0;
  }
  const double white = 1.0 - 2.0 * kernel.taps[kernel.half_width()] + out.noise_gain;
  out.removed = sum / (white * std::max(1.0, out.samples));
  return out;
}

constexpr double kLongestLag_s = 8.0;
/// Middle of the low-pass's transition over its pass band.
constexpr double kMiddle = 0.5 * (1.0 + kTransition);

/// Autocovariances at lags up to `longest`, divided by all samples, so that no spectrum of them is negative.
std::vector<double> autocovariances(const std::vector<double>& x, double mean,
                                    std::span<const std::pair<std::size_t, std::size_t>> stretches,
                                    std::size_t longest) {
  std::vector<double> sum(longest + 1, 0.0);
  double samples = 0.0;
  for (const auto& [begin, end] : stretches) {
    samples += static_cast<double>(end - begin);
    for (std::size_t lag = 0; lag <= longest; ++lag)
      for (std::size_t k = begin + lag; k < end; ++k) sum[lag] += (x[k] - mean) * (x[k - lag] - mean);
  }
  for (double& s : sum) s /= samples;
  return sum;
}

/// Parzen's window at a lag as a share of the longest.
double parzen(double share) {
  return share <= 0.5 ? 1.0 - 6.0 * share * share * (1.0 - share) : 2.0 * std::pow(1.0 - share, 3);
}

/// The Wiener filter for white noise, which passes nothing above `stop` (as a share of half the rate).
struct WienerFilter {
  FirKernel kernel;
  double mean_gain = 0.0;  ///< over all frequencies
};
WienerFilter wiener_filter(const std::vector<double>& autocovariance, double noise, double stop) {
  const std::size_t longest = autocovariance.size() - 1, frequencies = 4 * longest;
  WienerFilter out;
  out.kernel.taps.assign(2 * longest + 1, 0.0);
  double* middle = out.kernel.taps.data() + longest;
  for (std::size_t i = 0; i < frequencies; ++i) {
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(frequencies);
    if (share > stop) break;
    const double angle = std::numbers::pi * share;
    double power = autocovariance[0];
    for (std::size_t lag = 1; lag <= longest; ++lag)
      power += 2.0 * parzen(static_cast<double>(lag) / static_cast<double>(longest)) * autocovariance[lag] *
               std::cos(angle * static_cast<double>(lag));
    const double gain = std::max(0.0, 1.0 - noise / power) / static_cast<double>(frequencies);
    out.mean_gain += gain;
    for (std::size_t lag = 0; lag <= longest; ++lag) middle[lag] += gain * std::cos(angle * static_cast<double>(lag));
  }
  for (std::size_t lag = 1; lag <= longest; ++lag) *(middle - lag) = middle[lag];
  return out;
}

}  // namespace

BandLimited denoised(const std::vector<double>& recorded, double rate_Hz, double least_noise) {
  BandLimited out = band_limited(recorded, rate_Hz, least_noise);
  const auto longest = static_cast<std::size_t>(std::lround(kLongestLag_s * rate_Hz));
  auto stretches = finite_stretches(recorded);
  std::erase_if(stretches, [&](const auto& s) { return s.second - s.first <= 2 * longest; });
  if (!(out.noise > 0.0) || stretches.empty()) return out;
  double mean = 0.0, samples = 0.0;
  for (const auto& [begin, end] : stretches)
    for (std::size_t k = begin; k < end; ++k) mean += recorded[k], samples += 1.0;
  mean /= samples;
  const WienerFilter wiener = wiener_filter(autocovariances(recorded, mean, stretches, longest), out.noise,
                                            2.0 * kMiddle * out.band_Hz / rate_Hz);
  std::vector<double> limited = out.value;
  for (double& v : limited) v -= mean;
  for (const auto& [begin, end] : stretches) {
    const std::span<double> there = std::span(out.value).subspan(begin, end - begin);
    filter(std::span(limited).subspan(begin, end - begin), wiener.kernel, there);
    for (double& v : there) v += mean;
  }
  out.noise_share = wiener.mean_gain;
  return out;
}

BandLimited band_limited(const std::vector<double>& recorded, double rate_Hz, double least_noise) {
  std::vector<Smoothed> tried;
  for (double pass = kNarrowest_Hz; kTransition * pass < 0.5 * rate_Hz && pass <= kWidestShare * rate_Hz;
       pass *= std::numbers::sqrt2)
    tried.push_back(smoothed(recorded, rate_Hz, pass));
  if (tried.size() < 2 || !(tried.back().removed > least_noise * least_noise)) return {recorded};
  const double noise = tried.back().removed;
  for (std::size_t i = 0; i + 1 < tried.size(); ++i) {
    const double chance = kStandardErrors * std::sqrt(2.0 / std::max(1.0, tried[i].samples));
    if (tried[i].removed <= (1.0 + chance) * noise)
      return {std::move(tried[i + 1].value), tried[i + 1].pass_Hz, tried[i + 1].noise_gain, noise};
  }
  return {recorded};
}

}  // namespace veridyn::numerics
