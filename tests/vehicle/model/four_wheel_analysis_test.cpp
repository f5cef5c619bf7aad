#include "veridyn/vehicle/model/four_wheel_analysis.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/vehicle/cars.hpp"
#include "veridyn/vehicle/manoeuvre/manoeuvre.hpp"
#include "veridyn/vehicle/simulation/vehicle_simulation.hpp"
#include "veridyn/vehicle/tyre/linear_tyre.hpp"

namespace veridyn::vehicle {
namespace {

using testing::road_car;

FourWheelModel<double, LinearTyre<double>> car_of(const VehicleParameters<double>& p, const FourWheelOptions& o = {}) {
  const LinearTyre<double> front{.stiffness = p.C_f}, rear{.stiffness = p.C_r};
  return {p, {front, front, rear, rear}, o};
}

// With the centre of gravity on the road nothing rolls: lateral and yaw motion are the bicycle's.
TEST(FourWheelAnalysis, WithoutHeightItIsTheLinearBicycle) {
  VehicleParameters<double> p = road_car();
  p.cg_height = 0.0;
  const LinearFourWheel linear = linearise(car_of(p), 25.0);
  const LinearBicycle<double> bicycle{p.mass, p.I_z, p.a, p.b, p.C_f, p.C_r, 25.0};
  EXPECT_LT((linear.A.topLeftCorner<2, 2>() - bicycle.A()).norm(), 1e-7 * bicycle.A().norm());
  EXPECT_LT((linear.B.head<2>() - bicycle.B()).norm(), 1e-7 * bicycle.B().norm());
  for (const double f : {0.3, 1.5}) {
    const FourWheelResponse four = frequency_response(linear, f);
    const BicycleResponse two = frequency_response(bicycle, f);
    EXPECT_LT(std::abs(four.yaw_rate - two.yaw_rate), 1e-7 * std::abs(two.yaw_rate));
    EXPECT_LT(std::abs(four.lateral_acceleration - two.lateral_acceleration),
              1e-7 * std::abs(two.lateral_acceleration));
    EXPECT_LT(std::abs(four.sideslip - two.sideslip), 1e-7 * std::abs(two.sideslip) + 1e-9);
  }
}

// Load transfer does not act on linear tyres: in steady cornering the gain is the bicycle's.
TEST(FourWheelAnalysis, SteadyYawRateIsTheBicyclesAndRollBalancesTheSprings) {
  const VehicleParameters<double> p = road_car();
  const LinearFourWheel linear = linearise(car_of(p), 25.0);
  const FourWheelResponse steady = frequency_response(linear, 1e-7);
  const BicycleCharacteristics<double> c =
      characteristics(LinearBicycle<double>{p.mass, p.I_z, p.a, p.b, p.C_f, p.C_r, 25.0});
  EXPECT_NEAR(steady.yaw_rate.real(), c.yaw_rate_gain, 1e-6 * c.yaw_rate_gain);
  // The tyres' forces m a_y at the road roll the body with arm c; springs in series with tyres resist, and the weight
  // of the sprung mass tilts on.
  const auto axle = [](double track, double spring, double tyre) {
    return 0.5 * track * track * spring * tyre / (spring + tyre);
  };
  const double stiffness = axle(p.track_f, p.K_sf, p.K_tf) + axle(p.track_r, p.K_sr, p.K_tr);
  const double sprung = p.mass - 4.0 * p.unsprung_mass;
  const double expected =
      p.mass * p.cg_height * c.lateral_acceleration_gain / (stiffness - sprung * 9.80665 * p.cg_height);
  EXPECT_NEAR(steady.roll.real(), expected, 1e-5 * expected);
}

TEST(FourWheelAnalysis, SteadyCorneringIsThatOfTheBicycleAndOfTheSprings) {
  const VehicleParameters<double> p = road_car();
  const double L = p.a + p.b;
  for (const double u : {10.0, 25.0}) {
    const LinearFourWheel linear = linearise(car_of(p), u);
    const SteadyCornering steady = steady_cornering(linear, L);
    const double K = p.mass * (p.b / p.C_f - p.a / p.C_r) / (2.0 * L);
    EXPECT_NEAR(steady.understeer_gradient, K, 1e-6 * K);
    const FourWheelResponse response = frequency_response(linear, 1e-7);
    EXPECT_NEAR(steady.roll_gradient * response.lateral_acceleration.real(), response.roll.real(), 1e-12);
  }
}

// A car that is the same in front and behind: heave and wheel hop are those of a quarter of it, eigenvalues of two
// masses.
TEST(FourWheelAnalysis, ASymmetricCarBouncesAsItsQuarter) {
  VehicleParameters<double> p = road_car();
  p.a = p.b = 1.2;
  p.K_sr = p.K_sf;
  p.C_sr = p.C_sf;
  const double m = 0.25 * p.mass - p.unsprung_mass, M = p.unsprung_mass;
  Eigen::Matrix4d quarter;  // body height, wheel height, their rates
  quarter << 0, 0, 1, 0, 0, 0, 0, 1, -p.K_sf / m, p.K_sf / m, -p.C_sf / m, p.C_sf / m, p.K_sf / M,
      -(p.K_sf + p.K_tf) / M, p.C_sf / M, -p.C_sf / M;
  const std::vector<FourWheelMode> found = modes(linearise(car_of(p), 20.0));
  for (const Mode& one : modes(Eigen::MatrixXd(quarter))) {
    EXPECT_TRUE(std::ranges::any_of(found, [&](const FourWheelMode& mode) {
      return std::abs(mode.eigenvalue - one.eigenvalue) < 1e-5 * std::abs(one.eigenvalue);
    })) << one.frequency_Hz;
  }
  const auto heave = std::ranges::find_if(found, [](const FourWheelMode& mode) { return mode.name == "heave"; });
  ASSERT_NE(heave, found.end());
  EXPECT_TRUE(heave->oscillates);
  EXPECT_NEAR(heave->frequency_Hz, modes(Eigen::MatrixXd(quarter))[0].frequency_Hz, 1e-5);
}

TEST(FourWheelAnalysis, EveryModeHasItsName) {
  const std::vector<FourWheelMode> found = modes(linearise(car_of(road_car()), 30.0));
  const auto has = [&](std::string_view name) {
    return std::ranges::count_if(found, [&](const FourWheelMode& mode) { return mode.name == name; });
  };
  EXPECT_EQ(has("lateral and yaw"), 1);
  EXPECT_EQ(has("heave"), 1);
  EXPECT_EQ(has("roll"), 1);
  EXPECT_EQ(has("pitch"), 1);
  EXPECT_EQ(has("front wheel hop, in phase"), 1);
  EXPECT_EQ(has("front wheel hop, opposed"), 1);
  EXPECT_EQ(has("rear wheel hop, in phase"), 1);
  EXPECT_EQ(has("rear wheel hop, opposed"), 1);
  for (const FourWheelMode& mode : found) EXPECT_TRUE(mode.stable) << mode.name;
  const auto order = [](const std::vector<FourWheelMode>& list) {
    long count = 0;
    for (const FourWheelMode& mode : list) count += mode.oscillates ? 2 : 1;
    return count;
  };
  EXPECT_EQ(order(found), 16);
  // Two of the four slip angles (left less right of an axle) drive nothing and only lag, at u over the length.
  const std::vector<FourWheelMode> lagged = modes(linearise(car_of(road_car(), {.relaxation_length = 0.3}), 30.0));
  EXPECT_EQ(order(lagged), 20);
  EXPECT_EQ(std::ranges::count_if(lagged,
                                  [](const FourWheelMode& mode) {
                                    return mode.name == "tyre lag" && std::abs(mode.eigenvalue + 100.0) < 1e-3;
                                  }),
            2);
}

// A small sine of steer, driven with the nonlinear model: the same gain and phase as the linear one's.
TEST(FourWheelAnalysis, SmallDrivesFollowTheFrequencyResponse) {
  const VehicleParameters<double> p = road_car();
  const auto car = car_of(p);
  const double f = 1.0, amplitude = 1e-4;
  Progress silent;
  const Manoeuvre m = sine_steer(amplitude, f, 0.0, 10);
  const VehicleTrajectory t = simulate(car, *m.driver, nullptr, {.duration = 10.0, .speed = 25.0}, silent);
  const FourWheelResponse linear = frequency_response(linearise(car, 25.0), f);
  // Fourier coefficient over the last two periods.
  const auto respond = [&](const std::vector<double>& x) {
    std::complex<double> sum = 0.0;
    for (int k = 800; k < 1000; ++k) {
      sum += x[k] * std::polar(1.0, -2.0 * std::numbers::pi * f * t.time[k]);
    }
    return sum / 100.0 * std::complex<double>(0.0, 1.0) / amplitude;  // the input is a sine
  };
  EXPECT_LT(std::abs(respond(t.r) - linear.yaw_rate), 1e-4 * std::abs(linear.yaw_rate));
  EXPECT_LT(std::abs(respond(t.roll) - linear.roll), 1e-4 * std::abs(linear.roll));
  EXPECT_LT(std::abs(respond(t.lateral_acceleration) - linear.lateral_acceleration),
            1e-4 * std::abs(linear.lateral_acceleration));
}

}  // namespace
}  // namespace veridyn::vehicle
