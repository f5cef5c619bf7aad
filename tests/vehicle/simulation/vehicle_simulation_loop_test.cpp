#include "veridyn/vehicle/simulation/vehicle_simulation_loop.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/vehicle/simulation/drives.hpp"

namespace veridyn::vehicle {
namespace {

using testing::bumps;
using testing::car_with_bars;
using testing::drive;
using testing::linear_car;
using testing::LinearCar;
using testing::SignalRoad;
using testing::slalom;

TEST(FourWheelSimulation, ConvergesInFourthOrderOfTheStep) {
  const SignalRoad road(bumps);
  const auto car = linear_car(car_with_bars());
  const auto run = [&](double step) {
    return drive(car, slalom, {.duration = 2.0, .step = step, .output_step = 2.0}, &road);
  };
  const auto exact = run(1.25e-4);
  ASSERT_TRUE(exact.lift_offs.empty()) << exact.message();
  const auto error = [&](const VehicleTrajectory& at) {
    double sum = 0.0;
    for (const auto column :
         {&VehicleTrajectory::r, &VehicleTrajectory::roll, &VehicleTrajectory::y, &VehicleTrajectory::heave_rate}) {
      sum = std::hypot(sum, (at.*column).back() - (exact.*column).back());
    }
    return sum;
  };
  const double coarse = error(run(4e-3)), fine = error(run(2e-3)), finer = error(run(1e-3));
  EXPECT_NEAR(std::log2(coarse / fine), 4.0, 0.25);
  EXPECT_NEAR(std::log2(fine / finer), 4.0, 0.25);
}

// One Jet through the whole drive against runs with changed parameters.
TEST(FourWheelSimulation, CarriesDerivativesThroughTheWholeDrive) {
  using Jet = ceres::Jet<double, 4>;
  constexpr std::size_t kParameters[] = {0, 6, 10, 12};  // mass, height, C_f, K_sf
  const VehicleParameters<double> p = car_with_bars();
  VehicleParameters<Jet> moving = p.cast<Jet>();
  for (Eigen::Index j = 0; j < 4; ++j) field_of(moving, kParameters[j]).v(j) = 1.0;
  const LinearCar<Jet> car = linear_car(moving);
  FourWheelState<Jet> state = car.steady_start(Jet(20.0));
  const auto flat = [](const FourWheelState<Jet>&) { return PerWheel<double>{}; };
  const auto at = [&](double t) { return car.wheel_controls(slalom(t)); };
  for (int k = 0; k < 2000; ++k) {
    const double t = k * 1e-3;
    const std::array<WheelControls<Jet>, 3> controls{at(t), at(t + 5e-4), at(t + 1e-3)};
    FourWheelRates<Jet> rates;
    car.rates(state, controls[0], {}, rates);
    four_wheel_step(car, flat, controls, 1e-3, rates, state);
  }
  const SimulationOptions options{.duration = 2.0};
  const auto run = drive(linear_car(p), slalom, options);
  EXPECT_NEAR(state(kYaw).a, run.yaw.back(), 1e-12);
  EXPECT_NEAR(state(kRoll).a, run.roll.back(), 1e-12);
  for (Eigen::Index j = 0; j < 4; ++j) {
    VehicleParameters<double> more = p, less = p;
    const double step = 1e-4 * field_of(p, kParameters[j]);
    field_of(more, kParameters[j]) += step;
    field_of(less, kParameters[j]) -= step;
    const auto up = drive(linear_car(more), slalom, options), down = drive(linear_car(less), slalom, options);
    const auto slope = [&](const std::vector<double> VehicleTrajectory::*column) {
      return ((up.*column).back() - (down.*column).back()) / (2.0 * step);
    };
    const double y = slope(&VehicleTrajectory::y), roll = slope(&VehicleTrajectory::roll);
    EXPECT_NEAR(state(kY).v(j), y, 1e-5 * std::abs(y)) << kVehicleFields[kParameters[j]].name;
    EXPECT_NEAR(state(kRoll).v(j), roll, 1e-5 * std::abs(roll)) << kVehicleFields[kParameters[j]].name;
  }
}

TEST(FourWheelSimulation, TakesStepsUpToWhatItSaysAndNotBeyond) {
  const auto car = linear_car(car_with_bars());
  const double fastest = internal::fastest_rates(car, 20.0).all;
  // Stable at the limit, beyond it the simulation diverges: shown with the step function itself.
  const auto spread = [&](double factor) {
    const double h = factor * 2.5 / fastest;
    FourWheelState<double> state = car.steady_start(20.0);
    state(kWheelHeightRate) = 0.01;
    const auto straight = car.wheel_controls(0.0);
    const auto flat = [](const FourWheelState<double>&) { return PerWheel<double>{}; };
    FourWheelRates<double> rates;
    for (int k = 0; k < 500; ++k) {
      car.rates(state, straight, {}, rates);
      four_wheel_step(car, flat, {straight, straight, straight}, h, rates, state);
    }
    return state.segment<4>(kWheelHeight).norm();
  };
  EXPECT_LT(spread(1.0), 1e-6);
  EXPECT_GT(spread(1.25), 1e-3);
}

}  // namespace
}  // namespace veridyn::vehicle
