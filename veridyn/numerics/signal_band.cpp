#include "veridyn/numerics/signal_band.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

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

}  // namespace

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
      return {std::move(tried[i + 1].value), tried[i + 1].pass_Hz, tried[i + 1].noise_gain};
  }
  return {recorded};
}

}  // namespace veridyn::numerics
