#include "veridyn/vehicle/model/vehicle_parameters.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace veridyn::vehicle {
namespace {

TEST(VehicleParameters, StaticLoadsCarryTheWeightAndBalanceAboutTheCentreOfGravity) {
  const VehicleParameters<double> p;
  const PerWheel<double> load = static_loads(p, 9.80665);
  EXPECT_NEAR(load[0] + load[1] + load[2] + load[3], p.mass * 9.80665, 1e-9);
  EXPECT_NEAR(p.a * (load[0] + load[1]), p.b * (load[2] + load[3]), 1e-9);
}

TEST(VehicleParameters, NoFieldIsNamedTwiceOrPointsToAnothersNumber) {
  VehicleParameters<double> p;
  for (std::size_t i = 0; i < kVehicleFields.size(); ++i) field_of(p, i) = static_cast<double>(i);
  for (std::size_t i = 0; i < kVehicleFields.size(); ++i) {
    EXPECT_EQ(field_of(p, i), static_cast<double>(i)) << kVehicleFields[i].name;
    for (std::size_t j = 0; j < i; ++j) EXPECT_STRNE(kVehicleFields[i].name, kVehicleFields[j].name);
  }
}

TEST(VehicleParameters, EveryNumberThatNoVehicleHasIsNamed) {
  const auto with = [](std::size_t field, double value) {
    VehicleParameters<double> p;
    field_of(p, field) = value;
    return inadmissible(p);
  };
  EXPECT_EQ(inadmissible(VehicleParameters<double>{}), "");
  for (std::size_t i = 0; i < kVehicleFields.size(); ++i) {
    const std::string name = kVehicleFields[i].name;
    EXPECT_TRUE(with(i, -1.0).starts_with(name)) << with(i, -1.0);
    EXPECT_TRUE(with(i, std::numeric_limits<double>::quiet_NaN()).starts_with(name));
  }
  EXPECT_EQ(with(4, 0.0), "track_f is 0 m; must be > 0");
  EXPECT_EQ(with(10, -5.0), "C_f is -5 N/rad; must be > 0");
  EXPECT_EQ(with(0, std::numeric_limits<double>::infinity()), "mass is infinite");
  EXPECT_EQ(with(1, 300.0), "unsprung_mass is 300 kg a wheel; four must be lighter than the vehicle's mass of 1100 kg");
}

}  // namespace
}  // namespace veridyn::vehicle
