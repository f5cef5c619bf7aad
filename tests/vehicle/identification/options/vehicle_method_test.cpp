#include "veridyn/vehicle/identification/options/vehicle_method.hpp"

#include <gtest/gtest.h>

namespace veridyn::vehicle {
namespace {

TEST(VehicleMethod, NamesAreThoseOfTheStudy) {
  for (const std::string_view name : kVehicleMethodNames) EXPECT_EQ(to_string(vehicle_method(name)), name);
  EXPECT_EQ(vehicle_method("on line"), VehicleMethod::kGiven);
  EXPECT_EQ(vehicle_method(estimation::Method::kPcaGtls), VehicleMethod::kPcaGtls);
}

}  // namespace
}  // namespace veridyn::vehicle
