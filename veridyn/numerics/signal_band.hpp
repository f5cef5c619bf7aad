#pragma once

#include <vector>

namespace veridyn::numerics {

/// A recording with white noise, low-passed to the band of its signal.
struct BandLimited {
  std::vector<double> value;
  double band_Hz = 0.0;      ///< of the low-pass; 0: nothing was taken off
  double noise_share = 1.0;  ///< of the noise's variance that is left
  double noise = 0.0;        ///< variance of the white noise; 0 where nothing was taken off
};

/// Takes off what of a recording lies above its signal's band: among pass bands from 0.5 Hz up, each 1.41 times the one
/// before and at most a fifth of the rate, the narrowest that takes off no more power than white noise has there (three
/// standard errors allowed; what the widest takes off is that noise), and the next one for safety. The low-pass is flat
/// to 0.1 % in its band and without phase. As it is where that noise is below `least_noise` or no band is narrow
/// enough.
[[nodiscard]] BandLimited band_limited(const std::vector<double>& recorded, double rate_Hz, double least_noise);

/// The same, and of what that leaves the Wiener filter: each frequency by the share of its power that is no noise,
/// 1 - noise/power, the recorded spectrum by autocovariances over 8 s under Parzen's window. It is without phase; the
/// mean stays. What is left of the error does not go with the result (for a Gaussian signal that is the conditional
/// mean), so that a response which is fitted to it is not too small, as one is that is fitted to a noisy input
/// (Berkson 1950, J. American Statistical Association 45). `noise_share`: variance of that error over the noise's.
/// Stretches shorter than 16 s are low-passed only.
[[nodiscard]] BandLimited denoised(const std::vector<double>& recorded, double rate_Hz, double least_noise);

}  // namespace veridyn::numerics
