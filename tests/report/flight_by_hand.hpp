#pragma once

#include "veridyn/aircraft/aircraft_study.hpp"

namespace veridyn::report::test {

/// An identified Cm of two parameters by GTLS, with what the report says of it.
inline aircraft::CoefficientResult pitch_by_hand() {
  aircraft::CoefficientResult r;
  r.coefficient = aircraft::Coefficient::kCm;
  r.name = "Cm";
  r.verdict = estimation::GroupVerdict::kIdentified;
  r.reason = "Cm explains 97 % of the hold-out";
  estimation::RegressionEstimate chosen;
  chosen.method = estimation::Method::kGtls;
  chosen.termination = estimation::EstimateTermination::kEstimated;
  chosen.parameters = {{.name = "Cm_alpha",
                        .value = -0.7312,
                        .sigma = 0.0123,
                        .low95 = -0.7553,
                        .high95 = -0.7071,
                        .unit = "1/rad",
                        .status = estimation::ParameterStatus::kIdentified},
                       {.name = "Cm_de",
                        .value = -1.1,
                        .sigma = 0.02,
                        .low95 = -1.1392,
                        .high95 = -1.0608,
                        .unit = "1/rad",
                        .status = estimation::ParameterStatus::kIdentified}};
  chosen.covariance.resize(2, 2);
  chosen.covariance << 4.0, 3.0, 3.0, 9.0;
  r.chosen = chosen;
  r.method = estimation::to_string(chosen.method);
  r.identification_fit = {.r2 = 0.98, .theil = 0.02, .count = 500};
  r.holdout_fit = {.r2 = 0.971, .theil = 0.0312, .count = 200};
  r.error_ratio = 1.25;
  return r;
}

/// A coefficient of which nothing was estimated.
inline aircraft::CoefficientResult drag_by_hand() {
  aircraft::CoefficientResult r;
  r.coefficient = aircraft::Coefficient::kCD;
  r.name = "CD";
  r.verdict = estimation::GroupVerdict::kSkipped;
  r.reason = "CD needs the thrust";
  return r;
}

}  // namespace veridyn::report::test
