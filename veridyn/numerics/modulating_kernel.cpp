#include "veridyn/numerics/modulating_kernel.hpp"

#include <fmt/format.h>

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn::numerics {

ModulatingKernel modulating_kernel(double rate_Hz, double cutoff_Hz) {
  if (!(cutoff_Hz > 0.0 && cutoff_Hz <= 0.1 * rate_Hz * (1.0 + 1e-9))) {
    throw InputError("pass_band", fmt::format("is {:g} Hz; must be > 0 and at most a tenth of the rate of {:g} Hz",
                                              cutoff_Hz, rate_Hz));
  }
  constexpr int kPower = 6;
  // Standard deviation T/sqrt(2 n + 3) of the kernel; a Gaussian of that width has the gain 1/sqrt(2) at
  // sqrt(ln 2)/(2 pi s).
  const double T = std::sqrt(2.0 * kPower + 3.0) * std::sqrt(std::log(2.0)) / (kFullTurn * cutoff_Hz);
  const double step = 1.0 / rate_Hz;
  const auto m = static_cast<int>(std::floor(T / step));
  ModulatingKernel kernel;
  kernel.half_length_s = T;
  for (FirKernel* k : {&kernel.smooth, &kernel.first, &kernel.second}) {
    k->rate_Hz = rate_Hz;
    k->taps.resize(at(2 * m + 1));
  }
  double sum = 0.0, slope = 0.0, curvature = 0.0;
  for (int j = -m; j <= m; ++j) {
    const double s = j * step / T;
    const double q = 1.0 - s * s;
    const double q4 = q * q * q * q;
    const std::size_t i = at(j + m);
    kernel.smooth.taps[i] = q4 * q * q;
    kernel.first.taps[i] = 2.0 * kPower * s * q4 * q / T;
    kernel.second.taps[i] = 2.0 * kPower * q4 * (2.0 * (kPower - 1) * s * s - q) / (T * T);
    sum += kernel.smooth.taps[i];
    slope += kernel.first.taps[i] * j * step;
    curvature += kernel.second.taps[i] * 0.5 * j * j * step * step;
  }
  // The sums are right to rounding by themselves for long kernels; short ones are made exact for parabolas.
  for (double& t : kernel.smooth.taps) t /= sum;
  for (double& t : kernel.first.taps) t /= slope;
  double mean = 0.0;
  for (double& t : kernel.second.taps) {
    t /= curvature;
    mean += t;
  }
  for (std::size_t i = 0; i < kernel.second.taps.size(); ++i) kernel.second.taps[i] -= mean * kernel.smooth.taps[i];
  return kernel;
}

}  // namespace veridyn::numerics
