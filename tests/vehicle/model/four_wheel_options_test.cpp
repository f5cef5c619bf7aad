#include "veridyn/vehicle/model/four_wheel_options.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/support/refusal.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::vehicle {
namespace {

TEST(FourWheelOptions, NamesOptionsThatMakeNoSense) {
  const auto message = [](const FourWheelOptions& options) {
    try {
      options.validate();
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(message({}), "");
  EXPECT_EQ(message({.gravity = std::nan("")}), "vehicle: gravity is nan; must be >= 0");
  EXPECT_EQ(message({.ackermann = 1.5}), "vehicle: ackermann is 1.5; must be between 0 (parallel) and 1");
  EXPECT_EQ(message({.relaxation_length = -1.0}), "vehicle: relaxation_length is -1; must be >= 0");
  EXPECT_EQ(message({.longitudinal = LongitudinalParameters{.wheel_inertia = 0.0}}),
            "vehicle: wheel_inertia is 0; must be > 0");
  EXPECT_EQ(message({.longitudinal = LongitudinalParameters{.grade = 1.0}}),
            "vehicle: grade is 1 rad; must be between -0.5 and 0.5");
  EXPECT_EQ(message({.longitudinal = LongitudinalParameters{.front_brake_share = 1.1}}),
            "vehicle: front_brake_share is 1.1; must be between 0 and 1");
}

TEST(FourWheelOptions, TheSourcesConventionKnowsSpringsOnly) {
  FourWheelOptions source{.convention = FourWheelConvention::kSource};
  source.suspension_f.spring = SpringCurve({-0.1, 0.1}, {-2000.0, 2000.0});
  source.validate();
  const auto refused = [&](const auto& change) {
    FourWheelOptions options = source;
    change(options);
    return why([&] { options.validate(); }).find("they need convention = \"first principles\"") != std::string::npos;
  };
  EXPECT_TRUE(refused([](FourWheelOptions& o) { o.suspension_r.roll_centre = 0.1; }));
  EXPECT_TRUE(refused([](FourWheelOptions& o) { o.suspension_f.bump_steer = 0.1; }));
  EXPECT_TRUE(refused([](FourWheelOptions& o) { o.lift.area_f = 0.1; }));
  EXPECT_TRUE(refused([](FourWheelOptions& o) { o.aligning_moment = true; }));
}

}  // namespace
}  // namespace veridyn::vehicle
