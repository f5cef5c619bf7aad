#include "veridyn/vehicle/identification/fit/interval_parts.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

namespace veridyn::vehicle {
namespace {

// With an unknown of variance s^2 that moves another by k, the other has k^2 s^2 of its variance from it.
TEST(IntervalParts, OfTheBudgetAreWhatWouldGoIfItWereKnown) {
  constexpr auto kI = static_cast<Eigen::Index>(DriveUnknown::kIz),
                 kD = static_cast<Eigen::Index>(DriveUnknown::kSteerDelay);
  estimation::OutputErrorEstimate e;
  e.covariance = e.covariance_by_model = Eigen::MatrixXd::Zero(kDriveUnknowns, kDriveUnknowns);
  const double noise = 10.0, slope = 3e4, delay = 0.002;
  e.covariance(kI, kI) = noise * noise + std::pow(slope * delay, 2);
  e.covariance(kI, kD) = e.covariance(kD, kI) = slope * delay * delay;
  e.covariance(kD, kD) = delay * delay;
  e.covariance_by_model(kI, kI) = 49.0;
  const IntervalParts parts = interval_parts(e, DriveUnknown::kIz);
  EXPECT_NEAR(parts.by_noise, noise, 1e-9);
  EXPECT_NEAR(parts.by_budget, slope * delay, 1e-9);
  EXPECT_NEAR(parts.by_model, 7.0, 1e-12);
  EXPECT_NEAR(interval_parts(e, DriveUnknown::kSteerDelay).by_noise, delay, 1e-12) << "it is no error of its own";
}

}  // namespace
}  // namespace veridyn::vehicle
