#include "veridyn/vehicle/identification/drive_log.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "tests/vehicle/simulated_drive.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/vehicle/identification/drive_segments.hpp"
#include "veridyn/vehicle/drive_study.hpp"

namespace veridyn::vehicle {
namespace {

using testing::family_car;
using testing::lively_drive;

Recording recorded(double duration = 30.0) {
  return record_drive(lively_drive(family_car(), 1, 0.02, duration), testing::perfect_sensors(), 1);
}

std::string refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

Recording changed(const Recording& recording, const std::string& name,
                  const std::function<double(double, double)>& change) {
  Recording out = recording::without_channels(recording);
  for (Channel c : recording.channels()) {
    if (c.name == name) {
      for (std::size_t i = 0; i < c.value.size(); ++i) c.value[i] = change(c.times()[i], c.value[i]);
    }
    out.add(std::move(c));
  }
  return out;
}

Recording without(const Recording& recording, const std::string& name) {
  Recording out = recording::without_channels(recording);
  for (const Channel& c : recording.channels()) {
    if (c.name != name) out.add(c);
  }
  return out;
}

DriveSignals prepared(const Recording& r, const DriveSignalOptions& o = {}) {
  return prepare_drive_signals(testing::mapped(r), o);
}

TEST(DriveLog, TurnsAFrdRecordingIntoFlu) {
  const Recording flu = recorded();
  Recording frd = flu;
  for (const char* name : {"steer", "yaw_rate", "accel_y"})
    frd = changed(frd, name, [](double, double v) { return -v; });
  frd.frame = Frame::kFrd;
  const DriveSignals a = prepared(flu), b = prepared(frd);
  for (const DriveSignal s : {DriveSignal::kSteer, DriveSignal::kYawRate, DriveSignal::kAccelY, DriveSignal::kSpeed})
    EXPECT_EQ(a[s].value, b[s].value);
  frd.frame = Frame::kUnspecified;
  const recording::MappedRecording by_study = map_drive_channels(frd, StudyTable(), "frd");
  EXPECT_EQ(prepare_drive_signals(by_study, {})[DriveSignal::kYawRate].value, a[DriveSignal::kYawRate].value);
  EXPECT_NE(refusal([&] { static_cast<void>(map_drive_channels(frd, StudyTable(), "ned")); }).find("'flu'"),
            std::string::npos);
}

TEST(DriveLog, NoticesSignsThatContradictEachOther) {
  const Recording r = recorded();
  const auto negative = [](double, double v) { return -v; };
  EXPECT_NE(refusal([&] { prepared(changed(r, "accel_y", negative)); }).find("accel_y goes against"),
            std::string::npos);
  EXPECT_NE(refusal([&] { prepared(changed(r, "steer", negative)); }).find("steer goes against"), std::string::npos);
  const DriveSignals in_g = prepared(changed(r, "accel_y", [](double, double v) { return v / 9.80665; }));
  ASSERT_FALSE(in_g.notes.empty());
  EXPECT_NE(in_g.notes.back().find("a unit, a scale"), std::string::npos);
}

TEST(DriveLog, NamesWhatIsMissing) {
  const Recording r = recorded();
  EXPECT_NE(refusal([&] { prepared(without(r, "steer")); }).find("has no steer"), std::string::npos);
  EXPECT_NE(refusal([&] { prepared(without(r, "speed")); }).find("has no speed"), std::string::npos);
  EXPECT_NE(refusal([&] { prepared(without(r, "yaw_rate")); }).find("has no yaw_rate"), std::string::npos);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(
      refusal([&] { prepared(changed(r, "yaw_rate", [&](double, double) { return nan; })); }).find("holds no numbers"),
      std::string::npos);
  EXPECT_NE(refusal([&] { prepared(Recording{}); }), "");
}

TEST(DriveLog, TakesTheHandWheelAndWheelSpeeds) {
  const Recording r = recorded();
  Recording other = recording::without_channels(r);
  other.add(r.at("yaw_rate"));
  other.add(r.at("accel_y"));
  Channel wheel = r.at("steer");
  wheel.name = "steering_wheel";
  for (double& v : wheel.value) v *= 16.0;
  other.add(wheel);
  for (const char* name : {"wheel_speed_rl", "wheel_speed_rr"}) {
    const Channel& u = r.at("speed");
    std::vector<double> omega = u.value;
    for (double& v : omega) v /= 0.3;
    other.add(make_channel(name, "rad/s", u.time, omega));
  }
  EXPECT_NE(refusal([&] { prepared(other); }).find("signals.steering_ratio"), std::string::npos);
  EXPECT_NE(refusal([&] { prepared(other, {.steering_ratio = 16.0}); }).find("signals.rolling_radius"),
            std::string::npos);
  const DriveSignals a = prepared(r), b = prepared(other, {.steering_ratio = 16.0, .rolling_radius = 0.3});
  for (std::size_t k = 0; k < a.size(); k += 100) {
    EXPECT_NEAR(a[DriveSignal::kSteer].value[k], b[DriveSignal::kSteer].value[k], 1e-12);
    EXPECT_NEAR(a[DriveSignal::kSpeed].value[k], b[DriveSignal::kSpeed].value[k], 1e-9);
  }
}

TEST(DriveLog, TakesGravityOffByRollOrByItsGradient) {
  const Recording r = recorded();
  const double gradient = 0.0089, g = 9.80665;
  // A body that leans outward in proportion: left side up in a left turn.
  const Channel& a = r.at("accel_y");
  std::vector<double> roll(a.value), felt(a.value);
  for (std::size_t i = 0; i < roll.size(); ++i) {
    roll[i] = gradient * a.value[i];
    felt[i] = a.value[i] + g * std::sin(roll[i]);
  }
  Recording leaning = r;
  leaning.set(make_channel("accel_y", "m/s^2", a.time, felt));
  const DriveSignals by_gradient = prepared(leaning, {.roll_gradient = gradient});
  leaning.add(make_channel("roll", "rad", a.time, roll));
  const DriveSignals by_roll = prepared(leaning);
  EXPECT_TRUE(by_gradient.gravity_removed);
  for (std::size_t k = 0; k < by_roll.size(); k += 50) {
    EXPECT_NEAR(by_roll[DriveSignal::kAccelY].value[k], a.value[k], 1e-9);
    EXPECT_NEAR(by_gradient[DriveSignal::kAccelY].value[k], a.value[k], 1e-3);
  }
}

TEST(DriveSensors, TheRecordedNoiseIsTheOneAsked) {
  const Recording r = record_drive(lively_drive(family_car(), 1, 0.02, 120.0), reference_drive_sensors(), 3);
  const DriveSignals s = prepared(r);
  // 12000 samples: the level is found to a few percent.
  EXPECT_NEAR(s[DriveSignal::kYawRate].sigma, 0.1 * M_PI / 180.0, 0.15 * 0.1 * M_PI / 180.0);
  EXPECT_NEAR(s[DriveSignal::kAccelY].sigma, 0.05, 0.0075);
  EXPECT_EQ(r.frame, Frame::kFlu);
  const Recording again = record_drive(lively_drive(family_car(), 1, 0.02, 120.0), reference_drive_sensors(), 3);
  EXPECT_EQ(r.at("accel_y").value, again.at("accel_y").value);
}

TEST(DriveSensors, AnAccelerometerAwayFromTheCentreOfGravityIsMovedThere) {
  const VehicleTrajectory t = lively_drive(family_car(), 1, 0.02, 30.0);
  DriveSensorSet sensors = testing::perfect_sensors();
  sensors.accel_position = {0.8, 0.3, 0.0};
  const DriveSignals s = prepared(record_drive(t, sensors, 1), {.accel_position = {0.8, 0.3, 0.0}});
  for (std::size_t k = 0; k < s.size(); k += 100) {
    const double expected = t.lateral_acceleration[k] + 0.8 * t.yaw_acceleration[k] - 0.3 * t.r[k] * t.r[k];
    EXPECT_NEAR(s[DriveSignal::kAccelY].value[k], expected, 1e-9);
  }
}

TEST(DriveSegments, SayWhyADriveCannotBeUsed) {
  const Recording r = recorded();
  const auto segments = [](const Recording& of) {
    return refusal([&] { static_cast<void>(find_drive_segments(prepared(of), {})); });
  };
  EXPECT_NE(segments(changed(r, "speed", [](double, double) { return 0.0; })).find("never drives"), std::string::npos);
  EXPECT_NE(segments(changed(r, "steer", [](double, double v) { return 1.6 + 0.1 * v; })).find("beyond 60 deg"),
            std::string::npos);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(segments(changed(r, "steer", [&](double t, double v) { return std::fmod(t, 2.0) < 1.0 ? nan : v; }))
                .find("no stretch"),
            std::string::npos);
}

TEST(DriveSegments, LeaveGapsOutAndKeepTheHoldOutApart) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Recording r =
      changed(recorded(120.0), "steer", [&](double t, double v) { return t > 40.0 && t < 45.0 ? nan : v; });
  const DriveSegments s = find_drive_segments(prepared(r), {});
  ASSERT_FALSE(s.identification.empty());
  ASSERT_FALSE(s.holdout.empty());
  for (const std::vector<TimeSpan>* spans : {&s.identification, &s.holdout}) {
    for (const TimeSpan& span : *spans) EXPECT_TRUE(span.end <= 40.02 || span.begin >= 44.98);
  }
  for (const TimeSpan& a : s.identification) {
    for (const TimeSpan& b : s.holdout) EXPECT_TRUE(a.end + 0.49 <= b.begin || b.end + 0.49 <= a.begin);
  }
  const double share = s.seconds(s.holdout) / (s.seconds(s.holdout) + s.seconds(s.identification));
  EXPECT_NEAR(share, 1.0 / 3.0, 0.1);
}

TEST(DriveStudy, IdentifiesARecordingThatItIsGiven) {
  const Study study = Study::parse(
      "seed = 3\n[subject]\nkind = \"vehicle\"\nname = \"car\"\nmass = 1500\na = 1.2\nb = 1.5\n[identify]\nmethod = "
      "\"output error\"\n[identify.uncertainty]\nmass = \"15 kg\"\n",
      "study.toml");
  Progress silent;
  DriveStudy read =
      read_drive_study(study, record_drive(lively_drive(family_car(), 1), reference_drive_sensors(), 1), silent);
  study.root().finish();
  EXPECT_EQ(read.identify.mass_sigma, 15.0);
  EXPECT_EQ(read.vehicle.I_z, 1500.0 * 1.2 * 1.5);
  DriveAnalysis analysis = identify_drive(read, silent);
  const estimation::EstimatedParameter* C_f = analysis.estimate.find("C_f");
  ASSERT_NE(C_f, nullptr);
  EXPECT_LE(C_f->low95, 55000.0);
  EXPECT_GE(C_f->high95, 55000.0);
  EXPECT_GT(analysis.estimate.validation.at("yaw_rate").r2, 0.99);
  // On another drive, which it has not seen.
  DriveStudy other =
      read_drive_study(study, record_drive(lively_drive(family_car(), 9), reference_drive_sensors(), 9), silent);
  const DriveAnalysis seen = validate_drive(other, analysis.estimate, silent);
  EXPECT_EQ(seen.identification.verdict, VehicleVerdict::kIdentified) << seen.identification.reason;
  EXPECT_GT(seen.estimate.validation.at("yaw_rate").r2, 0.99);
}

}  // namespace
}  // namespace veridyn::vehicle
