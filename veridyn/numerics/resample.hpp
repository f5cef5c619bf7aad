#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace veridyn::numerics {

/// Evenly spaced moments begin + k step.
struct UniformGrid {
  double begin = 0.0;  ///< [s]
  double step = 0.01;  ///< [s]
  std::size_t count = 0;

  [[nodiscard]] double at(std::size_t k) const { return begin + static_cast<double>(k) * step; }
  [[nodiscard]] double rate_Hz() const { return 1.0 / step; }
  /// All moments of a grid through whole multiples of `step` that lie in [from, to].
  [[nodiscard]] static UniformGrid covering(double from, double to, double step);
};

/// How a signal goes from sample to sample.
enum class Interpolation {
  kLinear,
  kPchip,  ///< piecewise cubic Hermite, Fritsch & Butland (1984) slopes: C1, third order, never overshoots the data
  kHold    ///< last value: modes, counters, commands that are held
};

/// How samples are brought onto a grid.
struct ResampleOptions {
  Interpolation interpolation = Interpolation::kPchip;
  /// Neighbouring samples further apart leave NaN between them [s]; 0 chooses 5 median intervals.
  double gap_limit_s = 0.0;
  /// Low-pass below 0.4 of the grid's rate before thinning out, when the grid is coarser than 0.8 of the median rate of
  /// the samples. Never applied with kHold.
  bool anti_alias = true;
};

/// Values at irregular stamps (never decreasing, [s]) on a grid; NaN before the first and after the last sample, in
/// gaps, and never extrapolated. Samples that are NaN count as missing; samples of equal stamp are averaged (kHold: the
/// last one counts).
/// @throws InputError when sizes differ, a stamp is not finite or decreases, or the grid's step is not > 0.
[[nodiscard]] std::vector<double> resample(std::span<const double> time, std::span<const double> value,
                                           const UniformGrid& grid, const ResampleOptions& options = {});

/// Removes jumps of more than half a turn between neighbouring finite angles [rad], so that they can be interpolated.
void unwrap_angles(std::span<double> angle);

}  // namespace veridyn::numerics
