#pragma once

#include <optional>
#include <span>
#include <vector>

#include "veridyn/aircraft/identification/fit/coefficient_fit.hpp"
#include "veridyn/aircraft/identification/output_error/axis_output_error.hpp"

/// Inside of identification: output error as the chosen method, in place of the regression that it starts from.
namespace veridyn::aircraft::internal {

/// Of both axes: from the identification segments, and again from the hold-out, to see whether the two agree.
struct ChosenOutputError {
  std::vector<AxisOutputError> identification, holdout;
};

/// @param models  coefficients with values to start from
[[nodiscard]] ChosenOutputError fly_axes(std::span<const CoefficientModel> models, const FlightView& view,
                                         Progress& progress);

/// Puts what output error says of a coefficient in place of its regression: values, error bars, what is in the residual
/// beyond the sensors, and the checks of the choice (did the search converge, do the two methods agree). Where several
/// flights differ, error bars are no narrower than those of the scatter. Without an estimate by output error `chosen`
/// is empty, and `comparison.reason` says why.
/// @param scatter  between several flights; null: there is one
void take_output_error(CoefficientFit& fit, const ChosenOutputError& flown, const estimation::GroupScatter* scatter,
                       const FlightView& view);

/// Factors on the standard deviations that a run of output error gives for the parameters of a coefficient, as they
/// were widened since; 0 where it has none.
[[nodiscard]] Eigen::VectorXd widening_of(const CoefficientFit& fit, const ChosenOutputError& flown);

}  // namespace veridyn::aircraft::internal
