#include "veridyn/vehicle/model/bicycle_analysis.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "tests/vehicle/exact_step_response.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/ode.hpp"
#include "veridyn/vehicle/model/builtin_vehicles.hpp"
#include "veridyn/vehicle/tyre/linear_tyre.hpp"
#include "veridyn/vehicle/tyre/simple_magic_formula.hpp"

namespace veridyn::vehicle {
namespace {

LinearBicycle<double> bicycle_of(const VehicleParameters<double>& p, double u) {
  return {p.mass, p.I_z, p.a, p.b, p.C_f, p.C_r, u};
}
LinearBicycle<double> reference(double u = 20.0) { return bicycle_of({}, u); }

VehicleParameters<double> oversteering() {
  VehicleParameters<double> p;
  p.C_f = 80000.0;
  p.C_r = 60000.0;
  return p;
}

// The linear model is the derivative of the nonlinear one, whatever the tyre: by automatic differentiation of the model
// itself at straight running.
TEST(BicycleAnalysis, IsTheDerivativeOfTheModelWithAnyTyre) {
  using Jet = ceres::Jet<double, 3>;  // v, r, steer
  BicycleModel<double, SimpleMagicFormulaTyre<double>> model;
  model.front = {.stiffness = 55000.0, .nominal_load = 3000.0, .stiffness_saturation = 0.6};
  model.rear = {.stiffness = 90000.0, .nominal_load = 3000.0, .stiffness_saturation = 0.4};
  BicycleModel<Jet, SimpleMagicFormulaTyre<Jet>> jets{model.parameters.cast<Jet>(), model.front.cast<Jet>(),
                                                      model.rear.cast<Jet>()};
  const double u = 17.0;
  const BicycleRates<Jet> rates = jets.rates(Jet(0.0, 0), Jet(0.0, 1), Jet(0.0, 2), Jet(u));
  const LinearBicycle<double> linear = linearise(model, u);
  const Eigen::Matrix2d A = linear.A();
  for (int j = 0; j < 2; ++j) {
    EXPECT_NEAR(rates.dv.v(j), A(0, j), 1e-10);
    EXPECT_NEAR(rates.dr.v(j), A(1, j), 1e-10);
    EXPECT_NEAR(rates.lateral_acceleration.v(j), linear.C()(1, j), 1e-10);
  }
  EXPECT_NEAR(rates.dv.v(2), linear.B()(0), 1e-10);
  EXPECT_NEAR(rates.dr.v(2), linear.B()(1), 1e-10);
  EXPECT_NEAR(rates.lateral_acceleration.v(2), linear.D()(1), 1e-10);
}

// m (b/C_f - a/C_r)/(2 L) = 1100 (1/60000 - 1.25/120000)/4.5.
TEST(BicycleAnalysis, KnowsTheNumbersOfTheReferenceCar) {
  const BicycleCharacteristics<double> c = characteristics(reference());
  EXPECT_NEAR(c.understeer_gradient, 1100.0 / 4.5 * (6.25e-6), 1e-15);
  EXPECT_NEAR(c.understeer_gradient * 9.80665 / kDegree, 0.858, 5e-4);
  EXPECT_NEAR(c.characteristic_speed, std::sqrt(2.25 / c.understeer_gradient), 1e-12);
  EXPECT_TRUE(std::isinf(c.critical_speed));
  EXPECT_NEAR(c.static_margin, (1.0 * 120000.0 - 1.25 * 60000.0) / 180000.0 / 2.25, 1e-15);
  EXPECT_NEAR(c.yaw_rate_gain * 5.0, 34.9515, 5e-5);  // the published steady yaw rate at 5 deg
}

TEST(BicycleAnalysis, GainsAreThoseOfTheSteadyState) {
  for (const LinearBicycle<double>& s : {reference(), reference(45.0), bicycle_of(oversteering(), 15.0)}) {
    const BicycleCharacteristics<double> c = characteristics(s);
    const Eigen::Vector2d x = -s.A().fullPivLu().solve(s.B());
    const Eigen::Vector3d y = s.C() * x + s.D();
    EXPECT_NEAR(c.yaw_rate_gain, y(0), 1e-11);
    EXPECT_NEAR(c.lateral_acceleration_gain, y(1), 1e-10);
    EXPECT_NEAR(c.sideslip_gain, y(2), 1e-11);
    EXPECT_NEAR(c.curvature_gain, y(0) / s.u, 1e-12);
  }
}

// At the characteristic speed of an understeering car the yaw rate gain is largest; at the critical speed of an
// oversteering one an eigenvalue is zero.
TEST(BicycleAnalysis, CharacteristicAndCriticalSpeedAreWhereTheySay) {
  const double u = characteristics(reference()).characteristic_speed;
  const double top = characteristics(reference(u)).yaw_rate_gain;
  EXPECT_LT(characteristics(reference(u * 1.01)).yaw_rate_gain, top);
  EXPECT_LT(characteristics(reference(u * 0.99)).yaw_rate_gain, top);
  const double critical = characteristics(bicycle_of(oversteering(), 10.0)).critical_speed;
  EXPECT_NEAR(bicycle_of(oversteering(), critical).A().determinant(), 0.0, 1e-10);
  EXPECT_TRUE(modes(bicycle_of(oversteering(), critical * 0.99).A())[0].stable);
  const auto beyond = bicycle_of(oversteering(), critical * 1.01);
  EXPECT_FALSE(modes(beyond.A())[0].stable);
  EXPECT_TRUE(std::isnan(characteristics(beyond).damping_ratio));
  EXPECT_TRUE(std::isnan(characteristics(beyond).bandwidth));
}

TEST(BicycleAnalysis, FrequencyAndDampingAreThoseOfTheEigenvalues) {
  const LinearBicycle<double> s = reference(35.0);
  const BicycleCharacteristics<double> c = characteristics(s);
  const std::vector<Mode> found = modes(s.A());
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found[0].oscillates);
  EXPECT_NEAR(found[0].frequency_Hz * 2.0 * std::numbers::pi, c.natural_frequency, 1e-11);
  EXPECT_NEAR(found[0].damping_ratio, c.damping_ratio, 1e-12);
}

// Exact solution against a Runge-Kutta integration of the model: oscillating, creeping and unstable.
TEST(BicycleAnalysis, TheStepResponseSolvesTheEquationsOfMotion) {
  for (const LinearBicycle<double>& s : {reference(), reference(40.0), bicycle_of(oversteering(), 20.0)}) {
    const double steer = 0.03;
    const auto derivative = [&](double, const Eigen::Vector2d& x) {
      return Eigen::Vector2d(s.A() * x + s.B() * steer);
    };
    Eigen::Vector2d x = Eigen::Vector2d::Zero();
    for (int k = 0; k < 800; ++k) x = numerics::runge_kutta_4_step(derivative, k * 1e-3, x, 1e-3);
    const testing::BicycleStepResponse exact = testing::step_response(s, steer, 0.8);
    EXPECT_NEAR(exact.v, x(0), 1e-8);
    EXPECT_NEAR(exact.r, x(1), 1e-8);
    EXPECT_NEAR(exact.lateral_acceleration, derivative(0.0, x)(0) + s.u * x(1), 1e-6);
  }
  EXPECT_EQ(testing::step_response(reference(), 0.03, -1.0).r, 0.0);
}

// The closed forms against the frequency response itself.
TEST(BicycleAnalysis, BandwidthPeakAndEquivalentTimeAreWhereTheResponseHasThem) {
  for (const double u : {8.0, 20.0, 40.0}) {
    const LinearBicycle<double> s = reference(u);
    const BicycleCharacteristics<double> c = characteristics(s);
    const auto yaw = [&](double omega) { return frequency_response(s, omega / (2.0 * std::numbers::pi)).yaw_rate; };
    EXPECT_NEAR(std::abs(yaw(1e-6)), c.yaw_rate_gain, 1e-6);
    EXPECT_NEAR(std::abs(yaw(c.bandwidth)), c.yaw_rate_gain / std::numbers::sqrt2, 1e-10);
    EXPECT_NEAR(std::arg(yaw(1.0 / c.equivalent_time)), -std::numbers::pi / 4.0, 1e-10);
    double most = 0.0;
    for (int i = 0; i <= 4000; ++i) most = std::max(most, std::abs(yaw(0.01 * i + 1e-9)));
    EXPECT_NEAR(c.peak_ratio * c.yaw_rate_gain, most, 1e-5 * most) << u;
    if (c.peak_frequency > 0.0) {
      EXPECT_NEAR(std::abs(yaw(c.peak_frequency)), c.peak_ratio * c.yaw_rate_gain, 1e-10);
    }
  }
}

}  // namespace
}  // namespace veridyn::vehicle
