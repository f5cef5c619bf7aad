#include "veridyn/live/virtual/circuit_drive.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/live/virtual/one_to_five.hpp"
#include "tests/support/refusal.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/live/telemetry/sign_checker.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::live {
namespace {

vehicle::Vehicle four_wheel_drive() {
  vehicle::Vehicle car = test::one_to_five();
  car.longitudinal.front_drive_share = 0.3;
  return car;
}

TEST(CircuitDrive, GoesAroundFromRestInBothDirections) {
  const auto circuit = std::make_shared<vehicle::Circuit>();
  for (const bool clockwise : {false, true}) {
    const auto drive =
        circuit_drive(four_wheel_drive(), circuit, {.speed = 1.8, .laps = 1, .clockwise = clockwise}, {0, 0, 0});
    EXPECT_LT(drive.front().velocity.norm(), 1e-9);
    double highest = 0.0, turned = 0.0, nose_up = 0.0, nose_down = 0.0;
    for (std::size_t k = 0; k < drive.size(); ++k) {
      highest = std::max(highest, drive[k].position.z());
      const double theta = numerics::euler_from_quaternion(drive[k].attitude).theta;
      nose_up = std::max(nose_up, -theta);
      nose_down = std::max(nose_down, theta);
      if (k > 0) turned += (drive[k].attitude * drive[k].rate).z() * (drive[k].time - drive[k - 1].time);
    }
    EXPECT_NEAR(highest, 0.6, 0.01);
    EXPECT_NEAR(turned, (clockwise ? -2.0 : 2.0) * kPi, 0.3);
    // On its soft springs it squats and dives by up to 5 deg where it is driven up and braked down.
    EXPECT_NEAR(nose_up, 30.0 * kDegree, 5.0 * kDegree);
    EXPECT_NEAR(nose_down, 30.0 * kDegree, 5.0 * kDegree);
    EXPECT_LT((drive.back().position - drive.front().position).norm(), 0.5);
  }
}

TEST(CircuitDrive, SaysWhatASensorAwayFromTheCentreOfGravityFeels) {
  // Between two sensors there is omega x (omega x d) + alpha x d, and their velocities differ by omega x d.
  vehicle::CircuitOptions flat;
  flat.ramps.clear();
  flat.bumps.clear();
  flat.rough.clear();
  const auto circuit = std::make_shared<vehicle::Circuit>(flat);
  const Eigen::Vector3d arm(0.2, 0.1, 0.05);
  const auto at_cg = circuit_drive(four_wheel_drive(), circuit, {.laps = 1}, {0, 0, 0});
  const auto at_arm = circuit_drive(four_wheel_drive(), circuit, {.laps = 1}, arm);
  ASSERT_EQ(at_cg.size(), at_arm.size());
  for (std::size_t k = 400; k < at_cg.size(); k += 50) {
    const PacketedMotion &a = at_cg[k], &b = at_arm[k];
    EXPECT_LT((b.position - a.position - a.attitude * arm).norm(), 1e-9);
    EXPECT_LT((b.velocity - a.velocity - a.attitude * a.rate.cross(arm)).norm(), 1e-9);
    const Eigen::Vector3d spin = a.rate.cross(a.rate.cross(arm));
    const Eigen::Vector3d alpha = (at_cg[k + 1].rate - at_cg[k - 1].rate) / (at_cg[k + 1].time - at_cg[k - 1].time);
    EXPECT_LT((b.force - a.force - spin - alpha.cross(arm)).norm(), 0.05) << k;
  }
}

TEST(CircuitDrive, HasRightSignsOnItsRampsToo) {
  const auto drive = circuit_drive(four_wheel_drive(), std::make_shared<vehicle::Circuit>(), {.laps = 2}, {0, 0, 0});
  std::vector<recording::MotionSample> samples;
  for (std::size_t k = 0; k < drive.size(); k += 2) {
    recording::MotionSample m;
    m.time = drive[k].time;
    m.force = drive[k].force;
    m.rate = drive[k].rate;
    m.attitude = drive[k].attitude;
    m.speed = (drive[k].attitude.conjugate() * drive[k].velocity).x();
    m.force_from = m.rate_from = m.attitude_from = m.speed_from = recording::Origin::kMeasured;
    samples.push_back(m);
  }
  SignChecker right, wrong;
  right.add(samples);
  EXPECT_EQ(right.check().kind, SignVerdict::Kind::kRight) << right.check().text;
  // The same sensors, mounted back to front.
  for (recording::MotionSample& m : samples) {
    m.force.head<2>() = -m.force.head<2>();
    m.rate.head<2>() = -m.rate.head<2>();
  }
  wrong.add(samples);
  EXPECT_NE(wrong.check().kind, SignVerdict::Kind::kRight);
}

TEST(CircuitDrive, ReadsItsKeysAndRefusesWhatCannotBeDriven) {
  const auto read = [](const std::string& text) {
    const Study study = Study::parse(text, "c.toml");
    return CircuitDriveOptions::keys().read(study.root());
  };
  const CircuitDriveOptions o = read("speed = '2 m/s'\nlaps = 3\ndirection = 'clockwise'\n");
  EXPECT_EQ(o.speed, 2.0);
  EXPECT_EQ(o.laps, 3);
  EXPECT_TRUE(o.clockwise);
  EXPECT_NE(why([&] { static_cast<void>(read("laps = 0")); }).find("from 1 to 1000"), std::string::npos);
  const auto circuit = std::make_shared<vehicle::Circuit>();
  EXPECT_NE(why([&] {
              static_cast<void>(circuit_drive(four_wheel_drive(), circuit, {.speed = 12.0, .laps = 1}, {0, 0, 0}));
            }).find("leaves the road"),
            std::string::npos);
}

}  // namespace
}  // namespace veridyn::live
