#include "veridyn/recording/inertial_consistency.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/random.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::recording {
namespace {

using estimation::Cause;
using estimation::Check;
using estimation::Outcome;

constexpr double kDuration_s = 120.0;
const std::vector<TimeSpan> kWhole{{1.0, kDuration_s - 1.0}};

struct Noise {
  double force = 0.0, rate = 0.0, angle = 0.0, velocity = 0.0;
};
constexpr Noise kReference{.force = 0.05, .rate = 0.35 * kDegree, .angle = 0.75 * kDegree, .velocity = 0.05};

/// Specific force, rates and angles at the stamps `fast`, velocities at `slow`.
Recording recording_of(const std::vector<double>& fast, const std::vector<double>& slow,
                       const std::array<std::vector<double>, 12>& v) {
  Recording recording;
  recording.frame = Frame::kFrd;
  const TimeBase of_imu = make_time_base(fast), of_fixes = make_time_base(slow);
  constexpr std::array<const char*, 12> kNames{"accel_x", "accel_y", "accel_z", "gyro_x",    "gyro_y",   "gyro_z",
                                               "roll",    "pitch",   "yaw",     "vel_north", "vel_east", "vel_down"};
  for (std::size_t k = 0; k < kNames.size(); ++k) {
    const char* unit = k < 3 ? "m/s^2" : k < 6 ? "rad/s" : k < 9 ? "rad" : "m/s";
    recording.add(make_channel(kNames[k], unit, k < 9 ? of_imu : of_fixes, v[k]));
  }
  return recording;
}

/// A body that sways about all axes, by closed forms: attitude and velocity are sums of sines, rates and specific force
/// their derivatives. No model of a vehicle and no integration is behind it.
/// @param heave  angular frequency of its vertical motion [rad/s]
Recording swaying_body(std::uint64_t seed, const Noise& noise, double heave = 0.6) {
  numerics::RandomStream random(seed, "swaying body");
  constexpr double kStep = 0.01;
  constexpr std::array<double, 3> kAngle{0.5, 0.25, 1.2}, kAngleRate{0.9, 0.7, 0.23};
  constexpr std::array<double, 3> kSpeed{6.0, 5.0, 3.0};
  const std::array<double, 3> speed_rate{0.41, 0.53, heave};
  std::vector<double> fast, slow;
  std::array<std::vector<double>, 12> v;
  for (double t = 0.0; t < kDuration_s; t += kStep) {
    fast.push_back(t);
    numerics::Vector3<double> angle, angle_rate, acceleration;
    for (int i = 0; i < 3; ++i) {
      angle(i) = kAngle[i] * std::sin(kAngleRate[i] * t + i);
      angle_rate(i) = kAngle[i] * kAngleRate[i] * std::cos(kAngleRate[i] * t + i);
      acceleration(i) = kSpeed[i] * speed_rate[i] * std::cos(speed_rate[i] * t + 2 * i);
    }
    const auto rates = numerics::body_rates(angle(0), angle(1), angle_rate);
    const auto force = (numerics::R_body_from_ned(angle(0), angle(1), angle(2)) *
                        (acceleration - numerics::Vector3<double>(0.0, 0.0, kGravity)))
                           .eval();
    for (int i = 0; i < 3; ++i) {
      v[i].push_back(force(i) + noise.force * random.normal());
      v[3 + i].push_back(rates(i) + noise.rate * random.normal());
      v[6 + i].push_back(angle(i) + noise.angle * random.normal());
    }
  }
  for (double t = 0.0; t < kDuration_s; t += 0.1) {
    slow.push_back(t);
    for (std::size_t k = 0; k < 3; ++k)
      v[9 + k].push_back(kSpeed[k] * std::sin(speed_rate[k] * t + 2.0 * static_cast<double>(k)) +
                         noise.velocity * random.normal());
  }
  return recording_of(fast, slow, v);
}

void change(Recording& recording, const char* channel, double factor, double offset = 0.0) {
  Channel changed = recording.at(channel);
  for (double& x : changed.value) x = factor * x + offset;
  recording.set(std::move(changed));
}

Recording without(const Recording& recording, std::string_view name) {
  Recording rest;
  rest.frame = recording.frame;
  for (const Channel& channel : recording.channels())
    if (channel.name != name) rest.add(channel);
  return rest;
}

TEST(InertialConsistency, FindsUnitGainsAndNoBiasWithoutNoise) {
  const InertialConsistency c = inertial_consistency(swaying_body(1, {}), kWhole);
  ASSERT_TRUE(c.accelerometer && c.gyro && c.velocity);
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  // What is left is interpolation between the samples: errors of the order of the step squared.
  EXPECT_LT((c.accelerometer->gain - I).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_LT((c.gyro->gain - I).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_LT(c.accelerometer->bias.cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_LT(c.gyro->bias.cwiseAbs().maxCoeff(), 1e-4);
}

TEST(InertialConsistency, RecoversGainAndBiasThatWerePutIn) {
  Recording recording = swaying_body(2, kReference);
  change(recording, "accel_y", 1.08, 0.2);
  change(recording, "gyro_z", 0.9, 0.02);
  const InertialConsistency c = inertial_consistency(recording, kWhole);
  ASSERT_TRUE(c.accelerometer && c.gyro);
  EXPECT_NEAR(c.accelerometer->gain(1, 1), 1.08, 4.0 * c.accelerometer->gain_sigma(1, 1));
  EXPECT_NEAR(c.accelerometer->bias(1), 0.2, 4.0 * c.accelerometer->bias_sigma(1));
  EXPECT_LT(c.accelerometer->gain_sigma(1, 1), 0.02);
  EXPECT_NEAR(c.gyro->gain(2, 2), 0.9, 4.0 * c.gyro->gain_sigma(2, 2));
  EXPECT_NEAR(c.gyro->bias(2), 0.02, 4.0 * c.gyro->bias_sigma(2));
}

// Magnetic declination, or a compass that was not turned: in turns "axis x reads 0.35 y".
TEST(InertialConsistency, AWrongNorthIsNoTurnedAccelerometer) {
  Recording recording = swaying_body(3, kReference);
  change(recording, "yaw", 1.0, 0.07);
  const InertialConsistency c = inertial_consistency(recording, kWhole);
  ASSERT_TRUE(c.accelerometer);
  EXPECT_LT((c.accelerometer->gain - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 0.02);
  for (const estimation::Evidence& row : inertial_evidence(c))
    if (row.about == "accelerometer") EXPECT_TRUE(row.passed()) << says(row);
}

/// Level circles of a body that speeds up and slows down where its nose points east and is pushed sideways and up and
/// down everywhere, without noise.
/// @param deviation  of the compass: what it reads too much where the nose points east, and too little where west [rad]
Recording circling_body(double deviation) {
  constexpr double kStep = 0.01, kTurnRate = 0.25;
  const auto acceleration = [&](double t) {
    return numerics::Vector3<double>(3.0 * std::sin(1.3 * t) * std::max(0.0, std::sin(kTurnRate * t)),
                                     2.0 + std::sin(0.7 * t), 1.5 * std::cos(0.9 * t));
  };
  std::vector<double> stamps;
  std::array<std::vector<double>, 12> v;
  numerics::Vector3<double> velocity(8.0, 0.0, 0.0);
  for (int k = 0; k * kStep < kDuration_s; ++k) {
    const double t = k * kStep, psi = kTurnRate * t, middle = t + 0.5 * kStep;
    const numerics::Vector3<double> a = acceleration(t);
    stamps.push_back(t);
    const std::array<double, 12> row{
        a(0),        a(1),        a(2) - kGravity, 0.0, 0.0, kTurnRate, 0.0, 0.0, psi + deviation * std::sin(psi),
        velocity(0), velocity(1), velocity(2)};
    for (std::size_t i = 0; i < row.size(); ++i) v[i].push_back(row[i]);
    velocity += kStep * numerics::R_body_from_ned(0.0, 0.0, kTurnRate * middle).transpose() * acceleration(middle);
  }
  return recording_of(stamps, stamps, v);
}

// Iron on board: all of it laid to the accelerometer, "axis y reads -0.2 x".
TEST(InertialConsistency, ADeviationOfTheCompassIsNoTurnedAccelerometer) {
  for (const double deviation : {0.0, 15.0 * kDegree}) {
    const InertialConsistency c = inertial_consistency(circling_body(deviation), kWhole);
    ASSERT_TRUE(c.accelerometer);
    EXPECT_LT((c.accelerometer->gain - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 0.02) << deviation;
  }
}

TEST(InertialEvidence, RaisesNoAlarmOverTwoHundredCleanRecordings) {
  int alarms = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const auto rows = inertial_evidence(inertial_consistency(swaying_body(1000 + seed, kReference), kWhole));
    EXPECT_EQ(rows.size(), 6U);
    for (const estimation::Evidence& row : rows) alarms += row.passed() ? 0 : 1;
  }
  // Six rows of nine, three, two or one number that must exceed three standard errors and the tolerance as well.
  EXPECT_LE(alarms, 2);
}

Recording shifted(std::initializer_list<const char*> channels, double delay_s) {
  Recording recording = swaying_body(5, kReference);
  for (const char* name : channels) {
    Channel channel = recording.at(name);
    std::vector<double> stamps(channel.times().begin(), channel.times().end());
    for (double& t : stamps) t += delay_s;
    channel.time = make_time_base(std::move(stamps));
    recording.set(std::move(channel));
  }
  return recording;
}

TEST(InertialEvidence, FindsHowLateTheAccelerometerIs) {
  const InertialConsistency late = inertial_consistency(shifted({"accel_x", "accel_y", "accel_z"}, 0.08), kWhole);
  ASSERT_TRUE(late.accelerometer_delay.has_value());
  EXPECT_NEAR(*late.accelerometer_delay, 0.08, 0.01);
  const auto rows = inertial_evidence(late);
  const auto row = std::ranges::find(rows, Check::kAccelerometerDelay, &estimation::Evidence::check);
  ASSERT_NE(row, rows.end());
  EXPECT_EQ(row->outcome, Outcome::kCare) << says(*row);
  // A late velocity, which has a delay of its own in the equations, does not accuse the accelerometer.
  const InertialConsistency velocity =
      inertial_consistency(shifted({"vel_north", "vel_east", "vel_down"}, 0.3), kWhole);
  EXPECT_NEAR(*velocity.accelerometer_delay, 0.0, 0.02);
}

// A receiver that is late is that, and no accelerometer that reads more than the truth.
TEST(InertialEvidence, NamesALateOrSmoothedVelocity) {
  for (const double late_s : {0.2, 0.4, 0.6}) {
    const InertialConsistency c = inertial_consistency(shifted({"vel_north", "vel_east", "vel_down"}, late_s), kWhole);
    EXPECT_NEAR(c.velocity_delay, late_s, 0.03);
    for (const estimation::Evidence& row : inertial_evidence(c)) {
      EXPECT_EQ(row.passed(), row.check != Check::kVelocityDelay) << says(row);
      if (row.check == Check::kVelocityDelay) EXPECT_EQ(row.cause, Cause::kDelay);
    }
  }
  // A vertical speed behind a filter of its own, in slow motion and in such as a manoeuvre of the elevator makes, of
  // which the filter takes a part.
  for (const auto& [filter_s, heave] : {std::pair{0.7, 0.6}, {0.2, 3.0}, {0.4, 3.0}, {2.5, 0.6}, {1.5, 1.2}}) {
    SCOPED_TRACE(filter_s);
    Recording recording = swaying_body(5, kReference, heave);
    Channel down = recording.at("vel_down");
    double state = down.value.front();
    for (double& v : down.value) v = state += (1.0 - std::exp(-0.1 / filter_s)) * (v - state);
    recording.set(std::move(down));
    const InertialConsistency c = inertial_consistency(recording, kWhole);
    if (filter_s < 1.0) EXPECT_GT(c.vertical_delay, c.velocity_delay + 0.03);
    for (const estimation::Evidence& row : inertial_evidence(c))
      if (row.check != Check::kVelocityDelay) EXPECT_TRUE(row.passed()) << says(row);
  }
}

// A pitching manoeuvre says nothing of roll and yaw, and its inverse gains there are noise.
TEST(InertialEvidence, JudgesOnlyTheAxesThatMoved) {
  int still = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    Recording recording = swaying_body(2000 + seed, {});
    numerics::RandomStream random(seed, "resting axes");
    // Roll and yaw at rest: what is left of them is noise.
    const Channel pitch = recording.at("pitch");
    for (const char* name : {"roll", "yaw", "gyro_x", "gyro_z", "gyro_y"}) {
      Channel channel = recording.at(name);
      const bool rate = channel.name.starts_with("gyro");
      for (std::size_t k = 0; k < channel.size(); ++k) {
        const double next = pitch.value[std::min(k + 1, pitch.size() - 1)], last = pitch.value[k == 0 ? 0 : k - 1];
        const double moving = channel.name == "gyro_y" ? (next - last) / 0.02 : 0.0;
        channel.value[k] = moving + (rate ? kReference.rate : kReference.angle) * random.normal();
      }
      recording.set(std::move(channel));
    }
    const std::vector<TimeSpan> short_one{{1.0, 14.0}};
    const auto rows = inertial_evidence(inertial_consistency(recording, short_one));
    for (const estimation::Evidence& row : rows) {
      if (row.about != "gyro") continue;
      EXPECT_TRUE(row.passed()) << says(row);
      still += row.cause == Cause::kExcitation ? 1 : 0;
    }
  }
  EXPECT_GE(still, 28);
}

/// One fault, and what must be said of it.
struct Fault {
  const char* name;
  std::vector<std::pair<const char*, double>> factors;
  const char* about;
  Cause cause;
};

TEST(InertialEvidence, NamesTheSensorAndTheFault) {
  const std::vector<Fault> faults{
      {"g",
       {{"accel_x", 1 / kGravity}, {"accel_y", 1 / kGravity}, {"accel_z", 1 / kGravity}},
       "accelerometer",
       Cause::kUnit},
      {"sign of z", {{"accel_z", -1.0}}, "accelerometer", Cause::kSign},
      {"scale", {{"accel_x", 1.2}}, "accelerometer", Cause::kScale},
      {"deg", {{"gyro_x", 1 / kDegree}, {"gyro_y", 1 / kDegree}, {"gyro_z", 1 / kDegree}}, "gyro", Cause::kUnit},
      {"sign of q", {{"gyro_y", -1.0}}, "gyro", Cause::kSign},
      {"down", {{"vel_down", -1.0}}, "ground velocity", Cause::kSign},
      {"knots", {{"vel_north", 1.9438}, {"vel_east", 1.9438}, {"vel_down", 1.9438}}, "ground velocity", Cause::kUnit},
      {"roll", {{"roll", -1.0}}, "attitude", Cause::kAxis}};
  for (const Fault& fault : faults) {
    Recording recording = swaying_body(7, kReference);
    for (const auto& [channel, factor] : fault.factors) change(recording, channel, factor);
    const auto rows = inertial_evidence(inertial_consistency(recording, kWhole));
    const bool named = std::ranges::any_of(rows, [&](const estimation::Evidence& row) {
      return row.about == fault.about && row.outcome == Outcome::kFailed && row.cause == fault.cause;
    });
    std::string texts;
    for (const estimation::Evidence& row : rows) texts += says(row) + "\n";
    EXPECT_TRUE(named) << fault.name << ":\n" << texts;
  }
}

SensorMatrix sensor_with(double gain, double bias) {
  SensorMatrix m;
  m.gain = gain * Eigen::Matrix3d::Identity();
  m.gain_sigma.setConstant(1e-4);
  m.bias.setConstant(bias);
  m.bias_sigma.setConstant(1e-4);
  return m;
}

// The limits of docs/judgement.md.
TEST(InertialEvidence, GradesByTheLimitsOfEachSensor) {
  const auto outcome = [](const InertialConsistency& c, Check check) {
    const auto rows = inertial_evidence(c);
    const auto row = std::ranges::find(rows, check, &estimation::Evidence::check);
    if (row == rows.end()) throw std::logic_error("no row " + std::string(to_string(check)));
    return row->outcome;
  };
  const auto accelerometer = [](double gain, double bias) {
    InertialConsistency c;
    c.accelerometer = sensor_with(gain, bias);
    return c;
  };
  const auto gyro = [](double gain, double bias) {
    InertialConsistency c;
    c.gyro = sensor_with(gain, bias);
    return c;
  };
  const auto late = [](double delay_s) {
    InertialConsistency c;
    c.accelerometer_delay = delay_s;
    c.accelerometer_delay_sigma = 1e-4;
    return c;
  };
  using O = Outcome;
  for (const auto& [gain, expected] : {std::pair{1.015, O::kPassed}, {1.03, O::kCare}, {0.8, O::kFailed}}) {
    EXPECT_EQ(outcome(accelerometer(gain, 0.0), Check::kSensorGain), expected) << gain;
    EXPECT_EQ(outcome(gyro(gain, 0.0), Check::kSensorGain), expected) << gain;
  }
  for (const auto& [bias, expected] : {std::pair{0.08, O::kPassed}, {-0.2, O::kCare}, {1.2, O::kFailed}})
    EXPECT_EQ(outcome(accelerometer(1.0, bias), Check::kAccelerometerBias), expected) << bias;
  for (const auto& [deg, expected] : {std::pair{0.2, O::kPassed}, {-0.5, O::kCare}, {6.0, O::kFailed}})
    EXPECT_EQ(outcome(gyro(1.0, deg * kDegree), Check::kGyroBias), expected) << deg;
  for (const auto& [delay, expected] : {std::pair{0.015, O::kPassed}, {-0.05, O::kCare}, {0.25, O::kFailed}})
    EXPECT_EQ(outcome(late(delay), Check::kAccelerometerDelay), expected) << delay;
}

TEST(InertialConsistency, LeavesOutWhatTheRecordingLacks) {
  const Recording recording = without(swaying_body(3, {}), "vel_down");
  const InertialConsistency c = inertial_consistency(recording, kWhole);
  EXPECT_TRUE(c.gyro.has_value());
  EXPECT_FALSE(c.accelerometer.has_value());
  EXPECT_FALSE(inertial_consistency(without(recording, "roll"), kWhole).gyro.has_value());
  EXPECT_TRUE(inertial_evidence({}).empty());
  const std::vector<TimeSpan> few{{1.0, 5.0}};
  EXPECT_FALSE(inertial_consistency(swaying_body(3, {}), few).accelerometer.has_value());
}

}  // namespace
}  // namespace veridyn::recording
