#include "veridyn/vehicle/identification/evidence/drive_evidence.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "tests/support/channel_faults.hpp"
#include "tests/vehicle/cars.hpp"
#include "tests/vehicle/changed_drive.hpp"
#include "tests/vehicle/simulation/drives.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/estimation/judgement/judgement.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::Cause;
using estimation::Check;
using estimation::Evidence;
using estimation::Outcome;
using testing::drive_bicycle;
using testing::family_car;
using ::testing::HasSubstr;
using testing::WanderingSteer;

/// A bicycle whose speed goes from 8 to 22 m/s and back.
VehicleTrajectory varied_drive(std::uint64_t seed, double duration = 60.0) {
  const WanderingSteer steer(seed, 0.02);
  return drive_bicycle<BicycleModel<double, LinearTyre<double>>>(
      [](double) { return testing::linear_bicycle(family_car()); }, duration, [&](double t) { return steer(t); },
      [](double t) { return 15.0 + 7.0 * std::sin(0.2 * t); });
}

/// A four-wheel car whose body rolls and whose load moves to the outer wheels, at a constant speed.
VehicleTrajectory rolling_drive(std::uint64_t seed, double duration = 60.0) {
  const WanderingSteer steer(seed, 0.015);
  SimulationOptions options;
  options.speed = 14.0 + static_cast<double>(seed % 10);
  options.duration = duration;
  return testing::drive(
      testing::linear_car(testing::road_car()), [&](double t) { return Controls{.steer = steer(t)}; }, options);
}

struct Judged {
  DriveSignals signals;
  std::vector<Evidence> rows;
};

Judged judged(const Recording& recording, const VehicleParameters<double>& vehicle,
              const DriveSignalOptions& options = {}) {
  Judged out;
  const recording::MappedRecording mapped = testing::mapped(recording);
  out.signals = prepare_drive_signals(mapped, options);
  const DriveSegments segments = find_drive_segments(out.signals, {});
  out.rows = recording_rows(drive_findings(mapped, out.signals, segments, vehicle, options, Progress()));
  return out;
}

DriveSensorSet with_positions() {
  DriveSensorSet sensors = reference_drive_sensors();
  sensors[DriveSensorKind::kPosition].enabled = true;
  return sensors;
}

const Evidence* find_row(const std::vector<Evidence>& rows, Check check) {
  const auto found = std::ranges::find(rows, check, &Evidence::check);
  return found == rows.end() ? nullptr : &*found;
}

/// Lean of the four-wheel car's body, by which g enters accel_y [rad/(m/s^2)].
constexpr double kRollGradient = 0.0089;

// 100 bicycles at varied speed and 100 four-wheel cars that roll, each 40 s with reference sensors and positions.
TEST(DriveEvidence, RaisesFewAlarmsOverTwoHundredCleanDrives) {
  constexpr std::size_t kDrives = 200;
  std::vector<std::string> alarms(kDrives);
  numerics::parallel_for(kDrives, 0, [&](std::size_t i) {
    const bool rolls = i % 2 == 1;
    const auto seed = static_cast<std::uint64_t>(i + 1);
    const VehicleTrajectory drive = rolls ? rolling_drive(seed, 40.0) : varied_drive(seed, 40.0);
    const Judged found = judged(record_drive(drive, with_positions(), seed), rolls ? testing::road_car() : family_car(),
                                {.roll_gradient = rolls ? kRollGradient : 0.0});
    for (const Evidence& row : found.rows)
      if (!row.passed()) alarms[i] += fmt::format("{}: {}; ", name_of(row), says(row));
  });
  const auto raised = std::ranges::count_if(alarms, [](const std::string& text) { return !text.empty(); });
  EXPECT_LE(raised, 2) << fmt::format("{}", fmt::join(alarms, "\n"));
}

/// A fault, and the row that must find it.
struct FaultCase {
  const char* fault;
  test::RecordingFault apply;
  Check row;
  Outcome outcome;
  const char* about;
  Cause cause;
};

// Each must be caught by the row that is meant for it, and named.
TEST(DriveEvidence, NamesWhatIsWrongWithADrive) {
  const std::vector<FaultCase> cases{
      {"accel_y in g", test::scaled({"accel_y"}, 1.0 / kGravity), Check::kWrongChannel, Outcome::kFailed, "accel_y",
       Cause::kUnit},
      {"accel_y 0.8", test::scaled({"accel_y"}, 0.8), Check::kWrongChannel, Outcome::kCare, "accel_y", Cause::kScale},
      {"yaw rate in deg/s", test::scaled({"yaw_rate"}, 1.0 / kDegree), Check::kWrongChannel, Outcome::kFailed,
       "yaw_rate", Cause::kUnit},
      {"yaw rate 1.3", test::scaled({"yaw_rate"}, 1.3), Check::kWrongChannel, Outcome::kFailed, "yaw_rate",
       Cause::kScale},
      {"yaw rate reversed", test::scaled({"yaw_rate"}, -1.0), Check::kWrongChannel, Outcome::kFailed, "yaw_rate",
       Cause::kSign},
      {"speed in km/h", test::scaled({"speed"}, 3.6), Check::kWrongChannel, Outcome::kFailed, "speed", Cause::kUnit},
      {"speed in knots", test::scaled({"speed"}, 1.94384), Check::kWrongChannel, Outcome::kFailed, "speed",
       Cause::kUnit},
      {"speed in mph", test::scaled({"speed"}, 2.23694), Check::kWrongChannel, Outcome::kFailed, "speed", Cause::kUnit},
      {"speed 1.2", test::scaled({"speed"}, 1.2), Check::kWrongChannel, Outcome::kFailed, "speed", Cause::kScale},
      {"accel_x reversed", test::scaled({"accel_x"}, -1.0), Check::kWrongChannel, Outcome::kFailed, "accel_x",
       Cause::kSign},
      {"accelerometers swapped", test::swapped("accel_x", "accel_y"), Check::kWrongChannel, Outcome::kFailed,
       "accel_x, accel_y", Cause::kAxis},
      {"hand wheel", test::scaled({"steer"}, 15.0), Check::kHandWheel, Outcome::kFailed, "steer", Cause::kUnit},
      {"a kart's hand wheel", test::scaled({"steer"}, 6.0), Check::kHandWheel, Outcome::kFailed, "steer", Cause::kUnit},
      {"a truck's hand wheel", test::scaled({"steer"}, 24.0), Check::kHandWheel, Outcome::kFailed, "steer",
       Cause::kUnit},
      {"steering twice", test::scaled({"steer"}, 2.0), Check::kWrongChannel, Outcome::kFailed, "steer", Cause::kScale},
      {"steering ratio 1.3", test::scaled({"steer"}, 1.3), Check::kWrongChannel, Outcome::kCare, "steer",
       Cause::kScale},
      {"yaw rate late", test::delayed({"yaw_rate"}, 0.15), Check::kSteeringOrder, Outcome::kCare, "steer, yaw_rate",
       Cause::kDelay},
      {"yaw rate very late", test::delayed({"yaw_rate"}, 0.5), Check::kSteeringOrder, Outcome::kFailed,
       "steer, yaw_rate", Cause::kDelay},
      {"steering late", test::delayed({"steer"}, 0.15), Check::kSteeringOrder, Outcome::kCare, "steer, yaw_rate",
       Cause::kDelay},
      {"steering frozen", test::frozen({"steer"}, 0.1), Check::kFrozenSteering, Outcome::kFailed, "steer",
       Cause::kFrozen},
      {"yaw rate frozen", test::frozen({"yaw_rate"}, 0.1), Check::kFrozenSamples, Outcome::kFailed, "yaw_rate",
       Cause::kFrozen},
      {"accel_y held", test::held({"accel_y"}, 0.2), Check::kHeldSamples, Outcome::kCare, "accel_y", Cause::kHeld},
      {"accel_y clipped", test::clipped({"accel_y"}, -2.0, 2.0), Check::kClippedSamples, Outcome::kFailed, "accel_y",
       Cause::kSaturation}};
  const Recording clean = record_drive(varied_drive(3), with_positions(), 3);
  for (const FaultCase& c : cases) {
    Recording faulty = clean;
    c.apply(faulty);
    const Judged found = judged(faulty, family_car());
    const Evidence* row = find_row(found.rows, c.row);
    ASSERT_NE(row, nullptr) << c.fault;
    EXPECT_EQ(row->outcome, c.outcome) << c.fault << ": " << says(*row);
    EXPECT_EQ(row->about, c.about) << c.fault << ": " << says(*row);
    EXPECT_EQ(row->cause, c.cause) << c.fault << ": " << says(*row);
    EXPECT_FALSE(advice_of(*row).empty()) << c.fault;
  }
}

// What no drive shows is said, and with which values.
TEST(DriveEvidence, SaysWhatIsTakenAsGiven) {
  const Judged found = judged(record_drive(varied_drive(3), with_positions(), 3), family_car());
  for (const auto& [check, text] :
       {std::pair{Check::kGivenMass, "the mass of 1500 kg"}, {Check::kGivenCentreOfGravity, "a = 1.2 m"}}) {
    const Evidence* row = find_row(found.rows, check);
    ASSERT_NE(row, nullptr) << text;
    EXPECT_EQ(row->outcome, Outcome::kNotVerified);
    EXPECT_THAT(says(*row), HasSubstr(text));
  }
  for (const Check check : {Check::kYawRateScale, Check::kSpeedScale, Check::kLateralAcceleration,
                            Check::kLongitudinalAcceleration, Check::kSteeringScale, Check::kSteeringOrder}) {
    const Evidence* row = find_row(found.rows, check);
    ASSERT_NE(row, nullptr) << to_string(check);
    EXPECT_TRUE(row->passed()) << says(*row);
  }
}

// A sixth of the rows with the stamp of the row before, as a logger with coarse stamps writes them.
// What the yaw rate of a car that goes straight does is noise, whatever its share.
TEST(DriveEvidence, ASteeringThatIsStraightAllTheTimeIsNotFrozen) {
  const VehicleTrajectory straight = drive_bicycle<BicycleModel<double, LinearTyre<double>>>(
      [](double) { return testing::linear_bicycle(family_car()); }, 40.0, [](double) { return 0.0; },
      [](double) { return 15.0; });
  Recording recording = record_drive(straight, reference_drive_sensors(), 1);
  Channel steer = recording.at("steer");
  std::ranges::fill(steer.value, 0.0);
  recording.set(std::move(steer));
  EXPECT_EQ(find_row(judged(recording, family_car()).rows, Check::kFrozenSteering), nullptr);
}

TEST(DriveEvidence, SaysThatStampsAreRepeated) {
  Recording recording = record_drive(varied_drive(3), with_positions(), 3);
  EXPECT_EQ(find_row(judged(recording, family_car()).rows, Check::kStamps), nullptr);
  const Channel& gyro = recording.at("yaw_rate");
  std::vector<double> stamps(gyro.times().begin(), gyro.times().end());
  for (std::size_t k = 1; k < stamps.size(); k += 7) stamps[k] = stamps[k - 1];
  Channel repeated = gyro;
  repeated.time = make_time_base(std::move(stamps));
  recording.set(std::move(repeated));
  const Judged found = judged(recording, family_car());
  const Evidence* row = find_row(found.rows, Check::kStamps);
  ASSERT_NE(row, nullptr);
  EXPECT_EQ(row->outcome, Outcome::kCare);
  EXPECT_EQ(row->about, "yaw_rate");
  EXPECT_NEAR(row->value, 1.0 / 7.0, 0.01);
}

// At one speed understeer and the scale of the steering are one: the row says so, and still finds the hand wheel.
TEST(DriveEvidence, SaysThatOneSpeedDoesNotVerifyTheSteering) {
  Recording recording = record_drive(rolling_drive(4), reference_drive_sensors(), 4);
  const DriveSignalOptions options{.roll_gradient = kRollGradient};
  const Judged clean = judged(recording, testing::road_car(), options);
  EXPECT_EQ(find_row(clean.rows, Check::kSteeringScale)->outcome, Outcome::kNotVerified);
  EXPECT_EQ(estimation::judge(clean.rows).data.grade, estimation::Grade::kYes);
  test::scaled({"steer"}, 15.0)(recording);
  const Judged wheel = judged(recording, testing::road_car(), options);
  EXPECT_EQ(find_row(wheel.rows, Check::kSteeringScale)->outcome, Outcome::kFailed);
}

// The advice of the row, followed, clears it.
TEST(DriveEvidence, FindsHowFarABodyLeans) {
  const Recording recording = record_drive(rolling_drive(5), reference_drive_sensors(), 5);
  const Judged without = judged(recording, testing::road_car());
  const Evidence* row = find_row(without.rows, Check::kWrongChannel);
  ASSERT_NE(row, nullptr);
  EXPECT_EQ(row->outcome, Outcome::kCare);
  EXPECT_EQ(row->cause, Cause::kMissingTerm);
  ASSERT_NE(row->figure("gradient"), nullptr);
  const double gradient = std::get<double>(row->figure("gradient")->value);
  EXPECT_NEAR(gradient, kRollGradient, 0.15 * kRollGradient);
  const Judged with = judged(recording, testing::road_car(), {.roll_gradient = gradient});
  EXPECT_TRUE(find_row(with.rows, Check::kLateralAcceleration)->passed());
}

/// What accel_y reads over what turning says, to either side by `doubt`.
Evidence lateral_row(double ratio, std::optional<double> roll_gradient, double doubt = 0.01) {
  DriveConsistency drive;
  drive.found.relations = {{.check = Check::kLateralAcceleration,
                            .channel = recording::InertialChannel::kAccelY,
                            .against = "yaw rate times speed",
                            .low = ratio - doubt,
                            .high = ratio + doubt,
                            .truth_rms = 1.0,
                            .reading_rms = 1.0,
                            .least = 0.1,
                            .verified = std::abs(ratio - 1.0) + doubt < 0.1,
                            .tolerance = estimation::info_of(Check::kLateralAcceleration).tolerance}};
  return consistency_rows(drive, roll_gradient, 9.81).front();
}

// A lean of 0.01 rad/(m/s^2) makes accel_y read 1.0981 times what turning says; what differs by more than 5 % of it is
// none of it, nor is a failure or less than the truth: a body that leans outward never reads less.
TEST(DriveEvidence, TakesTheIdentifiedLeanForAReadingOfTheAccelerometer) {
  for (const auto& [ratio, outcome] : {std::pair{1.0981, Outcome::kPassed},
                                       {1.0981 + 0.049, Outcome::kPassed},
                                       {1.0981 + 0.051, Outcome::kCare},
                                       {1.6, Outcome::kFailed},
                                       {0.9, Outcome::kCare}})
    EXPECT_EQ(lateral_row(ratio, 0.01).outcome, outcome) << ratio;
  EXPECT_EQ(lateral_row(1.0981, 0.01).cause, Cause::kMissingTerm);
  EXPECT_EQ(advice_of(lateral_row(1.0981, 0.01)), "");
  for (const std::optional<double> other : {std::optional<double>(), {0.0}, {0.003}, {0.018}, {-0.01}, {kNaN}})
    EXPECT_EQ(lateral_row(1.0981, other).outcome, Outcome::kCare) << other.value_or(-1.0);
}

/// By signals 0.09 s late.
recording::DelayReport steering_late(double delay_s = -0.09, double sigma_s = 0.002) {
  return {.group = "steer",
          .reference = "yaw_rate",
          .delay_s = delay_s,
          .sigma_s = sigma_s,
          .correlation = 0.99,
          .finding = recording::DelayFinding::kApplied};
}

KnownByModel with_delay(double value, double sigma) {
  return {.delay = DelayByModel{.value_s = value, .sigma_s = sigma}};
}

// It is estimated and corrected; beyond five and ten standard deviations of its prior (0.15 and 0.3 s) it is raised.
TEST(DriveEvidence, JudgesTheDelayThatTheModelFinds) {
  for (const auto& [value, sigma, outcome] :
       {std::tuple{0.03, 0.001, Outcome::kPassed}, std::tuple{-0.03, 0.001, Outcome::kPassed},
        std::tuple{0.16, 0.001, Outcome::kCare}, std::tuple{-0.16, 0.001, Outcome::kCare},
        std::tuple{0.16, 0.02, Outcome::kPassed}, std::tuple{0.31, 0.001, Outcome::kFailed},
        std::tuple{-0.31, 0.001, Outcome::kFailed}}) {
    const Evidence row = steering_row(steering_late(), with_delay(value, sigma));
    EXPECT_EQ(row.check, Check::kSteeringDelay);
    EXPECT_EQ(row.outcome, outcome) << value << " +- " << sigma;
    EXPECT_EQ(row.about, "steer, yaw_rate");
    EXPECT_EQ(row.cause, outcome == Outcome::kPassed ? Cause::kNone : Cause::kDelay);
    EXPECT_EQ(advice_of(row).empty(), outcome == Outcome::kPassed) << value << " +- " << sigma;
  }
  EXPECT_THAT(says(steering_row(steering_late(), with_delay(-0.024, 0.001))),
              HasSubstr("steer is 24.0 +- 1.0 ms late against yaw_rate: estimated, and corrected"));
  // A delay that the model does not determine leaves the signals.
  for (const double unknown : {kInfinity, kNaN})
    EXPECT_EQ(steering_row(steering_late(), with_delay(0.0, unknown)).check, Check::kSteeringOrder);
}

// Signals alone find what tyres cannot make, and verify nothing: a hand wheel 30 ms late, which they show as -0.046 s,
// is within what tyres and a body's lean make.
TEST(DriveEvidence, SignalsAloneNeverVerifyThatTheSteeringIsInTime) {
  const auto outcome = [](double delay_s, const KnownByModel& known = {}) {
    return steering_row(steering_late(delay_s), known).outcome;
  };
  EXPECT_EQ(outcome(0.0), Outcome::kNotVerified);
  EXPECT_EQ(outcome(-0.046), Outcome::kNotVerified);
  EXPECT_EQ(outcome(-0.09), Outcome::kCare);
  EXPECT_EQ(outcome(0.09), Outcome::kCare);
  EXPECT_EQ(outcome(0.5), Outcome::kFailed);
  // Of a body that leans, or of tyres that changed, they tell nothing.
  EXPECT_EQ(outcome(0.5, {.roll_gradient = 0.01}), Outcome::kNotVerified);
  EXPECT_EQ(outcome(0.5, {.changed = true}), Outcome::kNotVerified);
  // The scatter of the search counts.
  EXPECT_EQ(steering_row(steering_late(-0.09, 0.02), {}).outcome, Outcome::kNotVerified);
}

// The structure of a drive is sought unless its recording contradicts itself in what parameters rest on.
TEST(DriveEvidence, ContradictsItselfOnlyInWhatParametersRestOn) {
  DriveFindings findings;
  findings.steering_delay = steering_late(0.0);
  EXPECT_FALSE(contradicts_itself(findings));
  findings.rows = {estimation::row_of(Check::kGravity, "accel_z", 0.1)};
  ASSERT_EQ(findings.rows.front().outcome, Outcome::kFailed);
  EXPECT_FALSE(contradicts_itself(findings)) << "of the vertical axis, which no parameter needs";
  findings.steering_delay = steering_late(0.5);
  EXPECT_TRUE(contradicts_itself(findings));
}

TEST(DriveEvidence, TakesGravityForTheUnitAndSignOfTheVerticalAxis) {
  for (const auto& [value, outcome, cause] :
       {std::tuple{9.8, Outcome::kPassed, Cause::kNone}, std::tuple{32.2, Outcome::kFailed, Cause::kUnit},
        // The sign of this axis, or the frame of all: the drive does not tell.
        std::tuple{-9.8, Outcome::kFailed, Cause::kNone}, std::tuple{0.2, Outcome::kPassed, Cause::kNone},
        std::tuple{9.0, Outcome::kCare, Cause::kNone}}) {
    Recording recording = record_drive(varied_drive(1), reference_drive_sensors(), 1);
    Channel vertical = recording.at("accel_y");
    vertical.name = "accel_z";
    for (double& v : vertical.value) v = value + 0.1 * v;
    recording.set(std::move(vertical));
    const Judged found = judged(recording, family_car());
    const Evidence* row = find_row(found.rows, Check::kGravity);
    ASSERT_NE(row, nullptr);
    EXPECT_EQ(row->outcome, outcome) << value;
    EXPECT_EQ(row->cause, cause) << says(*row);
  }
}

}  // namespace
}  // namespace veridyn::vehicle
