#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/numerics/resample.hpp"

namespace veridyn::recording {

/// How one signal reads what another one shows: reading = gain * truth + what other signals explain + bias.
///
/// Both may be noisy. Least squares of the reading on the truth gives a gain that noise of the truth makes too small;
/// the reciprocal of the truth on the reading is one that noise of the reading makes too large: the gain lies between
/// the two (Frisch 1934, "Statistical Confluence Analysis"), whatever the ratio of the noises.
struct SignalGain {
  double low = 0.0, high = 0.0;  ///< `low` <= `high`; infinite where the reading says nothing of the truth
  double low_sigma = 0.0, high_sigma = 0.0;
  /// Partial correlation of reading and truth: what the others explain is taken off both.
  double correlation = 0.0;
  double truth_rms = 0.0;    ///< of the truth, what the others explain taken off
  double reading_rms = 0.0;  ///< the same of the reading
  std::size_t rows = 0;

  [[nodiscard]] double middle() const { return 0.5 * (low + high); }
};

/// Signals that are compared, on one grid; NaN where missing.
struct ComparedSignals {
  std::span<const double> reading, truth;
  std::vector<std::vector<double>> others = {};
  bool with_bias = true;  ///< false: the reading's zero is that of the truth
};

/// Compares low-passed signals (`band_Hz`) inside `spans`, at four rows a period of the band; standard errors allow for
/// the residual's autocorrelation. Rows where `used` is false are left out (empty: all are used).
/// Nothing for fewer than 40 rows.
[[nodiscard]] std::optional<SignalGain> signal_gain(const ComparedSignals& signals, const numerics::UniformGrid& grid,
                                                    std::span<const TimeSpan> spans, double band_Hz,
                                                    std::span<const bool> used = {});

/// A signal low-passed as for signal_gain, and its derivative through the same filter.
[[nodiscard]] std::vector<double> low_passed(std::span<const double> values, const numerics::UniformGrid& grid,
                                             double band_Hz);
/// The derivative [1/s] of what `low_passed` gives.
[[nodiscard]] std::vector<double> low_passed_derivative(std::span<const double> values,
                                                        const numerics::UniformGrid& grid, double band_Hz);

}  // namespace veridyn::recording
