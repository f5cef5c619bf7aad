#include "veridyn/live/driver/driver_command.hpp"

#include <gtest/gtest.h>

#include "tests/support/refusal.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::live {
namespace {

TEST(DriverCommand, IsAlwaysWithinTheRange) {
  const DriverCommandOptions options;
  options.validate();
  const auto command = [&](const DriverInput& input) {
    const CarCommand result = car_command(input, options);
    EXPECT_EQ(what_is_wrong(result, options.range), "");
    return result;
  };
  EXPECT_NEAR(command({.steering = 7.854}).steering, 0.6, 1e-3);
  EXPECT_EQ(command({.steering = -20.0}).steering, -0.6);
  EXPECT_EQ(command({.throttle = 1.0}).drive_force, 100.0);
  EXPECT_EQ(command({.throttle = 1.0, .reverse = true}).drive_force, -50.0);
  EXPECT_EQ(command({.throttle = 1.0, .brake = 0.1}), (CarCommand{.brake = 0.1}));
  // NaN stays NaN: the operator's end does not send it.
  EXPECT_EQ(what_is_wrong(car_command({.brake = kNaN}, options), options.range), "brake");
  EXPECT_EQ(why([] { DriverCommandOptions{.steering_ratio = 0.0}.validate(); }), "steering_ratio: is 0; must be > 0");
  EXPECT_EQ(why([] { DriverCommandOptions{.reverse_share = kNaN}.validate(); }),
            "reverse_share: is nan; must be from 0 to 1");
}

}  // namespace
}  // namespace veridyn::live
