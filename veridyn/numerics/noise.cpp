#include "veridyn/numerics/noise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/filters.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::numerics {
namespace {

// Removes the straight line through the window by least squares, or its edge steps would leak into every bin.
void detrend(std::vector<double>& window) {
  const auto n = static_cast<double>(window.size());
  double sum = 0.0, moment = 0.0;
  for (std::size_t k = 0; k < window.size(); ++k) {
    sum += window[k];
    moment += window[k] * (static_cast<double>(k) - 0.5 * (n - 1.0));
  }
  const double slope = 12.0 * moment / (n * (n * n - 1.0));
  for (std::size_t k = 0; k < window.size(); ++k)
    window[k] -= sum / n + slope * (static_cast<double>(k) - 0.5 * (n - 1.0));
}

}  // namespace

NoiseEstimate measurement_noise(std::span<const double> x, double rate_Hz, double above_Hz) {
  if (!(rate_Hz > 0.0) || !(above_Hz > 0.0) || !(above_Hz < 0.5 * rate_Hz)) {
    throw InputError("measurement_noise.above_Hz",
                     fmt::format("is {}; must be > 0 and below half the rate, {}", above_Hz, 0.5 * rate_Hz));
  }
  const auto stretches = finite_stretches(x);
  std::size_t longest = 0;
  for (const auto& [begin, end] : stretches) longest = std::max(longest, end - begin);
  std::size_t length = 256;
  while (length > longest && length > 32) length /= 2;
  NoiseEstimate result;
  if (length > longest) return result;

  std::vector<double> taper(length);
  double taper_power = 0.0;
  for (std::size_t k = 0; k < length; ++k) {
    taper[k] = 0.5 - 0.5 * std::cos(2.0 * kPi * (static_cast<double>(k) + 0.5) / static_cast<double>(length));
    taper_power += taper[k] * taper[k];
  }
  // The two bins next to the cut and next to Nyquist would mix in what lies outside.
  const auto first_bin = static_cast<std::size_t>(std::ceil(above_Hz / rate_Hz * static_cast<double>(length))) + 1;
  const std::size_t last_bin = length / 2 - 1;
  Eigen::FFT<double> fft;
  std::vector<double> window(length);
  std::vector<std::complex<double>> spectrum;
  std::vector<double> density;
  for (const auto& [begin, end] : stretches) {
    for (std::size_t start = begin; start + length <= end; start += length / 2) {
      std::copy_n(x.begin() + start, length, window.begin());
      detrend(window);
      for (std::size_t k = 0; k < length; ++k) window[k] *= taper[k];
      fft.fwd(spectrum, window);
      for (std::size_t bin = first_bin; bin < last_bin; ++bin)
        density.push_back(2.0 * std::norm(spectrum[bin]) / (rate_Hz * taper_power));
    }
  }
  if (density.empty()) return result;
  double mean = 0.0;
  for (const double d : density) mean += d / static_cast<double>(density.size());
  result.values = density.size();
  result.floor = median(density) / std::numbers::ln2;
  result.sd = std::sqrt(result.floor * 0.5 * rate_Hz);
  result.line_share = mean > 0.0 ? std::max(0.0, 1.0 - result.floor / mean) : 0.0;
  result.determined = density.size() >= 50 && result.floor > 0.0;
  return result;
}

}  // namespace veridyn::numerics
