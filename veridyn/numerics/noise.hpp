#pragma once

#include <cstddef>
#include <span>

namespace veridyn::numerics {

/// White measurement noise of a recorded channel, from its content above a frequency.
struct NoiseEstimate {
  double sd = 0.0;          ///< standard deviation of white noise with that spectral floor, unit of the channel
  double floor = 0.0;       ///< one-sided spectral density of the floor [unit^2/Hz]; sd^2 = floor * rate/2
  double line_share = 0.0;  ///< share (0..1) of the power above the frequency that exceeds the floor: lines, vibration
  std::size_t values = 0;   ///< spectral values used
  bool determined =
      false;  ///< enough values (>= 50) and a floor above zero (a frozen or coarsely quantised channel has none)
};

/// Median of Hann-windowed periodograms (256 samples, half overlapping, mean and slope removed, shorter for short
/// records) over all bins above `above_Hz` and all windows, divided by ln 2, the median of the exponential law they
/// follow. Lines and bursts that fill less than half of the values move it little. Only stretches without NaN are used.
/// @throws InputError unless 0 < above_Hz < rate/2.
[[nodiscard]] NoiseEstimate measurement_noise(std::span<const double> x, double rate_Hz, double above_Hz);

}  // namespace veridyn::numerics
