#pragma once

#include <memory>
#include <vector>

#include "veridyn/estimation/output_error/input_error_model.hpp"
#include "veridyn/muscle/identification/emg_driven_model.hpp"
#include "veridyn/muscle/identification/task_estimate.hpp"

namespace veridyn::muscle {

/// An estimate from recorded angles, moments and EMG.
struct EmgEstimate {
  TaskEstimate estimate;            ///< its residuals are those of the whitened outputs: 1 is the noise
  Eigen::VectorXd noise;            ///< of the outputs' measurement, as stated or as found
  std::vector<double> input_share;  ///< by segment: share of the residual's variance that is the EMG's error
  // What profiles need: the outputs in units in which residuals are independent.
  std::unique_ptr<estimation::InputErrorModel> model;  ///< views `responses`
  std::vector<estimation::RowMatrix> measured;
};

/// Generalised least squares over all segments (`estimate_from_tasks` on `estimation::InputErrorModel`): what errors of
/// the EMG make of the moments, by the model's own response to them, is part of the residual's covariance. It follows
/// from the parameters and is computed again at each estimate until that rests. Without it intervals would take errors
/// of the EMG, alike over a tenth of a second and larger the harder a muscle pulls, for noise of the moments.
/// @param responses what the search is answered by: the model, or a view of it (`estimation::LoggedModel`)
/// @param noise standard deviation by output; empty: found from the residual (expectation maximisation)
[[nodiscard]] EmgEstimate estimate_from_emg(const EmgDrivenModel& model, const estimation::ParametricModel& responses,
                                            const std::vector<estimation::RowMatrix>& measured,
                                            const Eigen::VectorXd& noise, const EmgError& error,
                                            const TaskEstimateOptions& options, Progress& progress);

}  // namespace veridyn::muscle
