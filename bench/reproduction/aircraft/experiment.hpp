#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "veridyn/aircraft/simulation/simulate_study.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/core/recording.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/regression/regression_data.hpp"

namespace veridyn::aircraft {

/// A numerical experiment on one coefficient: exact rows of a simulated flight with new noise for every seed, so
/// that what an estimator does on average, and how often its intervals cover, can be counted. Study table
/// `[experiment]` next to `[subject]` and `[flight]`.
///
///     coefficient = "Cn"
///     seeds = 100                # repetitions, seeded by `seed` of the study and their number
///     rate = "50 Hz"             # of rows; at most the flight's truth_rate
///     spans = [10, 70]           # [s] begin and end of each part of the flight that is used; left out: all
///     snr = 30                   # of z [dB]: 10 log10(variance of z over the rows / variance of its noise)
///     regressor_snr = 20         # of each regressor that is not constant [dB]; left out: regressors are exact
///     events = [200, 230]        # [s] something happens to the aircraft that is no change of the model, such as a
///     stall noise_time = "0.3 s"       # correlation time of the noises (first order); left out: white
struct ExperimentOptions {
  SimulationOptions flight;
  Coefficient coefficient = Coefficient::kCL;
  int seeds = 100;
  double rate_Hz = 50.0;
  std::vector<TimeSpan> spans;
  double snr_dB = 30.0;
  std::optional<double> regressor_snr_dB;
  double noise_time_s = 0.0;
  std::vector<double> events_s;

  /// Reads the tables of `root`.
  /// @throws InputError naming file, line and key.
  [[nodiscard]] static ExperimentOptions read(const StudyTable& root);
};

/// Exact rows of the coefficient over the flight.
struct ExactRows {
  std::vector<std::string> names;
  std::vector<double> time;          ///< [s]
  estimation::RowMatrix regressors;  ///< the model's terms
  Eigen::VectorXd regressand;        ///< the coefficient itself, changes and stall included
  Eigen::VectorXd truth;             ///< parameters at the start
  Eigen::MatrixXd truth_at;          ///< parameters at each row: they change where the flight says so
  Eigen::VectorXd noise_sd;          ///< of each column of [x, z]; 0: exact

  /// W: diag(noise_sd^2).
  [[nodiscard]] Eigen::MatrixXd error_covariance() const { return noise_sd.cwiseAbs2().asDiagonal(); }
};

/// Flies once and takes the rows.
/// @throws InputError when the flight fails or leaves no rows, or a regressor never moves while it should carry noise.
[[nodiscard]] ExactRows exact_rows(const ExperimentOptions& options, Progress& progress);

/// The rows with the noise of repetition `number`: same numbers for the same seed, whatever the thread.
[[nodiscard]] estimation::RegressionData noisy_rows(const ExactRows& rows, const ExperimentOptions& options,
                                                    std::uint64_t number);

}  // namespace veridyn::aircraft
