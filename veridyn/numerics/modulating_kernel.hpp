#pragma once

#include "veridyn/numerics/filters.hpp"

namespace veridyn::numerics {

/// A smoothing kernel of finite length and the derivatives of what it smooths (the modulating functions of Shinbrot,
/// NACA TN 3288, 1957): by parts,
///
///     int h(s) x'(t+s) ds = -int h'(s) x(t+s) ds,     int h x'' = int h'' x,
///
/// so x is never differentiated, and x, x', x'' come out of one and the same filter exactly: a linear relation between
/// them holds for the smoothed ones. h(s) is proportional to (1 - (s/T)^2)^6, which leaves no boundary term. Sums
/// over samples stand for the integrals: with 8 samples in T the second derivative of what is in the pass band is right
/// to 2.5e-4, with 26 to better than 1e-4. Not flat in its pass band: gain
/// about exp(-(2 pi f)^2 T^2/30), which relations do not mind.
struct ModulatingKernel {
  FirKernel smooth;  ///< h, sum 1
  FirKernel first;   ///< gives d/dt of what `smooth` gives [1/s]
  FirKernel second;  ///< d^2/dt^2 [1/s^2]
  double half_length_s = 0.0;
};

/// @param cutoff_Hz where the gain is 0.71 (-3 dB): T = 0.513/cutoff
/// @throws InputError unless 0 < cutoff <= rate/10.
[[nodiscard]] ModulatingKernel modulating_kernel(double rate_Hz, double cutoff_Hz);

}  // namespace veridyn::numerics
