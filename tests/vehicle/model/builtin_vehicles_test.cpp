#include "veridyn/vehicle/model/builtin_vehicles.hpp"

#include <gtest/gtest.h>

#include "tests/support/refusal.hpp"
#include "tests/vehicle/cars.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/vehicle/model/four_wheel_analysis.hpp"

namespace veridyn::vehicle {
namespace {

// Cars on the road: 0.5 to 5 deg/g of understeer, 3 to 7 deg/g of roll.
TEST(BuiltinVehicles, TheSaloonUndersteersAndRollsAsCarsDo) {
  const BuiltinVehicle& saloon = builtin_vehicle("saloon");
  FourWheelOptions options;
  options.suspension_f = saloon.suspension_f;
  options.suspension_r = saloon.suspension_r;
  const auto car = testing::linear_car(saloon.parameters, options);
  const SteadyCornering steady = steady_cornering(linearise(car, saloon.speed), saloon.parameters.wheelbase());
  const double per_g = kGravity / kDegree;
  EXPECT_NEAR(steady.understeer_gradient * per_g, 2.7, 0.05);
  EXPECT_NEAR(steady.roll_gradient * per_g, 5.5, 0.05);
  for (const FourWheelMode& mode : modes(linearise(car, 40.0))) EXPECT_TRUE(mode.stable) << mode.name;
}

TEST(BuiltinVehicles, AreAdmissibleAndFoundByName) {
  for (const BuiltinVehicle& vehicle : builtin_vehicles()) {
    EXPECT_EQ(inadmissible(vehicle.parameters), "") << vehicle.name;
    EXPECT_EQ(&builtin_vehicle(vehicle.name), &vehicle);
    EXPECT_GT(vehicle.speed, 0.0);
  }
  EXPECT_NE(why([] { (void)builtin_vehicle("salon"); }).find("did you mean 'saloon'"), std::string::npos);
}

}  // namespace
}  // namespace veridyn::vehicle
