#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "veridyn/aircraft/reconstruction/observability.hpp"

namespace veridyn::aircraft {

/// What a flight determines of a constant error of a sensor (data compatibility; Klein & Morelli 2006, chapter 10), and
/// how much of it is information and how much the assumption beforehand.
struct SensorErrorReport {
  std::string name;  ///< "alpha_bias", "accel_scale_x"
  std::string unit;  ///< rad, rad/s, m/s^2, Pa, 1
  double value = 0.0;
  double prior_sigma = 0.0;  ///< assumed beforehand, about 0
  double sigma = 0.0;        ///< afterwards
  /// Share of the information afterwards that comes from the flight: 1 - (sigma / prior)^2.
  double information = 0.0;
  /// The other estimated error that it is most correlated with (of sensors or of the force model), and how much: near
  /// +-1 only a combination of the two is determined.
  double correlation = 0.0;
  std::string correlated_with;  ///< empty when it is the only one
  Observability observability = Observability::kNotObservable;
  std::string statement;  ///< one sentence
};

/// One error's numbers before they are judged.
struct SensorErrorEstimate {
  std::string name;
  std::string unit;
  double value = 0.0;
  double prior_sigma = 0.0;
  double sigma = 0.0;
};

/// Verdicts: below 0.35 of the prior observable, below 0.8 weakly observable, else not observable (kept at its prior).
/// `covariance` in the order of `errors`.
[[nodiscard]] std::vector<SensorErrorReport> judge_sensor_errors(const std::vector<SensorErrorEstimate>& errors,
                                                                 const Eigen::MatrixXd& covariance);

}  // namespace veridyn::aircraft
