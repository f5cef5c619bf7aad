#include "veridyn/vehicle/simulation/manoeuvre_metrics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "veridyn/core/constants.hpp"
#include "veridyn/vehicle/model/bicycle_analysis.hpp"
#include "veridyn/vehicle/simulation/vehicle_simulation.hpp"
#include "veridyn/vehicle/tyre/linear_tyre.hpp"

namespace veridyn::vehicle {
namespace {

double value(const std::vector<Metric>& list, std::string_view name) {
  const auto found = std::ranges::find_if(list, [&](const Metric& m) { return m.name == name; });
  EXPECT_NE(found, list.end()) << name;
  return found == list.end() ? std::nan("") : found->value;
}

BicycleModel<double, LinearTyre<double>> linear_car() {
  const VehicleParameters<double> p;
  return {p, {.stiffness = p.C_f}, {.stiffness = p.C_r}, 9.80665, BicycleGeometry::kSmallAngles};
}

VehicleTrajectory drive(const Manoeuvre& m, double speed) {
  Progress silent;
  return simulate(linear_car(), *m.driver,
                  {.duration = m.default_duration, .step = 1e-3, .output_step = 1e-3, .speed = speed}, silent);
}

// A second-order system with a zero, its metrics from the exact step response; the simulated ramp is 2 ms long.
TEST(ManoeuvreMetrics, StepSteerAgreesWithTheClosedForm) {
  for (const double u : {20.0, 40.0}) {
    const LinearBicycle<double> bicycle = linearise(linear_car(), u);
    const BicycleCharacteristics<double> c = characteristics(bicycle);
    const double steer = 0.02;
    const std::vector<Metric> list = step_steer_metrics(drive(step_steer(steer, 1.0, 2e-3), u));
    const auto yaw = [&](double t) { return step_response(bicycle, steer, t).r; };
    const double steady = c.yaw_rate_gain * steer;
    double t90 = 0.0;
    while (yaw(t90) < 0.9 * steady) t90 += 1e-5;
    double peak_time = 0.0, peak = 0.0;
    for (double t = 0.0; t < 3.0; t += 1e-4) {
      if (yaw(t) > peak) {
        peak = yaw(t);
        peak_time = t;
      }
    }
    EXPECT_NEAR(value(list, "yaw_rate_gain"), c.yaw_rate_gain, 1e-5 * c.yaw_rate_gain);
    EXPECT_NEAR(value(list, "lateral_acceleration_gain"), c.lateral_acceleration_gain,
                1e-5 * c.lateral_acceleration_gain);
    EXPECT_NEAR(value(list, "sideslip_gain"), c.sideslip_gain, 2e-4);  // atan(v/u) against v/u
    EXPECT_NEAR(value(list, "yaw_rate_response_time"), t90, 2e-5);
    EXPECT_NEAR(value(list, "yaw_rate_peak_response_time"), peak_time, 1e-3);
    EXPECT_NEAR(value(list, "yaw_rate_overshoot"), peak / steady - 1.0, 2e-5);
    EXPECT_NEAR(value(list, "tb_factor"), peak_time * std::abs(c.sideslip_gain) * steer, 1e-4);
  }
}

TEST(ManoeuvreMetrics, ASlowlyGrowingSteerShowsTheUndersteerGradient) {
  const double u = 25.0;
  const BicycleCharacteristics<double> c = characteristics(linearise(linear_car(), u));
  const VehicleTrajectory t = drive(slowly_increasing_steer(0.03, 0.0005), u);
  const std::vector<Metric> list = steady_state_metrics(t, 2.25);
  // The ramp lags by the equivalent time of the vehicle; the slope does not.
  EXPECT_NEAR(value(list, "understeer_gradient"), c.understeer_gradient, 1e-3 * c.understeer_gradient);
  EXPECT_NEAR(value(list, "sideslip_gradient"), c.sideslip_gain / c.lateral_acceleration_gain, 1e-6);
  // Turned to the right it is the same.
  const std::vector<Metric> right = steady_state_metrics(drive(slowly_increasing_steer(-0.03, 0.0005), u), 2.25);
  EXPECT_NEAR(value(right, "understeer_gradient"), value(list, "understeer_gradient"), 1e-15);
}

// Measured from sweep and random steer, against the state-space model.
TEST(ManoeuvreMetrics, FrequencyResponsesOfDrivesAreThoseOfTheModel) {
  const double u = 30.0;
  const LinearBicycle<double> bicycle = linearise(linear_car(), u);
  const BicycleCharacteristics<double> c = characteristics(bicycle);
  for (const Manoeuvre& m : {sweep_steer(0.01, 0.1, 5.0, 60.0), random_steer(0.01, 0.1, 5.0, 60.0, 3)}) {
    const MeasuredFrequencyResponse measured = measured_frequency_response(drive(m, u), 0.2, 4.2);
    ASSERT_GT(measured.yaw_rate.size(), 20U);
    for (std::size_t i = 0; i < measured.yaw_rate.size(); ++i) {
      const auto& yaw = measured.yaw_rate[i];
      const BicycleResponse exact = frequency_response(bicycle, yaw.frequency_Hz);
      // What is left is leakage between segments: the vehicle rings on for a second, segments are 10 s and longer.
      EXPECT_LT(std::abs(yaw.response - exact.yaw_rate), 0.02 * c.yaw_rate_gain) << yaw.frequency_Hz;
      EXPECT_LT(std::abs(measured.lateral_acceleration[i].response - exact.lateral_acceleration),
                0.03 * c.lateral_acceleration_gain)
          << yaw.frequency_Hz;
      EXPECT_GT(yaw.coherence, 0.98);
    }
    const std::vector<Metric> list = frequency_response_metrics(measured);
    EXPECT_NEAR(value(list, "yaw_rate_bandwidth"), c.bandwidth / (2.0 * kPi), 0.03 * c.bandwidth / (2.0 * kPi));
    EXPECT_NEAR(value(list, "yaw_rate_phase_1Hz"), std::arg(frequency_response(bicycle, 1.0).yaw_rate), 0.03);
  }
}

// The yaw rate of the linear car is gone 1 s after the steer; the lateral displacement is that of the simulation.
TEST(ManoeuvreMetrics, SineWithDwellMeasuresWhereTheStandardSays) {
  const Manoeuvre m = sine_with_dwell(0.04);
  const VehicleTrajectory t = drive(m, 80.0 / 3.6);
  const std::vector<Metric> list = sine_with_dwell_metrics(t);
  EXPECT_NEAR(value(list, "lateral_displacement_1.07s"), std::abs(t.y[2070]), 2e-3);
  EXPECT_LT(std::abs(value(list, "yaw_rate_ratio_1.00s")), 0.01);
  // A vehicle that keeps turning shows it: its yaw rate grows from the end of steer on.
  VehicleTrajectory spin = t;
  const double end = 1.0 + 1.0 / 0.7 + 0.5;
  for (std::size_t i = 0; i < spin.size(); ++i) {
    if (spin.time[i] > end) spin.r[i] = 0.4 * (spin.time[i] - end) * value(list, "second_yaw_rate_peak");
  }
  EXPECT_NEAR(value(sine_with_dwell_metrics(spin), "yaw_rate_ratio_1.00s"), 0.4, 2e-3);  // the end to a sample
  EXPECT_NEAR(value(sine_with_dwell_metrics(spin), "yaw_rate_ratio_1.75s"), 0.7, 2e-3);
}

// Frequency weighting W_k of ISO 2631-1:1997, table 3, at nominal third-octave frequencies, to the printed digits.
TEST(ManoeuvreMetrics, WeightsVibrationAsTheStandardPrints) {
  const std::pair<double, double> table[] = {{0.5, 0.418}, {1.0, 0.482}, {2.0, 0.531},  {2.5, 0.631},  {4.0, 0.967},
                                             {6.3, 1.054}, {8.0, 1.036}, {10.0, 0.988}, {20.0, 0.636}, {40.0, 0.314}};
  for (const auto& [frequency, weight] : table) EXPECT_NEAR(iso2631_weight(frequency), weight, 6e-4) << frequency;
  EXPECT_EQ(iso2631_weight(0.0), 0.0);
}

// A heave of amplitude A at 4 Hz: rms acceleration A w^2/sqrt(2), weighted by W_k(4 Hz).
TEST(ManoeuvreMetrics, RideIsTheRmsOfTheWeightedAcceleration) {
  VehicleTrajectory t;
  const double w = 2.0 * kPi * 4.0;
  for (int k = 0; k < 10000; ++k) {
    t.time.push_back(k * 1e-3);
    t.heave_rate.push_back(0.01 * w * std::cos(w * t.time.back()));
    for (auto& load : t.Fz) load.push_back(3000.0 + 300.0 * std::sin(w * t.time.back()));
  }
  const std::vector<Metric> list = ride_metrics(t);
  const double expected = 0.01 * w * w / std::numbers::sqrt2;
  EXPECT_NEAR(value(list, "vertical_acceleration_rms"), expected, 2e-4 * expected);  // central differences, (w h)^2/6
  EXPECT_NEAR(value(list, "weighted_vertical_acceleration_rms"), expected * iso2631_weight(4.0), 3e-4 * expected);
  EXPECT_NEAR(value(list, "wheel_load_variation"), 0.1 / std::numbers::sqrt2, 1e-9);
  EXPECT_TRUE(ride_metrics(VehicleTrajectory{}).empty());
}

TEST(ManoeuvreMetrics, PeaksShowLoadTransferAndTheLightestWheel) {
  VehicleTrajectory t;
  t.time = {0.0, 1.0};
  t.u = {20.0, 20.0};
  t.v = {0.0, -1.0};
  t.r = {0.0, 0.4};
  t.lateral_acceleration = {0.0, 8.0};
  t.Fz = {{{3000.0, 500.0}, {3000.0, 5500.0}, {2000.0, 1000.0}, {2000.0, 3000.0}}};
  const std::vector<Metric> list = peak_metrics(t);
  EXPECT_DOUBLE_EQ(value(list, "peak_load_transfer_ratio"), 0.7);
  EXPECT_NEAR(value(list, "smallest_wheel_load"), 500.0 / 3000.0, 1e-15);
  EXPECT_NEAR(value(list, "peak_sideslip"), std::atan(0.05), 1e-15);
}

TEST(ManoeuvreMetrics, EveryManoeuvreHasItsOwn) {
  const VehicleParameters<double> p;
  const Manoeuvre m = step_steer(0.02);
  const std::vector<Metric> list = manoeuvre_metrics(drive(m, 20.0), m, p);
  EXPECT_GT(value(list, "yaw_rate_response_time"), 0.0);
  EXPECT_GT(value(list, "peak_lateral_acceleration"), 0.0);
  for (const Metric& metric : list) EXPECT_FALSE(metric.unit.empty()) << metric.name;
}

}  // namespace
}  // namespace veridyn::vehicle
