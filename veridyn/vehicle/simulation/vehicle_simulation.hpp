#pragma once

#include <span>

#include "veridyn/core/progress.hpp"
#include "veridyn/vehicle/model/bicycle_model.hpp"
#include "veridyn/vehicle/model/driver.hpp"
#include "veridyn/vehicle/model/four_wheel_model.hpp"
#include "veridyn/vehicle/model/vehicle_trajectory.hpp"
#include "veridyn/vehicle/road/road.hpp"

namespace veridyn::vehicle {

/// Length, steps and speed of a simulated drive.
struct SimulationOptions {
  double duration = 20.0;     ///< [s]
  double step = 1e-3;         ///< of the Runge-Kutta method [s]
  double output_step = 1e-2;  ///< between samples, a multiple of `step` [s]
  double speed = 20.0;        ///< u at the start; kept unless the model has longitudinal dynamics [m/s]

  /// Throws InputError("drive", ...) naming the first option that makes no sense.
  void validate() const;
};

/// The vehicle or its tyres change on the way (a wet stretch, a burst tyre): from `time` [s] on it is `model`, at the
/// first step that begins then.
template <typename Model>
struct ModelChange {
  double time = 0.0;
  Model model;
};

/// Drives `model` from rest in its springs, straight ahead along x from the origin, with the classical fourth-order
/// Runge-Kutta method. `road` may be null: flat. Samples are at multiples of `output_step` and at the end.
///
/// `driver.look` is called once a step. `changes` are by time. With longitudinal dynamics the spin of slow wheels
/// relaxes faster than a step follows (R^2 C_x/(I_w V), 4500 1/s at 2 m/s): such steps are taken in equal parts, at
/// most 256. Friction stops a wheel at the end of a part. Lift-off is resolved to a step.
///
/// Throws InputError on bad options, a step too long for the vehicle's stiffness, inadmissible parameters, and
/// controls out of range (steer not within 90 deg, negative brake torque, NaN), naming the time. Does not allocate
/// after the first step but for lift-offs beyond 64.
///
/// Compiled for the tyres of tyre_laws.hpp; with another tyre include vehicle_simulation_loop.hpp.
template <typename Tyre>
[[nodiscard]] VehicleTrajectory simulate(const FourWheelModel<double, Tyre>& model, Driver& driver, const Road* road,
                                         const SimulationOptions& options, Progress& progress,
                                         std::span<const ModelChange<FourWheelModel<double, Tyre>>> changes = {});

/// The same for the bicycle model: flat road, constant speed. Both tyres of an axle get the axle's values.
template <typename Tyre>
[[nodiscard]] VehicleTrajectory simulate(const BicycleModel<double, Tyre>& model, Driver& driver,
                                         const SimulationOptions& options, Progress& progress,
                                         std::span<const ModelChange<BicycleModel<double, Tyre>>> changes = {});

}  // namespace veridyn::vehicle
