#include "veridyn/vehicle/identification/fit/vehicle_profiles.hpp"

#include <algorithm>
#include <cmath>

namespace veridyn::vehicle {
namespace {

/// By parameter: its corrected variance over the white one. What has no error bar has that of the worst.
std::vector<double> inflations(const estimation::OutputErrorEstimate& estimate, double widening) {
  double most = 1.0;
  std::vector<double> ratio;
  for (const estimation::Parameter& p : estimate.parameters) {
    const double q = std::pow(p.sigma / p.sigma_white, 2);
    ratio.push_back(std::isfinite(q) && p.sigma > 0.0 ? std::max(1.0, q) : kNaN);
    if (std::isfinite(ratio.back())) most = std::max(most, ratio.back());
  }
  for (double& q : ratio) q = std::max(1.0, widening) * (std::isfinite(q) ? q : most);
  return ratio;
}

/// How far the bounds have to be from the start, for the estimate to lie well within them.
double search_factor(const VehicleProblem& problem, const EquationErrorEstimates* equation_error,
                     const estimation::OutputErrorEstimate& estimate) {
  const OutputErrorProblem as_given = output_error_problem(problem, equation_error);
  double off = 1.0;
  for (const DriveUnknown u : {DriveUnknown::kCf, DriveUnknown::kCr, DriveUnknown::kIz}) {
    const auto i = static_cast<std::size_t>(u);
    const double q = estimate.theta(static_cast<Eigen::Index>(i)) / as_given.model.parameters()[i].start;
    if (q > 0.0 && std::isfinite(q)) off = std::max(off, std::max(q, 1.0 / q));
  }
  return std::min(1e3, kProfileReach * off);
}

}  // namespace

estimation::ProfileResult profile_drive(const VehicleProblem& problem, const EquationErrorEstimates* equation_error,
                                        const OutputErrorResult& output_error, double widening, Progress& progress) {
  if (!output_error.raw.usable()) {
    estimation::ProfileResult none;
    none.message = "no profile: output error gave no estimate";
    return none;
  }
  const double factor = search_factor(problem, equation_error, output_error.raw);
  OutputErrorProblem given = output_error_problem(problem, equation_error, factor);
  given.begin_at(output_error.raw.theta);
  estimation::ProfileOptions options;
  options.output_error = given.options;
  // Statistics to about 1e-3: steps in a valley that gain less are not worth their simulations.
  options.output_error.tolerance = 0.05;
  options.inflation = inflations(output_error.raw, widening);
  std::vector<std::size_t> which;
  for (const std::string& name : problem.options.profiles) {
    const auto at = std::ranges::find(kDriveUnknownNames, name);
    which.push_back(static_cast<std::size_t>(at - kDriveUnknownNames.begin()));
  }
  return estimation::profile_likelihood(given.model, given.model.measured(), output_error.raw, which, options,
                                        progress);
}

}  // namespace veridyn::vehicle
