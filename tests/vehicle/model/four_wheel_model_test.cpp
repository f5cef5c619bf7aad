#include "veridyn/vehicle/model/four_wheel_model.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <string>
#include <tuple>

#include "tests/vehicle/model/moments.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/vehicle/model/bicycle_model.hpp"

namespace veridyn::vehicle {
namespace {

using testing::any_moment;
using testing::every_option;
using testing::linear_car;
using testing::Moment;
using testing::rates_at;
using testing::trailing_car;
using testing::uneven_car;
using testing::with_longitudinal;

TEST(FourWheelModel, StandsStillInItsSpringsOnItsStaticLoads) {
  const VehicleParameters<double> p = uneven_car();
  const auto car = linear_car(p);
  const Moment rest{car.steady_start(20.0), 0.0, 0.0, 0.0, {}};
  const auto rates = rates_at(car, rest);
  for (Eigen::Index i = 0; i < kFourWheelStates; ++i) {
    EXPECT_EQ(rates.derivative(i), i == kX || i == kDistance ? 20.0 : 0.0) << i;
  }
  const double weight = p.mass * 9.80665;
  EXPECT_NEAR(rates.Fz(0) + rates.Fz(1) + rates.Fz(2) + rates.Fz(3), weight, 1e-9);
  EXPECT_NEAR(p.a * (rates.Fz(0) + rates.Fz(1)), p.b * (rates.Fz(2) + rates.Fz(3)), 1e-9);
  for (std::size_t i = 0; i < kWheels; ++i) EXPECT_EQ(rates.Fz(i), static_loads(p, 9.80665)[i]);
}

// Newton and Euler for the whole vehicle from the forces and their places alone.
TEST(FourWheelModel, ChangesMomentumByItsForces) {
  const VehicleParameters<double> p = uneven_car();
  std::mt19937_64 generator(1);
  for (const bool longitudinal : {false, true}) {
    const auto car = linear_car(p, longitudinal ? with_longitudinal({.grade = 0.05}) : FourWheelOptions{});
    for (int round = 0; round < 50; ++round) {
      const Moment m = any_moment(generator);
      const auto rates = rates_at(car, m);
      const auto& d = rates.derivative;
      Eigen::Vector3d force(rates.holding_force, 0.0, 0.0), moment(0.0, 0.0, 0.0);
      if (longitudinal) {
        force.x() -= 0.5 * 1.225 * 0.65 * m.state(kU) * m.state(kU) + p.mass * 9.80665 * std::sin(0.05);
      }
      for (std::size_t i = 0; i < kWheels; ++i) {
        const double angle = is_front(i) ? m.steer : 0.0;
        const Eigen::Vector3d in_wheel(rates.Fx(i), rates.Fy(i), rates.Fz(i));
        const Eigen::Vector3d f = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) * in_wheel;
        force += f;
        moment +=
            Eigen::Vector3d(car.wheel_x()(signed_index(i)), car.wheel_y()(signed_index(i)), -p.cg_height).cross(f);
      }
      EXPECT_NEAR(p.mass * (d(kU) - m.state(kR) * m.state(kV)), force.x(), 1e-7);
      EXPECT_NEAR(p.mass * (d(kV) + m.state(kR) * m.state(kU)), force.y(), 1e-7);
      EXPECT_NEAR(p.I_z * d(kR), moment.z(), 1e-7);
      double vertical = (p.mass - 4.0 * p.unsprung_mass) * d(kHeaveRate);
      for (Eigen::Index i = 0; i < 4; ++i) vertical += p.unsprung_mass * d(kWheelHeightRate + i);
      const double across = 9.80665 * (longitudinal ? std::cos(0.05) : 1.0);
      EXPECT_NEAR(vertical, force.z() - p.mass * across, 1e-7);
    }
  }
}

/// The mirrored motion.
Moment in_mirror(const Moment& m) {
  Moment out = m;
  for (const Eigen::Index i : {kY, kYaw, kV, kR, kRoll, kRollRate}) out.state(i) = -m.state(i);
  for (const Eigen::Index block : {kWheelHeight, kWheelHeightRate, kWheelSpin, kLaggedSlip}) {
    for (Eigen::Index i = 0; i < 4; ++i) {
      out.state(block + i) = (block == kLaggedSlip ? -1.0 : 1.0) * m.state(block + (i ^ 1));
    }
  }
  for (std::size_t i = 0; i < kWheels; ++i) out.road[i] = m.road[mirrored(i)];
  out.steer = -m.steer;
  return out;
}

TEST(FourWheelModel, TreatsLeftAndRightEquallyToTheLastBit) {
  std::mt19937_64 generator(3);
  for (const auto& [longitudinal, every, lag] :
       {std::tuple{false, false, 0.3}, {true, false, 0.3}, {false, true, 0.0}, {true, true, 0.3}}) {
    FourWheelOptions options = every ? every_option() : FourWheelOptions{};
    if (longitudinal) options.longitudinal.emplace();
    options.ackermann = 0.4;
    options.relaxation_length = lag;
    options.camber_per_roll = 0.2;
    const auto car = trailing_car(uneven_car(), options);
    for (int round = 0; round < 100; ++round) {
      const Moment m = any_moment(generator);
      Moment rates{rates_at(car, m).derivative, 0.0, 0.0, 0.0, {}};
      const FourWheelState<double> reflected = rates_at(car, in_mirror(m)).derivative,
                                   expected = in_mirror(rates).state;
      for (Eigen::Index i = 0; i < kFourWheelStates; ++i) EXPECT_EQ(reflected(i), expected(i)) << i;
    }
  }
}

TEST(FourWheelModel, BecomesTheBicycleInSecondOrderOfTrackAndHeight) {
  const auto difference = [](double track, double height) {
    VehicleParameters<double> p;
    p.track_f = p.track_r = track;
    p.cg_height = height;
    const auto car = linear_car(p);
    const BicycleModel<double, LinearTyre<double>> bicycle{p, {.stiffness = p.C_f}, {.stiffness = p.C_r}};
    Moment m{car.steady_start(20.0), 0.06, 0.0, 0.0, {}};
    m.state(kV) = -0.3;
    m.state(kR) = 0.5;
    m.state(kRollRate) = 20.0 * height;  // as lateral forces at the road would have it: in proportion to the height
    m.state(kPitchRate) = 5.0 * height;
    const auto rates = rates_at(car, m);
    const auto expected = bicycle.rates(-0.3, 0.5, 0.06, 20.0);
    return std::hypot(rates.derivative(kV) - expected.dv, rates.derivative(kR) - expected.dr);
  };
  EXPECT_LT(difference(1e-9, 0.0), 1e-11);
  EXPECT_NEAR(difference(0.2, 0.0) / difference(0.1, 0.0), 4.0, 0.01);
  EXPECT_NEAR(difference(1e-9, 0.02) / difference(1e-9, 0.01), 4.0, 0.05);
}

TEST(FourWheelModel, SteersAfterAckermannTowardsOneTurningCentre) {
  FourWheelOptions options;
  options.ackermann = 1.0;
  const auto car = linear_car(uneven_car(), options);
  const double L = 2.25, W = 1.45;
  for (const double steer : {0.3, -0.2}) {
    const auto wheels = car.wheel_controls(steer);
    EXPECT_NEAR(1.0 / std::tan(wheels.steer[1]) - 1.0 / std::tan(wheels.steer[0]), W / L, 1e-12);
    EXPECT_NEAR(0.5 / std::tan(wheels.steer[1]) + 0.5 / std::tan(wheels.steer[0]), 1.0 / std::tan(steer), 1e-12);
  }
  options.ackermann = 0.0;
  const auto parallel = linear_car(uneven_car(), options).wheel_controls(0.3);
  EXPECT_EQ(parallel.steer[0], 0.3);
  EXPECT_EQ(parallel.steer[1], 0.3);
}

TEST(FourWheelModel, LagsItsSlipByTheRelaxationLength) {
  FourWheelOptions options;
  options.relaxation_length = 0.5;
  const auto car = linear_car(uneven_car(), options);
  Moment m{car.steady_start(20.0), 0.05, 0.0, 0.0, {}};
  m.state.segment<4>(kLaggedSlip).setConstant(0.02);
  const auto rates = rates_at(car, m);
  EXPECT_EQ(rates.slip_angle(0), 0.02);
  EXPECT_NEAR(rates.Fy(0), 60000.0 * 0.02, 1e-9);
  EXPECT_NEAR(rates.derivative(kLaggedSlip), (0.05 - 0.02) * 20.0 * std::cos(0.05) / 0.5, 1e-9);
  EXPECT_NEAR(rates.derivative(kLaggedSlip + 2), -0.02 * 20.0 / 0.5, 1e-9);
}

struct LeaningTyre {
  [[nodiscard]] TyreForces<double> forces(const double& load, const double& /*ratio*/, const double& /*angle*/,
                                          const double& camber) const {
    return {0.0, load * camber};
  }
  [[nodiscard]] double cornering_stiffness(const double& load) const { return load; }
};

TEST(FourWheelModel, LeansItsWheelsWithTheBody) {
  FourWheelOptions options;
  options.camber_per_roll = 0.3;
  const FourWheelModel<double, LeaningTyre> car(uneven_car(), {}, options);
  FourWheelState<double> state = car.steady_start(20.0);
  state(kRoll) = 0.1;
  FourWheelRates<double> rates;
  car.rates(state, car.wheel_controls(0.0), {}, rates);
  for (Eigen::Index i = 0; i < 4; ++i) EXPECT_NEAR(rates.Fy(i), 0.03 * rates.Fz(i), 1e-9);
}

TEST(FourWheelModel, HasTheDerivativesOfItsDifferences) {
  constexpr std::size_t kParameters = kVehicleFields.size() - 1;  // without mu, which is infinite
  using Jet = ceres::Jet<double, kParameters>;
  const VehicleParameters<double> p = uneven_car();
  VehicleParameters<Jet> with_parts = p.cast<Jet>();
  for (std::size_t i = 0; i < kParameters; ++i) field_of(with_parts, i).v(i) = 1.0;
  FourWheelOptions options = every_option();
  options.longitudinal.emplace();
  const auto car = trailing_car(with_parts, options);
  std::mt19937_64 generator(4);
  Moment m = any_moment(generator);
  m.state.segment<4>(kWheelHeight) *= 0.1;  // all on the ground: smooth
  m.road = {};
  FourWheelRates<Jet> rates;
  car.rates(m.state.cast<Jet>(), car.wheel_controls(Jet(m.steer), m.drive, m.brake), m.road, rates);
  for (std::size_t i = 0; i < kParameters; ++i) {
    const double step = 1e-5 * field_of(p, i);
    VehicleParameters<double> more = p, less = p;
    field_of(more, i) += step;
    field_of(less, i) -= step;
    const FourWheelState<double> slope =
        (rates_at(trailing_car(more, options), m).derivative - rates_at(trailing_car(less, options), m).derivative) /
        (2.0 * step);
    for (Eigen::Index k = 0; k < kFourWheelStates; ++k) {
      EXPECT_NEAR(rates.derivative(k).v(i), slope(k), 1e-6 * (1e-3 + std::abs(slope(k))))
          << kVehicleFields[i].name << " to state " << k;
    }
  }
}

}  // namespace
}  // namespace veridyn::vehicle
