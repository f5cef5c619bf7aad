#include "veridyn/vehicle/simulation_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/error.hpp"

namespace veridyn::vehicle {
namespace {

constexpr const char* kCar = R"([subject]
kind = "vehicle"
mass = 1480
unsprung_mass = 38
a = 1.14
b = 1.50
track = 1.53
cg_height = 0.55
I_x = 540
I_y = 2150
I_z = 2350
C_f = 58000
C_r = 65000
K_s = 19000
C_s = 1650
K_t = 210000
mu = 0.9
)";

SimulationStudy read(const std::string& more, const std::string& subject = kCar) {
  const Study study = Study::parse(subject + more, "study.toml");
  SimulationStudy out = read_simulation_study(study.root(), Progress());
  study.root().finish();
  return out;
}

SimulationRun drive(const std::string& more, const std::string& subject = kCar) {
  const SimulationStudy study = read(more, subject);
  Progress silent;
  return run_simulation_study(study, silent);
}

TEST(SimulationStudy, BothAxlesTakeOneKeyAndOwnKeysWin) {
  const SimulationStudy s = read("K_sr = 21000\n[drive]\nspeed = 20\n");
  EXPECT_EQ(s.vehicle.parameters.K_sf, 19000.0);
  EXPECT_EQ(s.vehicle.parameters.K_sr, 21000.0);
  EXPECT_EQ(s.vehicle.parameters.track_r, 1.53);
  EXPECT_TRUE(s.vehicle.assumed.empty());
}

TEST(SimulationStudy, ABicycleNeedsNoSuspensionAndSaysWhatItAssumed) {
  const std::string bare =
      "[subject]\nkind = \"vehicle\"\nmass = 1000\na = 1.1\nb = 1.4\nI_z = 1500\nC_f = 5e4\nC_r = 5e4\n";
  EXPECT_EQ(read("[drive]\nmodel = \"bicycle\"\nspeed = 20\n", bare).vehicle.assumed.size(), 12u);
  EXPECT_THROW(static_cast<void>(read("[drive]\nspeed = 20\n", bare)), InputError);
}

TEST(SimulationStudy, TyresAreThoseOfTheirWords) {
  EXPECT_TRUE(std::holds_alternative<AxleTyres<LinearTyre<double>>>(read("[drive]\nspeed = 20\n").vehicle.tyres));
  EXPECT_TRUE(std::holds_alternative<AxleTyres<FialaTyre<double>>>(
      read("tyre = \"fiala\"\n[drive]\nspeed = 20\n").vehicle.tyres));
  EXPECT_TRUE(std::holds_alternative<AxleTyres<SimpleMagicFormulaTyre<double>>>(
      read("tyre = \"magic formula\"\n[drive]\nspeed = 20\n").vehicle.tyres));
  const std::string slick(kCar);
  EXPECT_THROW(static_cast<void>(read("tyre = \"fiala\"\n[drive]\nspeed = 20\n", slick.substr(0, slick.find("mu =")))),
               InputError);
}

// Whatever the tyre, small slip is the same: all have the stiffness of the study.
TEST(SimulationStudy, AllTyresAgreeInGentleDriving) {
  const std::string gentle =
      "[drive]\nmodel = \"bicycle\"\nspeed = 20\nmanoeuvre = \"step steer\"\namplitude = 1e-4\nduration = 3\n";
  const double linear = drive(gentle).trajectory.r.back();
  for (const char* tyre : {"fiala", "magic formula"}) {
    const double r = drive(std::string("tyre = \"") + tyre + "\"\n" + gentle).trajectory.r.back();
    EXPECT_NEAR(r / linear, 1.0, 1e-3) << tyre;
  }
}

// The friction limit: no more lateral acceleration than mu g, up to the share of drag that the front wheels turn away.
TEST(SimulationStudy, FrictionLimitsTheLateralAcceleration) {
  const SimulationRun run = drive(
      "tyre = \"fiala\"\n[drive]\nmodel = \"bicycle\"\nspeed = 30\nmanoeuvre = \"step steer\"\namplitude = "
      "0.2\nduration = 3\n");
  const double limit = 0.9 * 9.80665;
  for (const double a : run.trajectory.lateral_acceleration) EXPECT_LE(std::abs(a), limit * (1.0 + 1e-9));
  EXPECT_GT(std::abs(run.trajectory.lateral_acceleration.back()), 0.8 * limit);
}

// With a share g of the stiffness the linear car is one with g C: steady yaw rate in closed form.
TEST(SimulationStudy, AfterAChangeOfGripTheCarIsTheSlipperyOne) {
  const SimulationRun run = drive(
      "[drive]\nmodel = \"linear bicycle\"\nspeed = 20\nmanoeuvre = \"step steer\"\namplitude = 0.02\nduration = 20\n"
      "[[drive.change]]\ntime = 10\ngrip = 0.5\n");
  const auto steady = [](double grip) {
    const double K = 1480.0 * (1.50 / (grip * 58000.0) - 1.14 / (grip * 65000.0)) / (2.0 * 2.64);
    return 20.0 * 0.02 / (2.64 + K * 400.0);
  };
  EXPECT_NEAR(run.trajectory.r[999], steady(1.0), 1e-9);
  EXPECT_NEAR(run.trajectory.r.back(), steady(0.5), 1e-9);
}

TEST(SimulationStudy, WrittenVehicleReadsBackToTheSameNumbers) {
  const SimulationStudy one = read("tyre = \"fiala\"\n[drive]\nspeed = 20\n");
  const SimulationStudy two = read("[drive]\nspeed = 20\n", write_vehicle_toml(one.vehicle));
  for (std::size_t i = 0; i < kVehicleFields.size(); ++i)
    EXPECT_EQ(field_of(one.vehicle.parameters, i), field_of(two.vehicle.parameters, i)) << kVehicleFields[i].name;
  EXPECT_EQ(two.vehicle.tyre_text, "fiala");
}

}  // namespace
}  // namespace veridyn::vehicle
