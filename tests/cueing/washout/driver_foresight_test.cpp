#include "veridyn/cueing/washout/driver_foresight.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::cueing {
namespace {

vehicle::Vehicle car(const char* extra = "") {
  return vehicle::read_vehicle(
      Study::parse(std::string("[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\nmu = 0.95\ntyre = \"magic "
                               "formula\"\n") +
                       extra,
                   "car.toml")
          .root()
          .table("subject"),
      vehicle::VehicleNeeds::kFourWheel);
}

std::unique_ptr<vehicle::SteppedVehicle> stepped(const vehicle::Vehicle& v, bool torques) {
  vehicle::FourWheelOptions options = vehicle::four_wheel_options(v);
  if (!torques) options.longitudinal.reset();
  return vehicle::stepped_vehicle(v, options);
}

struct MissedByTheModel {
  Eigen::Vector3d foreseen = Eigen::Vector3d::Zero(), held = Eigen::Vector3d::Zero();
};

/// Root mean squares of a drive with inputs that jump every 3 s and stay: what was foreseen 1.0 s ahead less what
/// came, where nothing jumped in between.
MissedByTheModel missed_by_model(vehicle::SteppedVehicle& truth, DriverForesight& foresight, bool torques) {
  constexpr double kStep = 0.01;
  constexpr std::size_t kAhead = 11, kLater = 100;
  const Eigen::Vector3d place(0.2, 0.35, 0.5);
  std::vector<recording::MotionSample> drive;
  truth.reset(20.0);
  std::vector<double> since;
  for (int k = 0; k < 2400; ++k) {
    const int phase = k / 300;
    vehicle::Controls c{.steer = phase % 2 == 0 ? 0.0 : (phase % 4 == 1 ? 0.03 : -0.02)};
    if (torques && phase % 3 == 1) c.brake_torque = 500.0;
    if (torques && phase % 3 == 2) c.drive_torque = 500.0;
    truth.step(c, kStep);
    drive.push_back(truth.motion(place));
    drive.back().inputs = {c.steer, c.drive_torque, c.brake_torque};
    since.push_back(kStep * (k % 300));
  }
  MissedByTheModel m;
  double compared = 0.0;
  foresight.reset();
  for (std::size_t k = 0; k + kLater < drive.size(); ++k) {
    const auto now = recording::in_frame(drive[k], Frame::kFrd),
               later = recording::in_frame(drive[k + kLater], Frame::kFrd);
    Foreseen f;
    EXPECT_TRUE(foresight.look(now, k == 0 ? 0.0 : kStep, f));
    if (since[k] + kStep * kLater > 2.995 || k < 300) continue;
    m.foreseen += (f.then[kAhead] + now.force - f.now - later.force).cwiseAbs2();
    m.held += (now.force - later.force).cwiseAbs2();
    ++compared;
  }
  m.foreseen = (m.foreseen / compared).cwiseSqrt();
  m.held = (m.held / compared).cwiseSqrt();
  return m;
}

TEST(DriverForesight, KnowsWhatSteeringAndPedalsThatAreHeldWillDo) {
  for (const bool torques : {false, true}) {
    const vehicle::Vehicle v = car();
    const auto truth = stepped(v, torques);
    DriverForesight foresight(v);
    const MissedByTheModel m = missed_by_model(*truth, foresight, torques);
    EXPECT_GT(m.held.y(), 0.5);
    EXPECT_LT(m.foreseen.y(), (torques ? 0.12 : 0.02) * m.held.y());
  }
}

TEST(DriverForesight, KnowsThatBrakingEndsWhereTheVehicleStands) {
  const vehicle::Vehicle v = car();
  const auto truth = stepped(v, true);
  DriverForesight foresight(v);
  foresight.reset();
  truth->reset(8.0);
  std::vector<double> came, foreseen;
  for (int k = 0; k < 700; ++k) {
    const vehicle::Controls c{.brake_torque = k > 50 ? 800.0 : 0.0};
    truth->step(c, 0.01);
    const auto now = recording::in_frame(truth->motion(Eigen::Vector3d::Zero()), Frame::kFrd);
    Foreseen f;
    EXPECT_TRUE(foresight.look(now, k == 0 ? 0.0 : 0.01, f));
    came.push_back(now.force.x());
    foreseen.push_back(f.then[11].x());
  }
  // It stops after 3.4 s; the body then rocks on its springs.
  EXPECT_LT(came[360], -2.0);
  for (std::size_t k = 60; k < 225; ++k) EXPECT_NEAR(foreseen[k], came[k + 100], 0.5) << k;
  for (std::size_t k = 300; k < 360; ++k) EXPECT_NEAR(foreseen[k], 0.0, 0.02) << k;
  for (std::size_t k = 560; k < 700; ++k) EXPECT_NEAR(came[k], 0.0, 0.1) << k;
}

TEST(DriverForesight, OfAnotherCarIsStillBetterThanNothing) {
  const auto truth = stepped(car("mass = \"1500 kg\"\nI_z = \"2300 kg m^2\"\n"), true);
  DriverForesight foresight(car());
  const MissedByTheModel m = missed_by_model(*truth, foresight, true);
  EXPECT_LT(m.foreseen.y(), 0.5 * m.held.y());
}

TEST(DriverForesight, ForeseesNothingWithoutSteeringAndBearsAnyInput) {
  DriverForesight foresight(car());
  recording::MotionSample s;
  s.frame = Frame::kFrd;
  Foreseen f;
  foresight.reset();
  EXPECT_FALSE(foresight.look(s, 0.01, f));
  s.steer_from = s.speed_from = s.rate_from = s.torque_from = recording::Origin::kMeasured;
  for (int k = 0; k < 3000; ++k) {
    s.inputs = {1.4 * std::sin(0.9 * k), 1e5 * std::sin(0.7 * k), std::abs(1e5 * std::cos(0.3 * k))};
    s.speed = 60.0 * std::sin(0.13 * k);
    s.rate.z() = 50.0 * std::sin(1.3 * k);
    EXPECT_TRUE(foresight.look(s, k % 50 == 0 ? 9.0 : 0.01, f));
    for (const Eigen::Vector3d& then : f.then) ASSERT_TRUE(then.allFinite()) << k;
  }
}

}  // namespace
}  // namespace veridyn::cueing
