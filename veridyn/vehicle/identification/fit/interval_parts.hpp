#pragma once

#include "veridyn/estimation/output_error/output_error.hpp"
#include "veridyn/vehicle/identification/options/drive_unknown.hpp"

namespace veridyn::vehicle {

/// Standard deviations that an unknown's is made of [its unit], before parts of the drive are compared.
struct IntervalParts {
  double by_noise = 0.0;   ///< of sensors and the road, autocorrelated as the residual is
  double by_budget = 0.0;  ///< what is left open of `kDriveBudget`: it would go if those were known exactly
  double by_model = 0.0;   ///< what the model lacks
};

/// Of an estimate that has the unknown free.
[[nodiscard]] IntervalParts interval_parts(const estimation::OutputErrorEstimate& estimate, DriveUnknown unknown);

}  // namespace veridyn::vehicle
