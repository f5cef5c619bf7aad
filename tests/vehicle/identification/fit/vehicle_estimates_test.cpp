#include "veridyn/vehicle/identification/fit/vehicle_estimates.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/vehicle/identification/identified_drive.hpp"

namespace veridyn::vehicle {
namespace {

using testing::family_car;
using testing::identify;
using testing::lively_drive;

TEST(VehicleIdentification, UncertaintyOfTheMassGoesIntoTheErrorBars) {
  const VehicleParameters<double> p = family_car();
  VehicleIdentifyOptions options{.output_error = false};
  const VehicleTrajectory drive = lively_drive(p, 1);
  const VehicleIdentification sure = identify(drive, reference_drive_sensors(), 1, options);
  options.given.mass = 75.0;
  const VehicleIdentification unsure = identify(drive, reference_drive_sensors(), 1, options);
  const auto* a = sure.find(VehicleMethod::kGtls)->find("C_f");
  const auto* b = unsure.find(VehicleMethod::kGtls)->find("C_f");
  EXPECT_NEAR(b->sigma, std::hypot(a->sigma, 0.05 * a->value), 1e-6 * b->sigma);
  // The understeer gradient is a ratio of motions: the mass cancels.
  EXPECT_NEAR(unsure.find(VehicleMethod::kGtls)->find("understeer_gradient")->sigma,
              sure.find(VehicleMethod::kGtls)->find("understeer_gradient")->sigma, 1e-12);
}

VehicleEstimate estimate_by(VehicleMethod method) {
  VehicleEstimate e;
  e.method = method;
  e.usable = true;
  return e;
}

TEST(ChooseMethod, TakesOutputErrorBeforeTheRegressionThatIsRecommended) {
  std::vector<VehicleEstimate> all{estimate_by(VehicleMethod::kOls), estimate_by(VehicleMethod::kGtls),
                                   estimate_by(VehicleMethod::kOutputError)};
  DriveRegressionResult regression;
  regression.recommends = true;
  regression.recommended = estimation::Method::kOls;
  EXPECT_EQ(choose_method(all, &regression, {}), VehicleMethod::kOutputError);
  EXPECT_EQ(choose_method(all, &regression, VehicleMethod::kGtls), VehicleMethod::kGtls);
  all.back().usable = false;
  EXPECT_EQ(choose_method(all, &regression, {}), VehicleMethod::kOls);
  EXPECT_EQ(choose_method(all, &regression, VehicleMethod::kOutputError), VehicleMethod::kNone);
  regression.recommends = false;
  EXPECT_EQ(choose_method(all, &regression, {}), VehicleMethod::kGtls);
  EXPECT_EQ(choose_method(all, nullptr, {}), VehicleMethod::kNone);
}

TEST(ChooseMethod, KeepsTheUndersteerGradientOfSteadyCornering) {
  VehicleEstimate none = estimate_by(VehicleMethod::kPcaGtls);
  none.usable = false;
  DriveRegressionResult regression;
  regression.axles.resize(1);
  AxleEstimate& axle = regression.axles.front();
  axle.method = estimation::Method::kPcaGtls;
  axle.understeer_only = true;
  axle.understeer_sigma = 1e-4;
  EXPECT_EQ(choose_method({&none, 1}, &regression, {}), VehicleMethod::kPcaGtls);
  axle.understeer_sigma = std::numeric_limits<double>::infinity();
  EXPECT_EQ(choose_method({&none, 1}, &regression, {}), VehicleMethod::kNone);
}

}  // namespace
}  // namespace veridyn::vehicle
