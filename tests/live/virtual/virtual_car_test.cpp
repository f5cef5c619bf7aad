#include "veridyn/live/virtual/virtual_car.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/live/virtual/one_to_five.hpp"
#include "tests/support/refusal.hpp"
#include "veridyn/live/teleoperation/operator_end.hpp"
#include "veridyn/live/virtual/noisy_line.hpp"
#include "veridyn/numerics/rotation.hpp"
#include "veridyn/vehicle/road/circuit.hpp"

namespace veridyn::live {
namespace {

/// A driver behind an operator's end, a line of 250 kbit/s each way, and the car.
class DrivenCar {
 public:
  explicit DrivenCar(double flips = 0.0, VirtualCarOptions options = quiet())
      : car(test::one_to_five(), options, 77),
        driver({.range = options.end.range}, 5),
        to_car(flips, 3),
        to_driver(flips, 4) {}

  static VirtualCarOptions quiet() {
    VirtualCarOptions o;
    o.errors = {0, 0, 0, 0, 0, 0, 0};
    return o;
  }

  void run(double time, const CarCommand& command) {
    std::array<std::uint8_t, kLongestFrame> frame{};
    for (const Nanoseconds end = now + nanoseconds(time); now < end;) {
      now += kMillisecond;
      driver.receive(to_driver.arrived(now), now);
      if (now % (10 * kMillisecond) == 0) to_car.send(Bytes(frame).first(driver.command(command, now, frame)), now);
      car.advance(now);
      car.receive(to_car.arrived(now), now);
      if (now % (10 * kMillisecond) == 3 * kMillisecond)
        to_driver.send(Bytes(frame).first(car.report(now, frame)), now);
      ASSERT_TRUE(car.state().vehicle.allFinite()) << "at " << seconds(now) << " s";
    }
  }
  /// Pedals released, so that the car drives.
  void get_going() { run(0.4, {}); }
  [[nodiscard]] double at(vehicle::FourWheelIndex index) const { return car.state().vehicle(index); }

  VirtualCar car;
  OperatorEnd driver;
  NoisyLine to_car, to_driver;
  Nanoseconds now = 0;
};

TEST(VirtualCar, StandsWithItsBrakesOnUntilSomebodyDrives) {
  DrivenCar c;
  c.to_car.cut = true;
  c.run(1.0, {.drive_force = 20.0});
  EXPECT_EQ(c.car.actuation().state, CarState::kHolding);
  EXPECT_NEAR(c.at(vehicle::kU), 0.0, 1e-6);
  EXPECT_NEAR(c.car.true_sensors().acceleration.z(), kGravity, 1e-3);
}

TEST(VirtualCar, DrivesFromRestForwardAsNewtonSays) {
  DrivenCar c;
  c.get_going();
  ASSERT_EQ(c.car.actuation().state, CarState::kDriving);
  const double before = c.at(vehicle::kU), begin = seconds(c.now);
  c.run(1.0, {.drive_force = 10.0});
  // Force less rolling resistance (0.01 of the weight) on the mass and the wheels' inertia I/R^2 (four of them); drag
  // is 0.02 N at 1 m/s. The command is on its way for 3 ms.
  const double mass = 8.8 + 4.0 * 3.2e-4 / (0.06 * 0.06);
  const double expected = (10.0 - 0.01 * 8.8 * kGravity) / mass * (seconds(c.now) - begin);
  EXPECT_NEAR(c.at(vehicle::kU) - before, expected, 0.02 * expected);
  EXPECT_NEAR(c.car.true_sensors().wheel_speeds[0] * 0.06, c.at(vehicle::kU), 0.01);
}

TEST(VirtualCar, DrivesFromRestBackward) {
  DrivenCar c;
  c.get_going();
  c.run(1.5, {.steering = 0.1, .drive_force = -10.0});
  EXPECT_LT(c.at(vehicle::kU), -1.0);
  // Backward with the wheels to the left the nose turns right.
  EXPECT_LT(c.at(vehicle::kYaw), -0.05);
  c.run(3.0, {.brake = 1.0});
  EXPECT_NEAR(c.at(vehicle::kU), 0.0, 1e-3);
}

TEST(VirtualCar, TurnsAsTheBicycleModelSays) {
  DrivenCar c;
  c.get_going();
  c.run(2.0, {.drive_force = 10.0});
  c.run(2.0, {.steering = 0.05, .drive_force = 0.9});
  const double u = c.at(vehicle::kU);
  // r = u delta/(L + K u^2), K = m/(2 L) (b/C_f - a/C_r) with C of one tyre; K = 0.73 s^2/m here.
  const vehicle::VehicleParameters<double> p = test::one_to_five().parameters;
  const double k = p.mass / (2.0 * p.wheelbase()) * (p.b / p.C_f - p.a / p.C_r);
  const double expected = u * 0.05 / (p.wheelbase() + k * u * u);
  EXPECT_NEAR(c.at(vehicle::kR), expected, 0.05 * expected) << "at " << u << " m/s";
}

TEST(VirtualCar, BrakesByItselfWhereTheLineIsCut) {
  DrivenCar c;
  c.get_going();
  c.run(2.0, {.drive_force = 15.0});
  const double u = c.at(vehicle::kU);
  ASSERT_GT(u, 2.0);
  c.to_car.cut = true;
  c.run(0.3, {.drive_force = 15.0});
  EXPECT_EQ(c.car.actuation().state, CarState::kBraking);
  EXPECT_EQ(c.car.actuation().command.drive_force, 0.0);
  c.run(4.0, {.drive_force = 15.0});
  EXPECT_NEAR(c.at(vehicle::kU), 0.0, 1e-3);
  EXPECT_EQ(c.car.actuation().state, CarState::kHolding);
  EXPECT_EQ(c.car.end().links_lost(), 1U);
}

TEST(VirtualCar, IsTheSameToTheLastBitForTheSameBytes) {
  VirtualCarOptions noisy;
  DrivenCar a(0.01, noisy), b(0.01, noisy);
  for (DrivenCar* c : {&a, &b}) {
    c->get_going();
    c->run(2.0, {.steering = 0.1, .drive_force = 12.0});
    c->run(1.0, {.steering = -0.2, .brake = 0.5});
  }
  EXPECT_EQ(a.car.state().vehicle, b.car.state().vehicle);
  EXPECT_EQ(a.driver.quality(a.now).reports_received, b.driver.quality(b.now).reports_received);
  EXPECT_GT(a.driver.quality(a.now).frames_damaged, 0U);
  EXPECT_EQ(a.driver.report()->payload.sensors.acceleration, b.driver.report()->payload.sensors.acceleration);
}

TEST(VirtualCar, HasSensorsThatAreWrongByWhatIsSaid) {
  VirtualCarOptions o = DrivenCar::quiet();
  o.errors.rate = 0.01;
  DrivenCar c(0.0, o);
  double sum = 0.0, squares = 0.0;
  constexpr int kReports = 500;
  for (int k = 0; k < kReports; ++k) {
    c.run(0.01, {});
    const double r = c.driver.report() ? c.driver.report()->payload.sensors.rate.z() : 0.0;
    sum += r;
    squares += r * r;
  }
  // The standard deviation of 500 is known to 3.2 %, three times of that; rounding to 0.001 adds 0.0003.
  EXPECT_NEAR(std::sqrt(squares / kReports), 0.01, 0.001);
  EXPECT_NEAR(sum / kReports, 0.0, 3.0 * 0.01 / std::sqrt(kReports));
}

TEST(VirtualCar, KeepsTheTruth) {
  DrivenCar c;
  CarTruth truth;
  c.get_going();
  truth.add(c.now, c.car);
  EXPECT_TRUE(
      truth.csv().starts_with("# frame: flu\ntime[s],pos_x[m],pos_y[m],pos_z[m],roll[rad],pitch[rad],yaw[rad],"));
  EXPECT_NE(truth.csv().find("\n0.4,"), std::string::npos) << truth.csv();
}

TEST(VirtualCar, ClimbsTheRampOfACircuit) {
  // 0.15 m up 7 deg within the first straight, with its brakes on while nobody drives.
  const auto circuit = std::make_shared<vehicle::Circuit>();
  VirtualCar car(test::one_to_five(), DrivenCar::quiet(), 77, circuit);
  OperatorEnd driver({.range = DrivenCar::quiet().end.range}, 5);
  std::array<std::uint8_t, kLongestFrame> frame{};
  double highest = 0.0, steepest = 0.0;
  for (Nanoseconds now = 0; now < 3 * kSecond; now += 10 * kMillisecond) {
    car.receive(Bytes(frame).first(driver.command({.drive_force = now < kSecond / 2 ? 0.0 : 30.0}, now, frame)), now);
    car.advance(now);
    driver.receive(Bytes(frame).first(car.report(now, frame)), now);
    highest = std::max(highest, car.world().position.z());
    steepest = std::max(steepest, -numerics::euler_from_quaternion(car.motion().attitude).theta);
    if (car.world().position.x() < 1.0) {
      EXPECT_NEAR(car.world().position.z(), 0.0, 0.005);
    }
  }
  EXPECT_NEAR(highest, 0.15, 0.01);
  // At full throttle it squats by 2 deg on its soft springs.
  EXPECT_NEAR(steepest, 9.0 * kDegree, 1.0 * kDegree);
}

TEST(VirtualCar, RefusesNumbersThatCannotBe) {
  VirtualCarOptions o;
  o.brake_torque = 0.0;
  EXPECT_EQ(why([&] { VirtualCar(test::one_to_five(), o, 1); }), "brake: is 0 N m; must be > 0");
  o.brake_torque = 1.0;
  o.steering_lag = -1.0;
  EXPECT_EQ(why([&] { VirtualCar(test::one_to_five(), o, 1); }), "steering_lag: is -1 s; must be from 0 to 1");
}

}  // namespace
}  // namespace veridyn::live
