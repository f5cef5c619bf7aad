#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/vehicle/manoeuvre/driver_model.hpp"
#include "veridyn/vehicle/manoeuvre/lane_change.hpp"
#include "veridyn/vehicle/manoeuvre/path.hpp"
#include "veridyn/vehicle/manoeuvre/piecewise_linear.hpp"
#include "veridyn/vehicle/manoeuvre/slalom.hpp"
#include "veridyn/vehicle/model/driver.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"

namespace veridyn::vehicle {

/// What a drive tests; most are those of a standard.
enum class ManoeuvreKind {
  kReference,          ///< steer 0 until 2 s, ramp to 5 deg at 3 s, held to 15 s, ramp to 0 at 16 s
  kStepSteer,          ///< ISO 7401: a ramp of `rise_time` to `amplitude`, held
  kSine,               ///< ISO 7401: one period
  kContinuousSine,     ///< ISO 7401: `periods` of them
  kSineWithDwell,      ///< ISO 19365, FMVSS 126: 0.7 Hz, 500 ms dwell at the second peak
  kSweep,              ///< frequency growing exponentially from `frequency` to `end_frequency`
  kRandomSteer,        ///< ISO 7401: band-limited, from a seed
  kFishhook,           ///< ramp to the amplitude, dwell, ramp to the opposite one, held (NHTSA fixed timing)
  kSteadyStateCircle,  ///< ISO 4138: constant speed and slowly growing steer, or constant radius and growing speed
  kDoubleLaneChange,   ///< ISO 3888-1, driven by a preview driver
  kObstacleAvoidance,  ///< ISO 3888-2, driven by a preview driver
  kSlalom,             ///< cones in a line, driven by a preview driver: our own
  kRampSteer,          ///< steer growing at a rate at constant speed, to the limit and held: our own
  kBrakingInATurn,     ///< ISO 7975: a circle at constant speed, then brakes with the steering held
  kFollowPath,         ///< a path from a file or a circle, driven by a preview driver
  kSignal              ///< a recorded or written steering signal
};
/// As studies and reports name it.
[[nodiscard]] std::string_view to_string(ManoeuvreKind kind);

/// A driver and what metrics and reports need to know of the test.
struct Manoeuvre {
  ManoeuvreKind kind = ManoeuvreKind::kReference;
  std::unique_ptr<Driver> driver;
  double default_duration = 20.0;  ///< [s]
  double start = 0.0;              ///< when the steering begins [s]
  double amplitude = 0.0;          ///< at the road wheels, positive left [rad]
  double rise_time = 0.0;          ///< of a step's ramp [s]
  double frequency = 0.0;          ///< of a sine, or the lowest of a sweep or random steer [Hz]
  double end_frequency = 0.0;      ///< the highest [Hz]
  double radius = 0.0;             ///< of a constant-radius circle [m]
  std::optional<DoubleLaneChange> course{};
  std::optional<Slalom> slalom{};
  double brake_time = 0.0;  ///< when braking begins [s]; 0: never
  BodyOutline body{};
  std::shared_ptr<const Path> path{};  ///< which is followed: from the origin along x, where simulations start
  /// Speed over time that the manoeuvre needs to vary; empty: constant.
  PiecewiseLinear speed{};
};

// Open loop. Angles at the road wheels [rad], times [s], frequencies [Hz]. All throw InputError for amplitudes beyond
// 90 deg, times and frequencies that are not > 0.

/// 5 deg: that of the published similarity study (see ManoeuvreKind::kReference).
[[nodiscard]] Manoeuvre reference_manoeuvre();
/// The ramp crosses half the amplitude at start + rise_time/2. ISO 7401 allows at most 0.15 s between 10 and 90 %.
[[nodiscard]] Manoeuvre step_steer(double amplitude, double start = 1.0, double rise_time = 0.1);
/// `periods` of a sine from `start` on.
[[nodiscard]] Manoeuvre sine_steer(double amplitude, double frequency, double start = 1.0, int periods = 1);
/// One period that waits for `dwell` at its second peak.
[[nodiscard]] Manoeuvre sine_with_dwell(double amplitude, double start = 1.0, double frequency = 0.7,
                                        double dwell = 0.5);
/// Instantaneous frequency low (high/low)^((t - start)/duration); begins at phase 0, fades out over
/// the last half second.
[[nodiscard]] Manoeuvre sweep_steer(double amplitude, double low = 0.1, double high = 4.0, double duration = 60.0,
                                    double start = 1.0);
/// A sum of cosines of equal power and random phase at multiples of 1/duration from `low` to `high`, scaled to a peak
/// of `amplitude`: a stationary band-limited signal without trend.
[[nodiscard]] Manoeuvre random_steer(double amplitude, double low = 0.1, double high = 4.0, double duration = 60.0,
                                     std::uint64_t seed = 1, double start = 1.0);
/// The same; the number of cosines grows with the square of the duration, 10 minutes take seconds. Once `progress` is
/// interrupted the rest of the signal is 0.
[[nodiscard]] Manoeuvre random_steer(double amplitude, double low, double high, double duration, std::uint64_t seed,
                                     double start, const Progress& progress);
/// A ramp to the amplitude at `rate` [rad/s], dwell, a ramp to the opposite one, held for 3 s.
[[nodiscard]] Manoeuvre fishhook(double amplitude, double rate, double start = 1.0, double dwell = 0.25);
/// Steer growing at `rate` [rad/s] to `amplitude`.
[[nodiscard]] Manoeuvre slowly_increasing_steer(double amplitude, double rate, double start = 1.0);
/// Steer growing at `rate` [rad/s] to `amplitude`, held for `hold` [s]: from straight running to the limit in seconds.
[[nodiscard]] Manoeuvre ramp_steer(double amplitude, double rate, double start = 1.0, double hold = 2.0);
/// Steer and torques [N m] over time, straight between samples.
[[nodiscard]] Manoeuvre steering_signal(PiecewiseLinear steer, PiecewiseLinear drive_torque = {},
                                        PiecewiseLinear brake_torque = {});

/// What reading a manoeuvre needs to know of the vehicle.
struct ManoeuvreContext {
  VehicleParameters<double> parameters;
  double speed = 20.0;
  double gravity = kGravity;
  std::uint64_t seed = 1;
  double wheel_radius = 0.30;  ///< for the torque of a driver who holds a speed [m]
  /// Cornering stiffnesses of one tyre that a driver expects; those of the parameters when absent.
  std::optional<double> C_f{}, C_r{};
};

// Torques, for models with longitudinal dynamics; whatever steers goes on.

/// A manoeuvre with drive and brake torques over time [N m]: braking or power off in a turn (ISO 7975, ISO 9816).
/// @throws InputError for a negative brake torque.
[[nodiscard]] Manoeuvre with_torques(Manoeuvre manoeuvre, PiecewiseLinear drive_torque, PiecewiseLinear brake_torque);
/// A manoeuvre in which drive and brakes hold a speed over time [m/s] (`SpeedControlledDriver`).
[[nodiscard]] Manoeuvre with_speed_control(Manoeuvre manoeuvre, PiecewiseLinear speed, const ManoeuvreContext& context);

/// What a driver expects of the vehicle. @throws InputError when the speed is not > 0.
[[nodiscard]] LinearBicycle<double> expected_bicycle(const ManoeuvreContext& context);

// Closed loop: a preview driver (MacAdam 1981) with the linear bicycle of the context as its internal model.

/// `vehicle_width` 0: 7/6 of the track.
[[nodiscard]] Manoeuvre double_lane_change(const ManoeuvreContext& context, double vehicle_width = 0.0,
                                           double course_scale = 1.0, const PreviewDriverOptions& options = {});
/// `vehicle_width` 0: 7/6 of the track.
[[nodiscard]] Manoeuvre obstacle_avoidance(const ManoeuvreContext& context, double vehicle_width = 0.0,
                                           double course_scale = 1.0, const PreviewDriverOptions& options = {});
/// At the speed of the context along the path of a `slalom_course`.
[[nodiscard]] Manoeuvre slalom(const ManoeuvreContext& context, Slalom course,
                               const PreviewDriverOptions& options = {});
/// On a circle of `radius` [m] (negative: to the right) at the speed of the context, kept by drive torque; from
/// `brake_time` [s] on brakes of `deceleration` [m/s^2] (as torque at the wheels, mass times radius) with the steering
/// held. @throws InputError for numbers that are not > 0 (radius: 0).
[[nodiscard]] Manoeuvre braking_in_a_turn(const ManoeuvreContext& context, double radius, double deceleration,
                                          double brake_time = 15.0, const PreviewDriverOptions& options = {});
/// From the beginning of the path, moved to the origin along x; ends after its length at the speed of the context.
[[nodiscard]] Manoeuvre follow_path(const ManoeuvreContext& context, std::shared_ptr<const Path> path,
                                    const PreviewDriverOptions& options = {});
/// A circle of constant radius (negative: to the right) on which the speed grows from `context.speed` to `end_speed`
/// over `duration`, by drive torque.
[[nodiscard]] Manoeuvre constant_radius_circle(const ManoeuvreContext& context, double radius, double end_speed,
                                               double duration = 120.0, const PreviewDriverOptions& options = {});

/// As studies name them; the first is the default.
[[nodiscard]] std::span<const std::string> manoeuvre_names();

/// Reads `[drive]`: `manoeuvre` and its keys, see manoeuvre_keys.hpp.
///
/// Keys that other readers take from `[drive]` (speed, duration, step, ...) are left to them. An interrupted `progress`
/// ends the preparation of a random steer early.
/// @throws InputError with file, line and key: unknown manoeuvres with the nearest name, steer beyond 90 deg, a speed
/// that is not > 0.
[[nodiscard]] Manoeuvre read_manoeuvre(const StudyTable& drive, const ManoeuvreContext& context,
                                       const Progress& progress);

}  // namespace veridyn::vehicle
