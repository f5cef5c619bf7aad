#pragma once

#include <span>

namespace veridyn::numerics {

/// How a delay between two signals is searched, and when it counts as found.
struct DelayOptions {
  double max_delay_s = 0.5;      ///< searched in both directions
  double min_correlation = 0.5;  ///< below it the signals do not show the same motion
  double max_side_peak =
      0.95;  ///< another maximum this near to the peak's height leaves the choice open (periodic signals)
};

/// How much later `delayed` shows what `reference` shows.
struct DelayEstimate {
  double delay_s = 0.0;  ///< positive when `delayed` is later
  double sigma_s = 0.0;  ///< standard error: (1 - c^2)/c^2 over the effective samples and the mean square bandwidth
  double bandwidth_rad_s = 0.0;  ///< of the reference: root mean square of its derivative over its own
  double correlation = 0.0;  ///< normalised cross-correlation c at the peak, signed: -1 when one has the opposite sign
  double at_zero = 0.0;      ///< the same without shifting
  double side_peak = 0.0;    ///< height of the highest other maximum over the peak's
  bool at_end = false;       ///< the correlation still rises at the end of the search
  bool determined = false;   ///< correlation, side peak and place (not at the end of the search) all allow the answer
  const char* reason = "";   ///< why not, in words
};

/// Delay by the maximum of the absolute normalised cross-correlation, each lag over the samples where both are finite,
/// on signals sampled evenly at `rate_Hz`; between lags the correlation is interpolated by a windowed sinc, which for
/// band-limited signals is unbiased where a parabola is not. Remove trends first: they correlate at every lag (means
/// are removed here).
/// @throws InputError when the sizes differ or the rate is not > 0.
[[nodiscard]] DelayEstimate estimate_delay(std::span<const double> reference, std::span<const double> delayed,
                                           double rate_Hz, const DelayOptions& options = {});

}  // namespace veridyn::numerics
