#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "veridyn/aircraft/simulation/dryden.hpp"
#include "veridyn/numerics/filters.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::aircraft {

/// From the velocity of the air to how fast it changes, up to 2 Hz: gusts faster than this are noise of the
/// reconstruction.
[[nodiscard]] numerics::FirKernel gust_differentiator(double rate_Hz);

/// What a reconstruction of the gusts misses of them, along each body axis a stationary Gaussian process.
///
/// Of gusts with Dryden's density G that are seen in white noise of density N, a smoother takes the share
/// W = G/(G + N) of each frequency (Wiener 1949), and what drives a simulation passes a low-pass H after that. The
/// error has the density
///
///     E = (1 - H W)^2 G + (H W)^2 N
///
/// which is all of G where nothing sees the gusts, or they are no input (H = 0).
class MissedGusts {
 public:
  /// @param airspeed  at which the gusts are flown through [m/s]
  /// @param noise  N along x, y, z, one-sided [(m/s)^2/Hz]; infinite where nothing sees them
  /// @param input  the differentiator whose output drives the simulation; nullptr where gusts are no input
  MissedGusts(const DrydenSettings& spectrum, double airspeed, const std::array<double, 3>& noise,
              const numerics::FirKernel* input);

  /// Whether there are any.
  [[nodiscard]] bool any() const { return variance(0) + variance(1) + variance(2) > 0.0; }
  /// Of the velocity along an axis, between 0.01 and 10 Hz [(m/s)^2].
  [[nodiscard]] double variance(std::size_t axis) const;
  /// A draw of how fast they change [m/s^2] at points `step_s` apart: a sum of oscillations, one of each narrow band of
  /// frequencies.
  [[nodiscard]] std::vector<std::array<double, 3>> acceleration(std::size_t points, double step_s,
                                                                numerics::RandomStream& random) const;

 private:
  static constexpr std::size_t kBands = 60;
  std::array<double, kBands + 1> border_Hz_;
  std::array<std::array<double, kBands>, 3> variance_{};  // of the velocity in a band
};

}  // namespace veridyn::aircraft
