#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "veridyn/vehicle/model/vehicle_parameters.hpp"
#include "veridyn/vehicle/vehicle_study.hpp"

/// Drives of cars whose bodies roll and whose wheels are loaded unequally, drawn at random: truth for the
/// identification, made by the four-wheel model and not tuned to.
namespace veridyn::vehicle::testing {

enum class CarTyre : std::size_t { kLinear, kFiala, kMagicFormula };

/// A car of the road.
struct RollingCar {
  VehicleParameters<double> parameters;
  double roll_gradient = 0.0;  ///< about what its springs, bars and tyres give [rad/(m/s^2)]
  double relaxation_length = 0.0;
};

/// Each number another car, drawn from: mass 900 to 2200 kg, wheelbase 2.3 to 3 m, 40 to 55 % of it in front of the
/// centre of gravity, whose height is 0.19 to 0.24 of it; track 0.55 to 0.62 of it; I_z 0.85 to 1.15 m a b; radius of
/// gyration in roll 0.36 to 0.42 of the track; front stiffness 14 to 22 times the wheel's static load per rad, rear
/// 1 to 1.4 times as much of its own; springs of 1.1 to 1.5 Hz, bars for a roll gradient of 3 to 7 deg/g of which 45 to
/// 65 % in front; dampers 0.2 to 0.4 of critical; a relaxation length of 0 (every third car) or 0.2 to 0.5 m.
[[nodiscard]] RollingCar rolling_car(std::size_t number);

inline constexpr std::size_t kRollingDrives = 6;

/// How long is driven, and what changes on the way: from `change_s` on every tyre pushes `grip` times as much at any
/// slip, and from `livelier_s` on the steering is twice as wide.
struct RollingDriveOptions {
  double duration_s = 90.0;
  double change_s = 1e9;
  double grip = 1.0;
  double livelier_s = 1e9;
  double noise = 1.0;  ///< over that of the reference sensors
};

/// A drive with reference sensors at 15, 20 or 25 m/s, gentle (0.05 to 0.8 Hz, 0.8 m/s^2 rms) or livelier (0.1 to
/// 1.2 Hz, 1.6 m/s^2 rms); mass, a and b are known.
[[nodiscard]] VehicleStudy rolling_drive(const RollingCar& car, CarTyre tyre, std::size_t drive, std::uint64_t seed,
                                         const RollingDriveOptions& options = {});

}  // namespace veridyn::vehicle::testing
