#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace veridyn::numerics {

/// Response of an output to an input at one frequency, estimated from records.
struct ResponseEstimate {
  double frequency_Hz = 0.0;
  std::complex<double> response;  ///< H1 = S_xy/S_xx
  double coherence = 0.0;         ///< |S_xy|^2/(S_xx S_yy), 1 where all of the output is explained
  /// Relative standard deviation of the gain, and of the phase [rad]: sqrt((1 - c)/(2 n c)) (Bendat & Piersol 2010, eq.
  /// 9.90), n the number of independent segments (0.95 a segment at half overlap).
  double sigma = 0.0;
};

/// Frequency response by Welch's method: Hann windows of `segment` samples (a power of two is quick), half overlapping,
/// means removed. Values at multiples of rate/segment between `low_Hz` and `high_Hz`. Frequencies where the input has
/// less than 1e-6 of its peak density are left out.
/// @throws InputError when sizes differ, the segment is longer than the record or shorter than 16, the band is empty,
/// or a value is not finite.
[[nodiscard]] std::vector<ResponseEstimate> spectral_response(std::span<const double> input,
                                                              std::span<const double> output, double rate_Hz,
                                                              std::size_t segment, double low_Hz, double high_Hz);

}  // namespace veridyn::numerics
