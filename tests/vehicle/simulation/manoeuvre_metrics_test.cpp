#include "veridyn/vehicle/simulation/manoeuvre_metrics.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/vehicle/exact_step_response.hpp"
#include "tests/vehicle/simulation/metric_value.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/vehicle/model/bicycle_analysis.hpp"
#include "veridyn/vehicle/simulation/vehicle_simulation.hpp"
#include "veridyn/vehicle/tyre/linear_tyre.hpp"

namespace veridyn::vehicle {
namespace {

using testing::value;

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
    const auto yaw = [&](double t) { return testing::step_response(bicycle, steer, t).r; };
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
