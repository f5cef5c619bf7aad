#include "veridyn/vehicle/model/bicycle_model.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/ode.hpp"
#include "veridyn/vehicle/tyre/linear_tyre.hpp"

namespace veridyn::vehicle {
namespace {

/// Zero until 2 s, ramp to 5 deg at 3 s, held until 15 s, back to zero at 16 s.
double reference_steer(double t) {
  return 5.0 * kDegree * std::min(std::clamp(t - 2.0, 0.0, 1.0), std::clamp(16.0 - t, 0.0, 1.0));
}

BicycleModel<double, LinearTyre<double>> linear_prototype() {
  const VehicleParameters<double> p;
  return {p, {.stiffness = p.C_f}, {.stiffness = p.C_r}, 9.80665, BicycleGeometry::kSmallAngles};
}

using State = Eigen::Matrix<double, 5, 1>;  // v, r, yaw, x, y

State reference_run(double until) {
  const auto model = linear_prototype();
  const double u = 20.0;
  const auto derivative = [&](double t, const State& s) {
    const BicycleRates<double> rates = model.rates(s(0), s(1), reference_steer(t), u);
    State d;
    d << rates.dv, rates.dr, s(1), u * std::cos(s(2)) - s(0) * std::sin(s(2)),
        u * std::sin(s(2)) + s(0) * std::cos(s(2));
    return d;
  };
  State s = State::Zero();
  const int steps = static_cast<int>(std::lround(until * 1000.0));
  for (int k = 0; k < steps; ++k) s = numerics::runge_kutta_4_step(derivative, k * 1e-3, s, 1e-3);
  return s;
}

// The published values of the reference manoeuvre, to their printed digits.
TEST(BicycleModel, DrivesTheReferenceManoeuvreToThePrintedDigits) {
  const auto model = linear_prototype();
  const State ten = reference_run(10.0);
  EXPECT_NEAR(ten(1) / kDegree, 34.9515, 5e-5);
  EXPECT_NEAR(ten(0), -0.01130, 5e-6);
  const BicycleRates<double> rates = model.rates(ten(0), ten(1), reference_steer(10.0), 20.0);
  EXPECT_NEAR(rates.Fy[0], 2982.31, 5e-3);
  EXPECT_NEAR(rates.Fy[1], 3727.89, 5e-3);
  EXPECT_NEAR(rates.slip_angle[0] / kDegree, 2.84790, 5e-6);
  EXPECT_NEAR(rates.slip_angle[1] / kDegree, 1.77994, 5e-6);
  EXPECT_NEAR(std::hypot(20.0, ten(0)) / ten(1), 32.786, 5e-4);
  const State twenty = reference_run(20.0);
  EXPECT_NEAR(twenty(2) / kDegree, 454.369, 5e-4);
  EXPECT_NEAR(twenty(3), 77.274, 5e-4);
  EXPECT_NEAR(twenty(4), 124.700, 5e-4);
}

// Steady state of the linear model: r = u delta/(L + K_us u^2) with K_us = m (b/C_f - a/C_r)/(2 L) (Gillespie 1992,
// eq. 6-15).
TEST(BicycleModel, SettlesWhereTheUndersteerGradientSays) {
  const auto model = linear_prototype();
  const VehicleParameters<double>& p = model.parameters;
  const double K = p.mass * (p.b / p.C_f - p.a / p.C_r) / (2.0 * p.wheelbase());
  const double delta = 5.0 * kDegree;
  EXPECT_NEAR(reference_run(14.9)(1), 20.0 * delta / (p.wheelbase() + K * 400.0), 1e-9);
}

TEST(BicycleModel, ExactGeometryDiffersFromTheLinearInThirdOrderOfTheAngles) {
  auto exact = linear_prototype();
  exact.geometry = BicycleGeometry::kExact;
  const auto linear = linear_prototype();
  const auto difference = [&](double scale) {
    const double v = 0.3 * scale, r = 0.2 * scale, delta = 0.05 * scale;
    return exact.rates(v, r, delta, 20.0).dr - linear.rates(v, r, delta, 20.0).dr;
  };
  EXPECT_NEAR(difference(0.5) / difference(1.0), 0.125, 0.002);  // no even orders: left and right are equal
}

}  // namespace
}  // namespace veridyn::vehicle
