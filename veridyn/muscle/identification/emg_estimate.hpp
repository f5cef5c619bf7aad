#pragma once

#include <memory>
#include <vector>

#include "veridyn/estimation/output_error/input_error_model.hpp"
#include "veridyn/estimation/output_error/model_view.hpp"
#include "veridyn/muscle/identification/emg_driven_model.hpp"
#include "veridyn/muscle/identification/task_estimate.hpp"

namespace veridyn::muscle {

/// View of an `EmgDrivenModel`, or of a view of one, which must outlive it: its outputs y(theta, c) - H c where errors
/// c of the EMG are about the values that are given, so that z - y = nu + H c holds to first order about these.
class AboutEmgErrors final : public estimation::ModelView {
 public:
  /// By segment the errors [standard deviations], and H times them, samples x outputs.
  AboutEmgErrors(const estimation::ParametricModel& model, std::vector<Eigen::VectorXd> errors,
                 std::vector<estimation::RowMatrix> shift);
  [[nodiscard]] bool respond(std::size_t segment, const Eigen::VectorXd& theta, std::span<const Eigen::Index> active,
                             estimation::ModelResponse& response) const override;
  /// The same about another view of the model.
  [[nodiscard]] AboutEmgErrors on(const estimation::ParametricModel& model) const { return {model, errors_, shift_}; }
  [[nodiscard]] const std::vector<Eigen::VectorXd>& errors() const { return errors_; }

 private:
  std::vector<Eigen::VectorXd> errors_;
  std::vector<estimation::RowMatrix> shift_;
};

/// An estimate from recorded angles, moments and EMG.
struct EmgEstimate {
  TaskEstimate estimate;            ///< its residuals are those of the whitened outputs: 1 is the noise
  Eigen::VectorXd noise;            ///< of the outputs' measurement, as stated or as found
  Eigen::VectorXd error_factors;    ///< by part of the EMG's error (`EmgErrorShape`): as found over as stated
  std::vector<double> input_share;  ///< by segment: share of the residual's variance that is the EMG's error
  // What profiles need: the outputs in units in which residuals are independent.
  std::unique_ptr<AboutEmgErrors> about;               ///< views `responses`; has the EMG's errors as found
  std::unique_ptr<estimation::InputErrorModel> model;  ///< views `about`
  std::vector<estimation::RowMatrix> measured;
};

/// The likeliest parameters together with the likeliest errors of the EMG: generalised least squares
/// (`estimate_from_tasks` on `estimation::InputErrorModel`), in which what errors of the EMG make of the moments, by
/// the model's own response to them, is part of the residual's covariance, and again about the errors that follow from
/// its residual, until parameters and errors rest. At rest this is the least of
///
///     1/2 sum (z - y(theta, c))^2/sigma^2 + 1/2 sum (c/f)^2 + priors of theta.
///
/// c in standard deviations as stated, f how many of them each part is found to have.
/// About the recorded EMG alone gains would be too low: the errors are in the model's derivatives as well as in the
/// residual (errors in variables), and activation rises faster than it falls.
/// @param responses what the search is answered by: the model, or a view of it (`estimation::LoggedModel`)
/// @param noise standard deviation by output; empty: found from the residual
[[nodiscard]] EmgEstimate estimate_from_emg(const EmgDrivenModel& model, const estimation::ParametricModel& responses,
                                            const std::vector<estimation::RowMatrix>& measured,
                                            const Eigen::VectorXd& noise, const TaskEstimateOptions& options,
                                            Progress& progress);

}  // namespace veridyn::muscle
