#include "veridyn/aircraft/identification/signals/flight_signals.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>

#include "tests/aircraft/stripped_recording.hpp"
#include "tests/support/refusal.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::aircraft {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using F = FlightSignal;

constexpr double kStep_s = 0.01, kEnd_s = 10.0;

Channel sampled(const std::string& name, std::string_view unit, const std::function<double(double)>& of,
                double step = kStep_s) {
  std::vector<double> time, value;
  for (double t = 0.0; t < kEnd_s + 0.5 * step; t += step) {
    time.push_back(t);
    value.push_back(of(t));
  }
  return make_channel(name, unit, make_time_base(std::move(time)), std::move(value));
}

/// A recording and its reconstruction, both of formulas; what is not named is zero.
struct FormulaFlight {
  FormulaFlight() {
    mapped.recording.source = "formulas";
    for (const char* name : {"gyro_x", "gyro_y", "gyro_z"}) record(name, "rad/s", 0.0);
    for (const char* name : {"accel_x", "accel_y", "accel_z"}) record(name, "m/s^2", 0.0);
    for (const char* name : {"alpha", "beta", "roll", "pitch", "yaw"})
      smoothed.add(sampled(name, "rad", [](double) { return 0.0; }));
    smoothed.add(sampled("airspeed", "m/s", [](double) { return 20.0; }));
    smoothed.add(sampled("sigma_airspeed", "m/s", [](double t) { return t < 5.0 ? 0.3 : 0.4; }));
  }
  void record(const std::string& name, std::string_view unit, const std::function<double(double)>& of,
              double step = kStep_s) {
    mapped.recording.set(sampled(name, unit, of, step));
  }
  void record(const std::string& name, std::string_view unit, double value) {
    record(name, unit, [value](double) { return value; });
  }
  [[nodiscard]] FlightSignals prepared(const SignalOptions& options = {}) const {
    return prepare_signals(mapped, smoothed, flow_sensors(reconstruct, smoothed), subject, options);
  }
  MappedRecording mapped;
  Recording smoothed;
  ReconstructOptions reconstruct = {};
  Subject subject = builtin_subject("thor");
};

/// In the middle of the flight, where no filter sees an end.
std::size_t middle(const FlightSignals& s) { return s.size() / 2; }

// A rate of 0.2 sin(2 pi t) lies in the pass band, whose ripple is 0.1 %.
TEST(FlightSignals, FilterAndDifferentiateTheGyro) {
  FormulaFlight flight;
  flight.record("gyro_y", "rad/s", [](double t) { return 0.2 * std::sin(2.0 * kPi * t); });
  const FlightSignals s = flight.prepared();
  EXPECT_EQ(s.filter.rate_Hz, 100.0);
  EXPECT_EQ(s.filter.pass_Hz, 10.0);
  for (std::size_t k = middle(s) - 50; k < middle(s) + 50; ++k) {
    const double phase = 2.0 * kPi * s.grid.at(k);
    EXPECT_NEAR(s[F::kQ].value[k], 0.2 * std::sin(phase), 2e-4);
    EXPECT_NEAR(s[F::kQdot].value[k], 0.4 * kPi * std::cos(phase), 4e-4 * kPi);
  }
  EXPECT_EQ(s[F::kQ].error, ErrorKind::kClassical);
  EXPECT_EQ(s.stride, 3U) << "every third of 100 Hz for a stop band from 15 Hz";
}

// A sensor 0.5 m in front of the centre of gravity of a body that turns at 2 rad/s about z is pulled inwards by 2 m/s^2
// more than that.
TEST(FlightSignals, MoveTheAccelerometerToTheCentreOfGravity) {
  FormulaFlight flight;
  flight.record("gyro_z", "rad/s", 2.0);
  flight.record("accel_x", "m/s^2", -2.0);
  flight.subject.imu_position = {0.5, 0.0, 0.0};
  const FlightSignals s = flight.prepared();
  EXPECT_NEAR(s[F::kAx].value[middle(s)], 0.0, 1e-9);
  EXPECT_THAT(s.notes, Contains("accelerometer moved by (-0.500, -0.000, -0.000) m to the centre of gravity"));
  flight.subject.imu_position = {0.0, 0.0, 0.0};
  const FlightSignals there = flight.prepared();
  EXPECT_NEAR(there[F::kAx].value[middle(there)], -2.0, 1e-9);
}

// Ten metres ahead of the centre of gravity the noise of yaw acceleration is most of that of the side force.
TEST(FlightSignals, GiveAMovedAccelerometerTheNoiseOfTheAngularAccelerations) {
  FormulaFlight flight;
  SignalOptions options;
  options.noise = {{"gyro_x", 0.002}, {"gyro_y", 0.002}, {"gyro_z", 0.002}, {"accel_y", 0.05}};
  const FlightSignals there = flight.prepared(options);
  const double in_place = there[F::kAy].sigma;
  flight.subject.imu_position = {10.0, 0.0, 0.0};
  const FlightSignals moved = flight.prepared(options);
  EXPECT_NEAR(moved[F::kAy].sigma, std::hypot(in_place, 10.0 * there[F::kRdot].sigma), 1e-12);
  EXPECT_GT(moved[F::kAy].sigma, 2.0 * in_place);
  EXPECT_EQ(moved[F::kAx].sigma, there[F::kAx].sigma);
}

TEST(FlightSignals, TakeTheVaneLessItsBiasOrTheSmoothersAngle) {
  FormulaFlight flight;
  flight.record("alpha", "rad", 0.1);
  flight.smoothed.set(sampled("alpha", "rad", [](double) { return 0.07; }));
  flight.smoothed.add(sampled("alpha_bias", "rad", [](double) { return 0.04; }));
  flight.smoothed.add(sampled("sigma_alpha", "rad", [](double) { return 0.01; }));
  const FlightSignals vane = flight.prepared();
  EXPECT_NEAR(vane[F::kAlpha].value[middle(vane)], 0.06, 1e-9);
  EXPECT_EQ(vane[F::kAlpha].error, ErrorKind::kClassical);
  EXPECT_THAT(vane.notes, Contains("vanes: estimated bias of alpha of 2.29 deg taken off"));
  EXPECT_EQ(vane[F::kBeta].origin, "smoother") << "there is no vane of that";
  SignalOptions options;
  options.flow_angles = FlowAngles::kSmoothed;
  const FlightSignals smoothed = flight.prepared(options);
  EXPECT_NEAR(smoothed[F::kAlpha].value[middle(smoothed)], 0.07, 1e-9);
  EXPECT_EQ(smoothed[F::kAlpha].error, ErrorKind::kBerkson);
  EXPECT_NEAR(smoothed[F::kAlpha].sigma, 0.01, 1e-12);
  // Root mean square of a sigma that is 0.3 and 0.4 m/s for one half each.
  EXPECT_NEAR(smoothed[F::kAirspeed].sigma, std::sqrt(0.125), 1e-3);
}

TEST(FlightSignals, FindWhereADeflectionJumpsWithinASample) {
  FormulaFlight flight;
  flight.record("elevator", "rad", [](double t) { return t < 4.995 ? -0.1 : 0.1; });
  flight.record("aileron", "rad", [](double t) { return 0.1 * std::sin(2.0 * kPi * t); });
  const FlightSignals s = flight.prepared();
  ASSERT_EQ(s.jumps.size(), 1U);
  EXPECT_EQ(s.jumps[0].control, F::kElevator);
  EXPECT_NEAR(s.grid.at(s.jumps[0].after), 5.0, 1e-9);
  double sum = 0.0;
  for (const double r : s.jump_response) sum += r;
  EXPECT_NEAR(sum, 1.0, 1e-12) << "a filter of unit gain";
  EXPECT_FALSE(s[F::kRudder].available());
  EXPECT_EQ(s.sample(0)[F::kRudder], 0.0);
}

TEST(FlightSignals, TakeThrustAsRecordedOrFromThePropulsion) {
  FormulaFlight flight;
  EXPECT_THAT(flight.prepared().notes, Contains("thrust is unknown: the log has neither thrust nor throttle"));
  flight.record("throttle", "1", 0.6);
  const FlightSignals s = flight.prepared();
  const std::size_t k = middle(s);
  const Propulsion& propulsion = flight.subject.propulsion;
  const auto thrust = [&](double Va) {
    return propulsion.load(0.6, Va, 1.225, propulsion.steady_rotor_speed(0.6)).thrust;
  };
  EXPECT_NEAR(s[F::kThrust].value[k], thrust(20.0), 1e-9);
  EXPECT_NEAR(s.thrust_per_airspeed[k], (thrust(20.01) - thrust(19.99)) / 0.02, 1e-6);
  flight.record("thrust", "N", 7.0);
  const FlightSignals recorded = flight.prepared();
  EXPECT_NEAR(recorded[F::kThrust].value[k], 7.0, 1e-9);
  EXPECT_TRUE(recorded.torque.empty());
  flight = {};
  flight.record("throttle", "1", 0.6);
  flight.subject.propulsion = {};
  EXPECT_THAT(flight.prepared().notes, Contains("thrust is unknown: the subject has no propulsion model"));
}

TEST(FlightSignals, MeasureNoiseOrTakeWhatIsGiven) {
  FormulaFlight flight;
  SignalOptions options;
  options.noise = {{"gyro_x", 0.02}};
  const FlightSignals s = flight.prepared(options);
  const numerics::FirKernel kernel = numerics::low_pass(s.filter);
  EXPECT_DOUBLE_EQ(s[F::kP].sigma, 0.02 * std::sqrt(kernel.noise_gain()));
  EXPECT_EQ(s[F::kQ].sigma, 0.0) << "a gyro that shows no noise";
  SensorSigma sheet;
  sheet.gyro = 0.01;
  const FlightSignals known = prepare_signals(flight.mapped, flight.smoothed, {}, flight.subject, options, &sheet);
  EXPECT_DOUBLE_EQ(known[F::kQ].sigma, 0.01 * std::sqrt(kernel.noise_gain()));
  EXPECT_DOUBLE_EQ(known[F::kP].sigma, s[F::kP].sigma) << "the user's word comes first";
}

TEST(FlightSignals, SayWhatTheyLack) {
  const auto refusal = [](const std::function<void(FormulaFlight&, SignalOptions&)>& spoil) {
    FormulaFlight flight;
    SignalOptions options;
    spoil(flight, options);
    return why([&] { static_cast<void>(flight.prepared(options)); });
  };
  EXPECT_THAT(refusal([](FormulaFlight&, SignalOptions& o) { o.flow_angles = FlowAngles::kVane; }),
              HasSubstr("has no alpha vane, which signals.flow_angles = \"vane\" asks for"));
  EXPECT_THAT(refusal([](FormulaFlight& f, SignalOptions&) {
                f.record(
                    "gyro_x", "rad/s", [](double) { return 0.0; }, 0.2);
              }),
              HasSubstr("its gyro is sampled at 5.0 Hz; derivatives need at least 10 Hz"));
  EXPECT_THAT(refusal([](FormulaFlight& f, SignalOptions&) {
                f.mapped.recording = aircraft::testing::without(f.mapped.recording, {"gyro_y"});
              }),
              HasSubstr("has no gyro_y"));
}

// What is not recorded costs what depends on it.
TEST(FlightSignals, AreNotAvailableWhereNothingIsRecorded) {
  FormulaFlight flight;
  flight.mapped.recording = aircraft::testing::without(flight.mapped.recording, {"accel_y"});
  flight.smoothed = aircraft::testing::without(flight.smoothed, {"roll"});
  const FlightSignals s = flight.prepared({});
  EXPECT_FALSE(s[F::kAy].available());
  EXPECT_TRUE(s[F::kAz].available());
  EXPECT_TRUE(std::isnan(s.roll.front()));
  EXPECT_TRUE(std::isfinite(s.pitch[s.size() / 2]));
}

TEST(SignalOptions, AreReadFromTheStudy) {
  const auto read = [](const std::string& text) {
    return SignalOptions::keys().read(Study::parse("[signals]\n" + text, "study.toml").root().table("signals"));
  };
  const SignalOptions given =
      read("rate = 50\npass_band = 4\nflow_angles = \"smoothed\"\nnoise = { alpha = \"1 deg\" }");
  EXPECT_EQ(given.rate_Hz, 50.0);
  EXPECT_EQ(given.pass_Hz, 4.0);
  EXPECT_EQ(given.flow_angles, FlowAngles::kSmoothed);
  ASSERT_EQ(given.noise.size(), 1U);
  EXPECT_DOUBLE_EQ(given.noise[0].second, kDegree);
  EXPECT_THAT(why([&] { static_cast<void>(read("flow_angles = \"vanes\"")); }), HasSubstr("vane"));
  EXPECT_THAT(why([&] { static_cast<void>(read("rate = -1")); }), HasSubstr("rate"));
}

}  // namespace
}  // namespace veridyn::aircraft
