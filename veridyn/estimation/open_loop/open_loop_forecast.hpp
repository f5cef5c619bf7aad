#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/open_loop/open_loop.hpp"
#include "veridyn/estimation/open_loop/open_loop_model.hpp"

namespace veridyn::estimation {

/// What measured less predicted has of its own, whatever the parameters: of noise that is new in each sample, and of
/// errors that last. Standard deviations [SI].
struct OpenLoopError {
  double white = 0.0;
  double lasting = 0.0;
  /// In so many samples the lasting error is one observation; infinite: it hardly changes within seconds.
  double memory = kInfinity;
};

/// View of what is known of the windows of one recording.
struct OpenLoopProblem {
  const Eigen::MatrixXd& covariance;      ///< of the model's parameters
  std::span<const OpenLoopError> errors;  ///< of each output that is forecast; none of them both zero
  std::vector<bool> judged;               ///< whether these windows judge it
  double start_s = 0.0;                   ///< OpenLoopTimes::start_s
  std::size_t stride = 1;                 ///< samples closer than this tell the same, having passed the same filter
  std::string recording = {};
  std::string group = {};
  double shift_s = 0.0;  ///< from the recording's own time to that of all
  /// Initial conditions that are not constant: what the first seconds say of them says nothing of what comes after,
  /// which has their prior's variance.
  std::vector<std::string> drifting = {};
};

/// A window as it was integrated: a row a sample, a column an output that is forecast.
struct OpenLoopForecast {
  OpenLoopWindow window;
  double shift_s = 0.0;
  std::vector<double> time;  ///< its recording's own
  RowMatrix measured, predicted, sigma;
};

/// What the first seconds of a window say of where it starts.
struct OpenLoopStart {
  Eigen::VectorXd theta;            ///< parameters, initial state, offsets
  Eigen::MatrixXd covariance;       ///< of initial state and offsets where the parameters are right
  Eigen::MatrixXd with_parameters;  ///< their change with the parameters, as they are fitted again
  Eigen::MatrixXd with_draws;       ///< their error by each draw of the disturbances, fitted without it
};

/// Initial states and offsets of all windows of a model whose parameters are fixed, from their first seconds: by output
/// error with the errors given. An error that lasts counts as one observation in its memory, and in those seconds at
/// least; so does what the disturbances do there.
/// @param first  the model, shortened here to those seconds
[[nodiscard]] std::vector<OpenLoopStart> open_loop_starts(OpenLoopModel& first, const OpenLoopProblem& problem,
                                                          Progress& progress);

/// All windows of a model (its segments), each integrated from its start; what diverges is cut there. Stretches that
/// are too short to forecast anything are left out.
///
/// The band of an output is +-1.96 sigma of measured less predicted,
///
///     sigma^2 = g P g' + S_x P_x S_x' + R + mean of d^2,   g = S_theta - S_x P_x A_x' W A_theta
///
/// with the parameters' covariance P, the information A_x' W A_x = P_x^-1 of the first seconds about initial state and
/// offsets, their priors among it, the sensitivities S of the prediction and A of those seconds, and the errors R of
/// what is measured: so an error of a parameter that the initial state made up for does not count twice. d is what a
/// draw of the model's disturbances does to the forecast, less what the initial state, which they disturb too, makes up
/// for: S_d - S_x P_x A_x' W A_d. The band
/// counts as left where the error of the next half second exceeds three sigma (RMS): 5 % of the samples are outside of
/// a right band, and a state that leaves may cross it again.
///
/// Windows run on the threads of `progress`, to the same bits on any number.
/// @param model  is shortened to what does not diverge
/// @param first  another one like it
[[nodiscard]] std::vector<OpenLoopForecast> open_loop_forecasts(OpenLoopModel& model, OpenLoopModel& first,
                                                                const OpenLoopProblem& problem, Progress& progress);

}  // namespace veridyn::estimation
