#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"
#include "veridyn/vehicle/identification/fit/axle_estimate.hpp"
#include "veridyn/vehicle/identification/fit/drive_parametric_model.hpp"
#include "veridyn/vehicle/identification/fit/vehicle_estimate.hpp"
#include "veridyn/vehicle/identification/fit/vehicle_problem.hpp"

namespace veridyn::vehicle {

/// How C_f, C_r, I_z and the understeer gradient change, as shares of themselves, per metre of a and of b and with the
/// steering's scale. They enter the estimates' covariances through `[identify.uncertainty]`; 0 where that gives no
/// uncertainty.
struct GivenSlopes {
  Eigen::Vector4d a = Eigen::Vector4d::Zero();
  Eigen::Vector4d b = Eigen::Vector4d::Zero();
  Eigen::Vector4d steer_scale = Eigen::Vector4d::Zero();
};

/// Equation error by all regressions, with the vehicle's parameters that each gives.
struct EquationErrorEstimates {
  DriveRegressionResult regression;
  GivenSlopes slopes;
  std::vector<VehicleEstimate> estimates;  ///< one for each regression
};

/// Output error, with the vehicle's parameters that it gives.
struct OutputErrorResult {
  estimation::OutputErrorEstimate raw;
  VehicleEstimate estimate;
};

/// The regressions over some spans, with `known` for mass, a and b.
[[nodiscard]] DriveRegressionResult regress(const VehicleProblem& problem, std::span<const TimeSpan> spans,
                                            const VehicleParameters<double>& known);

/// All regressions over the identification segments; what `[identify.uncertainty]` adds is in the covariances.
[[nodiscard]] EquationErrorEstimates estimate_by_equation_error(const VehicleProblem& problem);

/// How far a search goes.
enum class SearchEffort {
  kToCompare,  ///< a few steps: enough to distinguish structures
  kToTheEnd    ///< and fitted again with another scale of the steering, of which a standard deviation is given
};

/// Starts from the equation error where that is known well enough; `equation_error` may be null. `search_start`: of all
/// DriveUnknowns, where the search begins instead; may be empty.
[[nodiscard]] OutputErrorResult estimate_by_output_error(const VehicleProblem& problem,
                                                         const EquationErrorEstimates* equation_error,
                                                         const Eigen::VectorXd& search_start, SearchEffort effort,
                                                         Progress& progress);

/// The drive's model, begun where the equation error is known well enough, and how it is fitted.
struct OutputErrorProblem {
  DriveParametricModel model;
  estimation::OutputErrorOptions options;
  /// Where the search begins: `theta` within the bounds, with what noise of the steering gives the outputs there.
  void begin_at(const Eigen::VectorXd& theta);
};
/// Output error over some spans of a drive, from where `here` ended, which fitted the same vehicle to something close:
/// a few steps of Gauss-Newton are as good as all (Le Cam's one-step estimator), and where they are not, few show it.
/// Nothing where it does not end. @param longest_memory_s  of residuals that are correlated
[[nodiscard]] std::optional<estimation::OutputErrorEstimate> fitted_again(const VehicleProblem& problem,
                                                                          std::span<const TimeSpan> spans,
                                                                          const DriveModelOptions& model,
                                                                          const estimation::OutputErrorEstimate& here,
                                                                          double longest_memory_s, Progress& progress);

/// The output-error problem of a drive; `equation_error` may be null, `search_factor` as of DriveModelOptions.
[[nodiscard]] OutputErrorProblem output_error_problem(const VehicleProblem& problem,
                                                      const EquationErrorEstimates* equation_error,
                                                      double search_factor = 1e3);
/// Values at which a search of the model may begin: of what is free those of `theta`, the rest at its start.
[[nodiscard]] Eigen::VectorXd within_bounds(const DriveParametricModel& model, Eigen::VectorXd theta);

/// The parameters of the start, all of them not excited; `reason` is its message.
[[nodiscard]] VehicleEstimate unexcited_estimate(const VehicleProblem& problem, std::string reason);

/// As VehicleIdentifyOptions::method describes; kNone when no method gave an estimate. `regression` may be null.
[[nodiscard]] VehicleMethod choose_method(std::span<const VehicleEstimate> estimates,
                                          const DriveRegressionResult* regression,
                                          std::optional<VehicleMethod> desired);

}  // namespace veridyn::vehicle
