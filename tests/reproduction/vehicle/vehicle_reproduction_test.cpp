#include "bench/reproduction/vehicle/vehicle_reproduction.hpp"

#include <gtest/gtest.h>

#include <string>

#include "veridyn/core/error.hpp"

namespace veridyn::vehicle {
namespace {

TEST(VehicleReproduction, ANumberThatIsNotMetFailsItsCheck) {
  const std::string text =
      "[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n[drive]\nmodel = \"linear bicycle\"\n"
      "[scale]\nlength_ratio = 0.2\nmass = 8.8\nspeed = 4\n[[published]]\nquantity = \"yaw_rate\"\ntime = 10\n";
  Progress silent;
  const auto passed = [&](const std::string& value) {
    const Study study = Study::parse(text + "value = \"" + value + "\"\n", "row.toml");
    return reproduce_vehicle(study.root(), silent).passed();
  };
  EXPECT_TRUE(passed("34.9515 deg/s"));
  EXPECT_TRUE(passed("35.0 deg/s"));
  EXPECT_FALSE(passed("34.9516 deg/s"));
  EXPECT_THROW(static_cast<void>(passed("35 m/s")), InputError);
}

}  // namespace
}  // namespace veridyn::vehicle
