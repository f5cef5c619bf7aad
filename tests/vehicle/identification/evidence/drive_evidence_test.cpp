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
#include "veridyn/estimation/judgement/judgement.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::vehicle {
namespace {

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
  out.rows = drive_evidence(mapped, out.signals, segments, vehicle, options, Progress());
  return out;
}

DriveSensorSet with_positions() {
  DriveSensorSet sensors = reference_drive_sensors();
  sensors[DriveSensorKind::kPosition].enabled = true;
  return sensors;
}

const Evidence* find_row(const std::vector<Evidence>& rows, std::string_view name) {
  const auto found = std::ranges::find(rows, name, &Evidence::name);
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
      if (!row.passed()) alarms[i] += fmt::format("{}: {}; ", row.name, row.text);
  });
  const auto raised = std::ranges::count_if(alarms, [](const std::string& text) { return !text.empty(); });
  EXPECT_LE(raised, 2) << fmt::format("{}", fmt::join(alarms, "\n"));
}

/// A fault, and the row that must find it.
struct FaultCase {
  const char* fault;
  test::RecordingFault apply;
  const char* row;
  Outcome outcome;
  const char* about;
  const char* text;
};

// Each must be caught by the row that is meant for it, and named.
TEST(DriveEvidence, NamesWhatIsWrongWithADrive) {
  const char* const kTurning = "lateral acceleration against turning";
  const std::vector<FaultCase> cases{
      {"accel_y in g", test::scaled({"accel_y"}, 1.0 / kGravity), kTurning, Outcome::kFailed, "accel_y",
       "g taken for m/s^2"},
      {"accel_y 0.8", test::scaled({"accel_y"}, 0.8), kTurning, Outcome::kCare, "accel_y", "accel_y reads 0.7"},
      {"yaw rate in deg/s", test::scaled({"yaw_rate"}, 1.0 / kDegree), "yaw rate against heading", Outcome::kFailed,
       "yaw_rate", "degrees taken for radians"},
      {"yaw rate 1.3", test::scaled({"yaw_rate"}, 1.3), kTurning, Outcome::kCare, "yaw_rate", "yaw_rate reads 1.3"},
      {"speed in km/h", test::scaled({"speed"}, 3.6), "speed against positions", Outcome::kFailed, "speed",
       "km/h taken for m/s"},
      {"speed 1.2", test::scaled({"speed"}, 1.2), "speed against positions", Outcome::kFailed, "speed",
       "speed reads 1.2 times"},
      {"accel_x reversed", test::scaled({"accel_x"}, -1.0), "longitudinal acceleration against speed", Outcome::kFailed,
       "accel_x", "its sign is reversed"},
      {"accelerometers swapped", test::swapped("accel_x", "accel_y"), kTurning, Outcome::kFailed, "accel_y",
       "hardly moves with it"},
      {"hand wheel", test::scaled({"steer"}, 15.0), "steering against turning", Outcome::kFailed, "steer",
       "the hand wheel's angle"},
      {"steering ratio 1.3", test::scaled({"steer"}, 1.3), "steering against turning", Outcome::kCare, "steer",
       "steer reads 1.3"},
      {"yaw rate late", test::delayed({"yaw_rate"}, 0.15), "order in time", Outcome::kCare, "steer, yaw_rate",
       "yaw_rate is late"},
      {"yaw rate very late", test::delayed({"yaw_rate"}, 0.5), "order in time", Outcome::kFailed, "steer, yaw_rate",
       "later than tyres do"},
      {"steering late", test::delayed({"steer"}, 0.15), "order in time", Outcome::kCare, "steer", "after its effect"},
      {"steering frozen", test::frozen({"steer"}, 0.1), "steering that stands still", Outcome::kFailed, "steer",
       "steer does not move for"},
      {"yaw rate frozen", test::frozen({"yaw_rate"}, 0.1), "frozen samples", Outcome::kFailed, "yaw_rate",
       "stands still"},
      {"accel_y held", test::held({"accel_y"}, 0.2), "held samples", Outcome::kCare, "accel_y", "measured at 5 Hz"},
      {"accel_y clipped", test::clipped({"accel_y"}, -2.0, 2.0), "clipped samples", Outcome::kFailed, "accel_y",
       "clipped there"}};
  const Recording clean = record_drive(varied_drive(3), with_positions(), 3);
  for (const FaultCase& c : cases) {
    Recording faulty = clean;
    c.apply(faulty);
    const Judged found = judged(faulty, family_car());
    const Evidence* row = find_row(found.rows, c.row);
    ASSERT_NE(row, nullptr) << c.fault;
    EXPECT_EQ(row->outcome, c.outcome) << c.fault << ": " << row->text;
    EXPECT_EQ(row->about, c.about) << c.fault << ": " << row->text;
    EXPECT_THAT(row->text, HasSubstr(c.text)) << c.fault;
    EXPECT_FALSE(row->advice.empty()) << c.fault;
  }
}

// What no drive shows is said, and with which values.
TEST(DriveEvidence, SaysWhatIsTakenAsGiven) {
  const Judged found = judged(record_drive(varied_drive(3), with_positions(), 3), family_car());
  for (const auto& [name, text] : {std::pair{"mass", "the mass of 1500 kg"}, {"centre of gravity", "a = 1.2 m"}}) {
    const Evidence* row = find_row(found.rows, name);
    ASSERT_NE(row, nullptr) << name;
    EXPECT_EQ(row->outcome, Outcome::kNotVerified);
    EXPECT_THAT(row->text, HasSubstr(text));
  }
  for (const char* name :
       {"yaw rate against heading", "speed against positions", "lateral acceleration against turning",
        "longitudinal acceleration against speed", "steering against turning", "order in time"}) {
    const Evidence* row = find_row(found.rows, name);
    ASSERT_NE(row, nullptr) << name;
    EXPECT_TRUE(row->passed()) << row->text;
  }
}

// At one speed understeer and the scale of the steering are one: the row says so, and still finds the hand wheel.
TEST(DriveEvidence, SaysThatOneSpeedDoesNotVerifyTheSteering) {
  Recording recording = record_drive(rolling_drive(4), reference_drive_sensors(), 4);
  const DriveSignalOptions options{.roll_gradient = kRollGradient};
  const Judged clean = judged(recording, testing::road_car(), options);
  EXPECT_EQ(find_row(clean.rows, "steering against turning")->outcome, Outcome::kNotVerified);
  EXPECT_EQ(estimation::judge(clean.rows).data.grade, estimation::Grade::kYes);
  test::scaled({"steer"}, 15.0)(recording);
  const Judged wheel = judged(recording, testing::road_car(), options);
  EXPECT_EQ(find_row(wheel.rows, "steering against turning")->outcome, Outcome::kFailed);
}

// The advice of the row, followed, clears it.
TEST(DriveEvidence, FindsHowFarABodyLeans) {
  const Recording recording = record_drive(rolling_drive(5), reference_drive_sensors(), 5);
  const Judged without = judged(recording, testing::road_car());
  const Evidence* row = find_row(without.rows, "lateral acceleration against turning");
  ASSERT_NE(row, nullptr);
  EXPECT_EQ(row->outcome, Outcome::kCare);
  EXPECT_THAT(row->text, HasSubstr("a body that leans by"));
  const auto at = row->advice.find("(here ");
  ASSERT_NE(at, std::string::npos) << row->advice;
  const double gradient = std::stod(row->advice.substr(at + 6));
  EXPECT_NEAR(gradient, kRollGradient, 0.15 * kRollGradient);
  const Judged with = judged(recording, testing::road_car(), {.roll_gradient = gradient});
  EXPECT_TRUE(find_row(with.rows, "lateral acceleration against turning")->passed());
}

/// A parameter of an identified model.
estimation::Parameter estimated(const char* name, double value, double sigma) {
  estimation::Parameter p;
  p.name = name;
  p.value = value;
  p.sigma = sigma;
  return p;
}

// The car that rolls above, whose model has found how far it leans: the row that asked for it is content. A lean that
// does not account for what the accelerometer shows, no lean, a failure and other rows leave it as it is.
TEST(DriveEvidence, TakesTheIdentifiedLeanForAReadingOfTheAccelerometer) {
  const Recording recording = record_drive(rolling_drive(5), reference_drive_sensors(), 5);
  const Judged found = judged(recording, testing::road_car());
  const Evidence* row = find_row(found.rows, kLateralAcceleration);
  ASSERT_NE(row, nullptr);
  ASSERT_EQ(row->outcome, Outcome::kCare);
  const estimation::Parameter lean = estimated("roll_gradient", kRollGradient, 1e-4);
  const Evidence explained = explained_by_roll(*row, &lean, kGravity);
  EXPECT_EQ(explained.outcome, Outcome::kPassed);
  EXPECT_THAT(explained.text, HasSubstr("leans by 5.0 deg/g"));
  EXPECT_EQ(explained.advice, "");
  EXPECT_EQ(explained.value, row->value);  // what was measured stays so

  const auto is_left = [&](const Evidence& given, const estimation::Parameter* gradient) {
    const Evidence after = explained_by_roll(given, gradient, kGravity);
    return after.outcome == given.outcome && after.text == given.text && after.advice == given.advice;
  };
  EXPECT_TRUE(is_left(*row, nullptr));
  for (const double wrong : {0.0, 0.3 * kRollGradient, 1.8 * kRollGradient, -kRollGradient, kNaN}) {
    const estimation::Parameter other = estimated("roll_gradient", wrong, 1e-4);
    EXPECT_TRUE(is_left(*row, &other)) << wrong;
  }
  Evidence failed = *row, other = *row, passed = *row, low = *row;
  failed.outcome = Outcome::kFailed;
  EXPECT_TRUE(is_left(failed, &lean));
  other.name = "yaw rate against heading";
  EXPECT_TRUE(is_left(other, &lean));
  passed.outcome = Outcome::kNotVerified;
  EXPECT_TRUE(is_left(passed, &lean));
  low.value = 2.0 - row->value;  // a body that leans outward never reads less
  EXPECT_TRUE(is_left(low, &lean));
}

// A reading that is off by more than the lean by 5 % is none of it; by less, it is.
TEST(DriveEvidence, AccountsForALeanToFivePercent) {
  const estimation::Parameter lean = estimated("roll_gradient", 0.01, 1e-4);
  for (const auto& [off, outcome] : {std::pair{-0.051, Outcome::kCare},
                                     {-0.049, Outcome::kPassed},
                                     {0.049, Outcome::kPassed},
                                     {0.051, Outcome::kCare}}) {
    const Evidence row{.name = std::string(kLateralAcceleration), .outcome = Outcome::kCare, .value = 1.0981 + off};
    EXPECT_EQ(explained_by_roll(row, &lean, 9.81).outcome, outcome) << off;
  }
}

// Limits are 0.004 s either way, with care, and 0.02 s, failed; what three standard errors allow is within them.
TEST(DriveEvidence, JudgesTheOrderInTimeByTheDelayThatTheModelFinds) {
  const Evidence row{.name = std::string(kOrderInTime),
                     .about = "steer",
                     .outcome = Outcome::kCare,
                     .value = -0.09,
                     .text = "steer comes after its effect",
                     .advice = "check the stamps of steer"};
  const auto judged_by = [&](double value, double sigma) {
    const estimation::Parameter delay = estimated("steer_delay", value, sigma);
    return in_time_of_model(row, &delay);
  };
  const Evidence in_time = judged_by(0.004, 0.001);
  EXPECT_EQ(in_time.outcome, Outcome::kPassed);
  EXPECT_EQ(in_time.value, 0.004);
  EXPECT_EQ(in_time.advice, "");
  EXPECT_THAT(in_time.text, HasSubstr("0.004 +- 0.001 s later than its model"));
  EXPECT_THAT(judged_by(-0.004, 0.001).text, HasSubstr("0.004 +- 0.001 s earlier than its model"));
  for (const auto& [value, sigma, outcome] :
       {std::tuple{0.008, 0.001, Outcome::kCare}, std::tuple{0.006, 0.001, Outcome::kPassed},
        std::tuple{-0.008, 0.001, Outcome::kCare}, std::tuple{-0.006, 0.001, Outcome::kPassed},
        std::tuple{0.15, 0.05, Outcome::kPassed}, std::tuple{0.024, 0.001, Outcome::kFailed},
        std::tuple{0.022, 0.001, Outcome::kCare}, std::tuple{-0.024, 0.001, Outcome::kFailed}}) {
    const Evidence by_model = judged_by(value, sigma);
    EXPECT_EQ(by_model.outcome, outcome) << value << " +- " << sigma;
    EXPECT_EQ(by_model.advice.empty(), outcome == Outcome::kPassed) << value << " +- " << sigma;
    EXPECT_EQ(by_model.about, "steer, yaw_rate");
  }
  // Of nothing that is known the row stays what it was; so does any other row.
  EXPECT_EQ(in_time_of_model(row, nullptr).text, row.text);
  for (const double unknown : {kInfinity, kNaN}) {
    EXPECT_EQ(judged_by(0.0, unknown).text, row.text);
    EXPECT_EQ(judged_by(0.0, unknown).outcome, row.outcome);
  }
  Evidence other = row;
  other.name = "gravity";
  const estimation::Parameter delay = estimated("steer_delay", 0.0, 0.001);
  EXPECT_EQ(in_time_of_model(other, &delay).text, row.text);
  EXPECT_EQ(in_time_of_model(other, &delay).outcome, row.outcome);
}

TEST(DriveEvidence, TakesGravityForTheUnitAndSignOfTheVerticalAxis) {
  for (const auto& [value, outcome, text] :
       {std::tuple{9.8, Outcome::kPassed, "1 g in the mean"}, std::tuple{1.0, Outcome::kFailed, "g taken for m/s^2"},
        std::tuple{-9.8, Outcome::kFailed, "its sign or the frame"}, std::tuple{9.0, Outcome::kCare, "not 1"}}) {
    Recording recording = record_drive(varied_drive(1), reference_drive_sensors(), 1);
    Channel vertical = recording.at("accel_y");
    vertical.name = "accel_z";
    for (double& v : vertical.value) v = value + 0.1 * v;
    recording.set(std::move(vertical));
    const Judged found = judged(recording, family_car());
    const Evidence* row = find_row(found.rows, "gravity");
    ASSERT_NE(row, nullptr);
    EXPECT_EQ(row->outcome, outcome) << value;
    EXPECT_THAT(row->text, HasSubstr(text));
  }
}

}  // namespace
}  // namespace veridyn::vehicle
