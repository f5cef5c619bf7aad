#include "veridyn/vehicle/model/vehicle.hpp"

#include <gtest/gtest.h>

#include <string>
#include <variant>

#include "tests/vehicle/described_car.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::vehicle {
namespace {

using testing::kCar;
using testing::read_drive_study;

TEST(SimulationStudy, BothAxlesTakeOneKeyAndOwnKeysWin) {
  const SimulationStudy s = read_drive_study("K_sr = 21000\n[drive]\nspeed = 20\n");
  EXPECT_EQ(s.vehicle.parameters.K_sf, 19000.0);
  EXPECT_EQ(s.vehicle.parameters.K_sr, 21000.0);
  EXPECT_EQ(s.vehicle.parameters.track_r, 1.53);
  EXPECT_TRUE(s.vehicle.assumed.empty());
}

TEST(SimulationStudy, ABicycleNeedsNoSuspensionAndSaysWhatItAssumed) {
  const std::string bare =
      "[subject]\nkind = \"vehicle\"\nmass = 1000\na = 1.1\nb = 1.4\nI_z = 1500\nC_f = 5e4\nC_r = 5e4\n";
  EXPECT_EQ(read_drive_study("[drive]\nmodel = \"bicycle\"\nspeed = 20\n", bare).vehicle.assumed.size(), 12u);
  EXPECT_THROW(static_cast<void>(read_drive_study("[drive]\nspeed = 20\n", bare)), InputError);
}

TEST(SimulationStudy, TyresAreThoseOfTheirWords) {
  EXPECT_TRUE(
      std::holds_alternative<AxleTyres<LinearTyre<double>>>(read_drive_study("[drive]\nspeed = 20\n").vehicle.tyres));
  EXPECT_TRUE(std::holds_alternative<AxleTyres<FialaTyre<double>>>(
      read_drive_study("tyre = \"fiala\"\n[drive]\nspeed = 20\n").vehicle.tyres));
  EXPECT_TRUE(std::holds_alternative<AxleTyres<SimpleMagicFormulaTyre<double>>>(
      read_drive_study("tyre = \"magic formula\"\n[drive]\nspeed = 20\n").vehicle.tyres));
  const std::string slick(kCar);
  EXPECT_THROW(static_cast<void>(
                   read_drive_study("tyre = \"fiala\"\n[drive]\nspeed = 20\n", slick.substr(0, slick.find("mu =")))),
               InputError);
}

TEST(SimulationStudy, WrittenVehicleReadsBackToTheSameNumbers) {
  const SimulationStudy one = read_drive_study("tyre = \"fiala\"\n[drive]\nspeed = 20\n");
  const SimulationStudy two = read_drive_study("[drive]\nspeed = 20\n", write_vehicle_toml(one.vehicle));
  for (std::size_t i = 0; i < kVehicleFields.size(); ++i)
    EXPECT_EQ(field_of(one.vehicle.parameters, i), field_of(two.vehicle.parameters, i)) << kVehicleFields[i].name;
  EXPECT_EQ(two.vehicle.tyre_text, "fiala");
}

}  // namespace
}  // namespace veridyn::vehicle
