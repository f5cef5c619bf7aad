// Nothing between the vehicle and the platform allocates once it is made.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/counting_new.hpp"
#include "veridyn/cueing/chain/cueing_chain.hpp"
#include "veridyn/cueing/washout/driver_foresight.hpp"
#include "veridyn/cueing/washout/lap_foresight.hpp"
#include "veridyn/cueing/washout/predictive_washout.hpp"
#include "veridyn/cueing/washout/washout_design.hpp"

namespace veridyn::cueing {
namespace {

TEST(CueingChain, DoesNotAllocateWithAnyAlgorithm) {
  for (const char* name : {"three_axis", "hexapod"}) {
    const Platform& platform = built_in_platform(name);
    for (const WashoutAlgorithm& a : washout_algorithms()) {
      CueingChain chain(a.design()->make(platform), platform);
      recording::MotionSample s;
      s.frame = Frame::kFlu;
      s.force = recording::force_at_rest(Frame::kFlu);
      chain.reset(s);
      double sum = 0.0;
      const long before = allocations.load();
      for (int k = 0; k < 500; ++k) {
        s.force.x() = 6.0 * std::sin(0.05 * k);
        s.force.y() = 8.0 * std::cos(0.03 * k);
        s.rate.z() = 0.4 * std::sin(0.03 * k);
        sum += chain.step(s, k % 3 == 0 ? 0.007 : 0.021).reached.angle.x();
      }
      EXPECT_EQ(allocations.load(), before) << a.name << " on " << name;
      EXPECT_TRUE(std::isfinite(sum));
    }
  }
}

TEST(PredictiveWashout, DoesNotAllocateWhereItForesees) {
  recording::MotionSample s;
  s.frame = Frame::kFlu;
  s.force = recording::force_at_rest(Frame::kFlu);
  s.position_from = s.speed_from = s.steer_from = recording::Origin::kMeasured;
  s.speed = 20.0;
  const auto drive_on = [&s] {
    s.time += 0.01;
    s.position.x() = 20.0 * s.time;
    s.force.y() = 3.0 * std::sin(s.time);
    s.inputs.steer = 0.03 * std::sin(s.time);
  };
  std::vector<recording::MotionSample> lap;
  for (int k = 0; k < 2000; ++k) {
    lap.push_back(s);
    drive_on();
  }
  const vehicle::Vehicle car = vehicle::read_vehicle(
      Study::parse("[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n", "car.toml").root().table("subject"),
      vehicle::VehicleNeeds::kFourWheel);
  const LapForesight by_lap(lap);
  const DriverForesight by_driver(car);
  const Platform& platform = built_in_platform("three_axis");
  for (const Foresight* foresight :
       {static_cast<const Foresight*>(&by_lap), static_cast<const Foresight*>(&by_driver)}) {
    PredictiveDesign design;
    design.foresee_from(*foresight);
    CueingChain chain(design.make(platform), platform);
    s.time = 0.0;
    chain.reset(s);
    const long before = allocations.load();
    for (int k = 0; k < 1000; ++k) {
      drive_on();
      chain.step(s, 0.01);
    }
    EXPECT_EQ(allocations.load(), before) << foresight->from();
    EXPECT_NE(chain.washout().account().find(foresight->from() + " foresaw"), std::string::npos);
  }
}

}  // namespace
}  // namespace veridyn::cueing
