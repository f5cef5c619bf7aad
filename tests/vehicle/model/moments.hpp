#pragma once

#include <random>

#include "tests/vehicle/cars.hpp"

namespace veridyn::vehicle::testing {

/// Unlike in front and behind in everything, with bars: nothing cancels.
[[nodiscard]] VehicleParameters<double> uneven_car();

/// Axles of which nothing that can be asked for is left out, unlike in front and behind; lift and aligning moments.
[[nodiscard]] FourWheelOptions every_option();

/// State, controls and road of a four-wheel car at one moment.
struct Moment {
  FourWheelState<double> state;
  double steer, drive, brake;
  PerWheel<double> road;
};

/// Any motion, wheels off the ground among them.
[[nodiscard]] Moment any_moment(std::mt19937_64& generator);

[[nodiscard]] FourWheelRates<double> rates_at(const LinearCar<double>& car, const Moment& m);

}  // namespace veridyn::vehicle::testing
