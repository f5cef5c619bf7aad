#include "veridyn/vehicle/identification/fit/vehicle_estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace veridyn::vehicle {
namespace {

estimation::Parameter parameter(double value, double sigma) {
  estimation::Parameter p;
  p.value = value;
  p.sigma = sigma;
  estimation::set_interval(p, 1e6);
  p.status = estimation::ParameterStatus::kIdentified;
  return p;
}

// A variance that has grown ninefold triples the interval about the same value; one that is not known stays so.
TEST(VehicleEstimate, IntervalsFollowACovarianceThatHasGrown) {
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  VehicleEstimate estimate{.parameters = {parameter(10.0, 1.0), parameter(3.0, 1.0), parameter(5.0, kUnknown)},
                           .degrees_of_freedom = 1e6};
  estimate.covariance = Eigen::Vector3d(1.0, 1.0, kUnknown).asDiagonal();
  Eigen::MatrixXd grown = estimate.covariance;
  grown(0, 0) = 1.5 * 1.5;
  grown(1, 1) = 9.0;
  const VehicleEstimate wide = with_covariance(estimate, grown, 0.05);
  EXPECT_EQ(wide.covariance, grown);
  EXPECT_NEAR(wide.parameters[0].sigma, 1.5, 1e-12);
  EXPECT_NEAR(wide.parameters[0].high95, 10.0 + 1.5 * 1.959964, 1e-4);
  EXPECT_EQ(wide.parameters[0].status, estimation::ParameterStatus::kIdentified);
  EXPECT_NEAR(wide.parameters[1].low95, 3.0 - 3.0 * 1.959964, 1e-4);
  EXPECT_EQ(wide.parameters[1].status, estimation::ParameterStatus::kInsignificant);
  EXPECT_EQ(wide.parameters[2].sigma, kUnknown);
}

}  // namespace
}  // namespace veridyn::vehicle
