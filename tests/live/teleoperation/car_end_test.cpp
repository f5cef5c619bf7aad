#include "veridyn/live/teleoperation/car_end.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/live/teleoperation/simulated_loop.hpp"
#include "tests/support/refusal.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::live {
namespace {

using testing::SimulatedLoop;

constexpr CarCommand kDriveOn{.steering = 0.1, .drive_force = 20.0, .brake = 0.0};

CarSensors rolling(double wheel_speed = 30.0) {
  CarSensors sensors;
  sensors.wheel_speeds.fill(wheel_speed);
  return sensors;
}

void expect_command(const CarCommand& executed, const CarCommand& sent) {
  EXPECT_NEAR(executed.steering, sent.steering, 0.51e-4);
  EXPECT_NEAR(executed.drive_force, sent.drive_force, 0.0251);
  EXPECT_NEAR(executed.brake, sent.brake, 0.51e-4);
}

TEST(CarEnd, HoldsItsBrakesUntilItHearsReleasedPedals) {
  SimulatedLoop loop;
  loop.command = kDriveOn;
  loop.run(2.0, [&] {
    ASSERT_EQ(loop.actuation.state, CarState::kHolding);
    ASSERT_EQ(loop.actuation.command.drive_force, 0.0);
    ASSERT_EQ(loop.actuation.command.brake, loop.now < kMillisecond ? 0.0 : 1.0);
  });
  // The link is there: the driver's steering is followed, but the pedal was never released.
  EXPECT_NEAR(loop.actuation.command.steering, 0.1, 1e-4);
  EXPECT_GT(loop.car->verdicts()[CommandVerdict::kExecuted], 190U);

  loop.command = {};
  loop.run(0.08);
  EXPECT_EQ(loop.car->state(), CarState::kHolding);
  loop.run(0.05);
  EXPECT_EQ(loop.car->state(), CarState::kDriving);
  loop.command = kDriveOn;
  loop.run(0.05);
  expect_command(loop.actuation.command, kDriveOn);
  EXPECT_EQ(loop.car->links_lost(), 0U);
}

TEST(CarEnd, ExecutesEachCommandAsItWasSent) {
  SimulatedLoop loop;
  loop.get_going();
  for (int k = 0; k < 300; ++k) {
    loop.command = {
        .steering = 0.5 * std::sin(0.1 * k), .drive_force = 90.0 * std::cos(0.07 * k), .brake = (k % 11) / 10.0};
    loop.run(0.01);
    if (k > 0) expect_command(loop.actuation.command, loop.sent.at(*loop.car->last_executed()).command);
  }
  // 27 bytes at 40 us each, on steps of 0.1 ms.
  for (const Nanoseconds age : loop.command_ages) EXPECT_EQ(age, 11 * kMillisecond / 10);
  EXPECT_EQ(loop.command_ages.size(), loop.sent.size() - 1);  // the last one is on its way
}

TEST(CarEnd, BrakesByItselfOnALostLinkAndHolds) {
  SimulatedLoop loop;
  loop.get_going();
  loop.sensors = rolling();
  loop.command = {.steering = 0.2, .drive_force = 50.0, .brake = 0.0};
  loop.run(0.5);
  loop.to_car.cut = true;
  const Nanoseconds cut = loop.now;
  std::optional<Nanoseconds> braked;
  double brake = 0.0;
  loop.run(1.5, [&] {
    if (loop.actuation.state == CarState::kDriving) return;
    if (!braked) braked = loop.now;
    ASSERT_EQ(loop.actuation.state, CarState::kBraking);
    ASSERT_EQ(loop.actuation.command.drive_force, 0.0);
    ASSERT_NEAR(loop.actuation.command.steering, 0.2, 1e-4);
    // Smoothly: 2/s, seen once a millisecond.
    ASSERT_GE(loop.actuation.command.brake, brake);
    ASSERT_LE(loop.actuation.command.brake, brake + 0.0021);
    brake = loop.actuation.command.brake;
  });
  // The last command had arrived up to 10 ms before the cut.
  ASSERT_TRUE(braked);
  EXPECT_GE(*braked - cut, 185 * kMillisecond);
  EXPECT_LE(*braked - cut, 202 * kMillisecond);
  EXPECT_NEAR(brake, 0.6, 1e-12);
  EXPECT_EQ(loop.car->links_lost(), 1U);

  loop.sensors = rolling(0.1);
  loop.run(0.25);
  EXPECT_EQ(loop.car->state(), CarState::kBraking);
  loop.run(0.3);
  EXPECT_EQ(loop.car->state(), CarState::kHolding);
  EXPECT_NEAR(loop.actuation.command.brake, 1.0, 1e-12);
  loop.run(60.0);
  EXPECT_EQ(loop.car->state(), CarState::kHolding);
  EXPECT_EQ(loop.car->links_lost(), 1U);
}

TEST(CarEnd, DrivesAgainOnlyAfterTheDriverHasReleasedThePedals) {
  SimulatedLoop loop;
  loop.get_going();
  loop.sensors = rolling();
  loop.command = kDriveOn;
  loop.run(0.5);
  loop.to_car.cut = true;
  loop.run(0.6);
  loop.to_car.cut = false;
  loop.run(2.0, [&] { ASSERT_EQ(loop.actuation.command.drive_force, 0.0); });
  EXPECT_EQ(loop.car->state(), CarState::kBraking);
  EXPECT_NEAR(loop.actuation.command.brake, 0.6, 1e-9);
  // A driver who brakes harder is obeyed, and who steers too.
  loop.command = {.steering = -0.3, .drive_force = 0.0, .brake = 0.9};
  loop.run(0.1);
  EXPECT_NEAR(loop.actuation.command.brake, 0.9, 1e-4);
  EXPECT_NEAR(loop.actuation.command.steering, -0.3, 1e-4);
  loop.command = {};
  loop.run(0.05);
  EXPECT_EQ(loop.car->state(), CarState::kBraking);
  loop.run(0.1);
  EXPECT_EQ(loop.car->state(), CarState::kDriving);
  loop.command = kDriveOn;
  loop.run(0.1);
  expect_command(loop.actuation.command, kDriveOn);
}

TEST(CarEnd, AnOutageBetweenTwoStepsOfTheActuatorsCountsToo) {
  // Steps every 100 ms, outage of 205 ms that ends before the next step.
  CarEnd car({.neutral_for = 0}, 1);
  OperatorEnd driver({}, 2);
  std::array<std::uint8_t, kLongestFrame> frame;
  const auto exchange = [&](const CarCommand& command, Nanoseconds now) {
    driver.receive(Bytes(frame).first(car.report({}, now, frame)), now);
    car.receive(Bytes(frame).first(driver.command(command, now, frame)), now);
  };
  exchange({}, kMillisecond);
  EXPECT_EQ(car.step({}, kMillisecond).state, CarState::kDriving);
  exchange(kDriveOn, 2 * kMillisecond);
  EXPECT_EQ(car.step({}, 102 * kMillisecond).state, CarState::kDriving);
  exchange(kDriveOn, 203 * kMillisecond);
  EXPECT_EQ(car.step(rolling(), 204 * kMillisecond).state, CarState::kBraking);
  EXPECT_EQ(car.links_lost(), 1U);
}

TEST(CarEnd, NeutralBeforeAnOutageIsNotNeutralAfterIt) {
  // The same, with released pedals throughout: they must be released for `neutral_for` after the outage.
  CarEnd car({}, 1);
  OperatorEnd driver({}, 2);
  std::array<std::uint8_t, kLongestFrame> frame;
  const auto exchange = [&](Nanoseconds now) {
    driver.receive(Bytes(frame).first(car.report({}, now, frame)), now);
    car.receive(Bytes(frame).first(driver.command({}, now, frame)), now);
  };
  exchange(kMillisecond);
  EXPECT_EQ(car.step({}, 50 * kMillisecond).state, CarState::kHolding);
  // One command, however long ago, says nothing of the pedals since.
  EXPECT_EQ(car.step({}, 190 * kMillisecond).state, CarState::kHolding);
  exchange(210 * kMillisecond);
  EXPECT_EQ(car.step({}, 220 * kMillisecond).state, CarState::kHolding);
  exchange(309 * kMillisecond);
  EXPECT_EQ(car.step({}, 315 * kMillisecond).state, CarState::kHolding);
  exchange(320 * kMillisecond);
  EXPECT_EQ(car.step({}, 320 * kMillisecond).state, CarState::kDriving);
}

TEST(CarEnd, BrakesWithReleasedPedalsToo) {
  SimulatedLoop loop;
  loop.get_going();
  loop.sensors = rolling();
  loop.run(1.0);  // rolls, pedals released
  EXPECT_EQ(loop.car->state(), CarState::kDriving);
  loop.to_car.cut = true;
  loop.run(0.25);
  loop.run(1.0, [&] { ASSERT_EQ(loop.actuation.state, CarState::kBraking); });
  EXPECT_EQ(loop.car->links_lost(), 1U);
  EXPECT_NEAR(loop.actuation.command.brake, 0.6, 1e-9);
}

TEST(CarEnd, AnEchoOfItsRunBeforeProvesNothing) {
  CarEnd before({.neutral_for = 0}, 1), after({.neutral_for = 0}, 2);
  OperatorEnd driver({}, 2);
  std::array<std::uint8_t, kLongestFrame> frame;
  driver.receive(Bytes(frame).first(before.report({}, 0, frame)), 0);
  EXPECT_GT(after.report({}, 0, frame), 0U);  // of the same number, and lost
  after.receive(Bytes(frame).first(driver.command({}, kMillisecond, frame)), kMillisecond);
  EXPECT_EQ(after.verdicts()[CommandVerdict::kUnproven], 1U);
  EXPECT_EQ(after.step({}, kMillisecond).state, CarState::kHolding);
}

TEST(CarEnd, NeverExecutesDuplicatesAndLateCommands) {
  CarEnd car({.neutral_for = 0}, 1);
  OperatorEnd driver({}, 2);
  using CommandFrame = std::vector<std::uint8_t>;
  std::array<std::uint8_t, kLongestFrame> frame;
  Nanoseconds now = 0;
  driver.receive(Bytes(frame).first(car.report({}, now, frame)), now);
  const auto command = [&](double force) {
    const std::size_t size = driver.command({.drive_force = force}, now, frame);
    return CommandFrame(frame.begin(), frame.begin() + size);
  };
  const auto force_after = [&](const CommandFrame& bytes) {
    now += kMillisecond;
    car.receive(bytes, now);
    return car.step({}, now).command.drive_force;
  };
  EXPECT_EQ(force_after(command(0.0)), 0.0);
  const CommandFrame first = command(10.0), second = command(20.0), third = command(30.0);
  EXPECT_EQ(force_after(first), 10.0);
  EXPECT_EQ(force_after(third), 30.0);
  EXPECT_EQ(force_after(second), 30.0);  // late
  EXPECT_EQ(force_after(first), 30.0);   // a duplicate
  EXPECT_EQ(force_after(third), 30.0);
  EXPECT_EQ(car.verdicts()[CommandVerdict::kExecuted], 3U);
  EXPECT_EQ(car.verdicts()[CommandVerdict::kLate], 1U);
  EXPECT_EQ(car.verdicts()[CommandVerdict::kDuplicate], 2U);
  // Nor do they keep the link alive.
  for (int k = 0; k < 250; ++k) (void)force_after(second);
  EXPECT_EQ(car.state(), CarState::kBraking);
}

TEST(CarEnd, RefusesWhatIsOutOfItsOwnRange) {
  CarEnd car({.range = {.steering = 0.3, .drive_force = 10.0}, .neutral_for = 0}, 1);
  OperatorEnd driver({.range = {.steering = 0.6, .drive_force = 100.0}}, 2);
  std::array<std::uint8_t, kLongestFrame> frame;
  driver.receive(Bytes(frame).first(car.report({}, 0, frame)), 0);
  const auto send = [&](const CarCommand& command, Nanoseconds now) {
    car.receive(Bytes(frame).first(driver.command(command, now, frame)), now);
    return car.step({}, now).command;
  };
  // The first of a run is judged too.
  EXPECT_EQ(send({.drive_force = 50.0}, 1), (CarCommand{.brake = 1.0}));
  (void)send({}, 2);
  expect_command(send({.steering = 0.3, .drive_force = -10.0}, 3), {.steering = 0.3, .drive_force = -10.0});
  expect_command(send({.steering = 0.4}, 4), {.steering = 0.3, .drive_force = -10.0});
  expect_command(send({.drive_force = 11.0}, 5), {.steering = 0.3, .drive_force = -10.0});
  EXPECT_EQ(car.verdicts()[CommandVerdict::kOutOfRange], 3U);

  // Another kind of frame, and a payload of another size.
  const std::array<std::uint8_t, kCommandPayload> payload = {};
  car.receive(Bytes(frame).first(encode_frame({.kind = 9}, payload, frame)), 6);
  car.receive(Bytes(frame).first(encode_frame({.kind = kCommandKind}, Bytes(payload).first(11), frame)), 7);
  car.receive(Bytes(frame).first(car.report({}, 8, frame)), 8);  // its own report, as on a line with an echo
  EXPECT_EQ(car.verdicts()[CommandVerdict::kNoCommand], 3U);
}

TEST(CarEnd, RefusesStaleCommandsHoweverNewTheirNumber) {
  // A radio that keeps everything for 300 ms: each command is newer than the one before, and none may be executed.
  for (const bool outward : {true, false}) {
    SimulatedLoop loop;
    loop.get_going();
    loop.sensors = rolling();
    loop.command = kDriveOn;
    loop.run(0.5);
    (outward ? loop.to_car : loop.to_operator).delay = 300 * kMillisecond;
    loop.run(3.0);
    EXPECT_EQ(loop.car->state(), CarState::kBraking);
    EXPECT_GT(loop.car->verdicts()[CommandVerdict::kStale], 200U);
    for (const Nanoseconds age : loop.command_ages) EXPECT_LE(age, 200 * kMillisecond);
  }
  // 80 ms each way are within 200.
  SimulatedLoop loop;
  loop.to_car.delay = loop.to_operator.delay = 80 * kMillisecond;
  loop.command = {};
  loop.run(0.5);
  EXPECT_EQ(loop.car->state(), CarState::kDriving);
}

TEST(CarEnd, IsNotDrivenBlind) {
  SimulatedLoop loop;
  loop.get_going();
  loop.sensors = rolling();
  loop.command = kDriveOn;
  loop.run(0.5);
  loop.to_operator.cut = true;
  loop.run(1.0);
  EXPECT_EQ(loop.car->state(), CarState::kDriving);
  loop.run(0.3);
  EXPECT_EQ(loop.car->state(), CarState::kBraking);
  EXPECT_GT(loop.car->verdicts()[CommandVerdict::kUnproven], 1U);
}

TEST(CarEnd, BrakesThroughAPauseOfTheOperator) {
  SimulatedLoop loop;
  loop.get_going();
  loop.sensors = rolling();
  loop.command = kDriveOn;
  loop.run(0.5);
  loop.operator_paused = true;  // reports pile up
  loop.run(5.0);
  EXPECT_EQ(loop.car->state(), CarState::kBraking);
  loop.operator_paused = false;
  loop.run(1.0, [&] { ASSERT_EQ(loop.actuation.command.drive_force, 0.0); });
  loop.command = {};
  loop.run(0.2);
  EXPECT_EQ(loop.car->state(), CarState::kDriving);
  for (const Nanoseconds age : loop.command_ages) EXPECT_LE(age, 2 * kMillisecond);
}

TEST(CarEnd, ExecutesNothingThatPiledUpWhileItWasPaused) {
  SimulatedLoop loop;
  loop.get_going();
  loop.sensors = rolling();
  loop.command = kDriveOn;
  loop.run(0.5);
  loop.car_paused = true;  // commands pile up
  loop.run(5.0);
  loop.car_paused = false;
  loop.run(1.0, [&] { ASSERT_NE(loop.actuation.state, CarState::kHolding); });
  EXPECT_EQ(loop.car->state(), CarState::kBraking);
  for (const Nanoseconds age : loop.command_ages) EXPECT_LE(age, 200 * kMillisecond);
  EXPECT_GT(loop.car->verdicts()[CommandVerdict::kStale] + loop.car->verdicts()[CommandVerdict::kUnproven], 400U);
  loop.get_going();
  EXPECT_EQ(loop.car->state(), CarState::kDriving);
}

TEST(CarEnd, TakesANewRunOfTheOperatorOnceTheOldOneIsLost) {
  SimulatedLoop loop;
  loop.get_going();
  loop.sensors = rolling();
  loop.command = kDriveOn;
  loop.run(5.0);
  loop.start_operator();  // at once, with the pedal down: its numbers begin again
  loop.run(1.0);
  EXPECT_EQ(loop.car->state(), CarState::kBraking);
  EXPECT_GT(loop.car->verdicts()[CommandVerdict::kOtherRun], 15U);
  EXPECT_LT(loop.car->verdicts()[CommandVerdict::kOtherRun], 21U);
  EXPECT_EQ(loop.actuation.command.drive_force, 0.0);
  loop.get_going();
  EXPECT_EQ(loop.car->state(), CarState::kDriving);
  EXPECT_GE(loop.operator_end->quality(loop.now).commands_arrived, 100U);
}

TEST(CarEnd, HoldsAfterItsOwnRestart) {
  SimulatedLoop loop;
  loop.get_going();
  loop.command = kDriveOn;
  loop.run(5.0);
  loop.start_car();
  loop.run(1.0, [&] {
    if (loop.now % kMillisecond != 0) return;  // between two steps of the actuators
    ASSERT_EQ(loop.actuation.state, CarState::kHolding);
    ASSERT_EQ(loop.actuation.command.drive_force, 0.0);
  });
  EXPECT_EQ(loop.operator_end->car_restarts(), 1U);
  // Commands that still echoed the run before prove nothing.
  EXPECT_GE(loop.car->verdicts()[CommandVerdict::kUnproven], 1U);
  loop.get_going();
  EXPECT_EQ(loop.car->state(), CarState::kDriving);
}

TEST(CarEnd, IsRefusedWithOptionsThatCannotBe) {
  const auto refusal = [](const CarEndOptions& options) { return why([&] { CarEnd car(options, 1); }); };
  EXPECT_EQ(refusal({.lost_after = 0}), "lost_after: is 0; must be > 0");
  EXPECT_EQ(refusal({.stale_after = -1}), "stale_after: is -1e-09; must be > 0");
  EXPECT_EQ(refusal({.blind_after = 0}), "blind_after: is 0; must be > 0");
  EXPECT_EQ(refusal({.neutral_for = -kSecond}), "neutral_for: is -1; must not be below 0");
  EXPECT_EQ(refusal({.neutral_force = kNaN}), "neutral_force: is nan; must be from 0 to 1");
  EXPECT_EQ(refusal({.neutral_brake = 1.5}), "neutral_brake: is 1.5; must be from 0 to 1");
  EXPECT_EQ(refusal({.brake_rate = 0.0}), "brake_rate: is 0; must be > 0");
  EXPECT_EQ(refusal({.brake_moving = -0.1}), "brake_moving: is -0.1; must be from 0 to 1");
  EXPECT_EQ(refusal({.brake_holding = kNaN}), "brake_holding: is nan; must be from 0 to 1");
  EXPECT_EQ(refusal({.standing_speed = kNaN}), "standing_speed: is nan; must be > 0");
  EXPECT_EQ(refusal({.standing_for = -kSecond}), "standing_for: is -1; must not be below 0");
  EXPECT_EQ(refusal({.range = {.steering = -1.0}}), "range.steering: is -1 rad; must be > 0 and <= 3.2");
}

}  // namespace
}  // namespace veridyn::live
