#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/spectral_response.hpp"
#include "veridyn/vehicle/manoeuvre/lane_change.hpp"
#include "veridyn/vehicle/manoeuvre/manoeuvre.hpp"
#include "veridyn/vehicle/model/vehicle_trajectory.hpp"
#include "veridyn/vehicle/simulation/steady_turn.hpp"

namespace veridyn::vehicle {

/// A number that describes a test drive.
struct Metric {
  std::string name;    ///< "yaw_rate_response_time"
  double value = 0.0;  ///< NaN when the drive does not show it
  std::string unit;    ///< SI; "rad s^2/m"
  std::string source;  ///< "ISO 7401"
  std::string meaning{};
};

/// The metrics of a manoeuvre's standard, then peaks, then those of the ride where the road is uneven.
[[nodiscard]] std::vector<Metric> manoeuvre_metrics(const VehicleTrajectory& trajectory, const Manoeuvre& manoeuvre,
                                                    const VehicleParameters<double>& parameters,
                                                    double gravity = kGravity);

/// ISO 7401 step input. Steady state is the mean of the last fifth of the drive; times count from where the steer
/// crosses half its steady value: to 90 % of the steady value (response time), to the first maximum (peak response
/// time); overshoot (peak - steady)/steady; gains per steer; TB factor: peak response time of the yaw rate times the
/// steady sideslip angle [s rad].
[[nodiscard]] std::vector<Metric> step_steer_metrics(const VehicleTrajectory& trajectory);

/// ISO 19365, FMVSS 126: lateral displacement of the centre of gravity 1.07 s after the beginning of steer; yaw rate
/// 1.0 s and 1.75 s after the end of steer over its second peak (which may be at most 35 % and 20 %).
[[nodiscard]] std::vector<Metric> sine_with_dwell_metrics(const VehicleTrajectory& trajectory);

/// ISO 4138: slopes over lateral acceleration, by least squares over the samples between `low` and `high` [m/s^2] of
/// absolute lateral acceleration, from the time `begin` [s] on: understeer gradient d(delta - L/R)/d a_y, sideslip
/// gradient, roll gradient (where there is a roll angle); understeer and roll also in deg/g.
[[nodiscard]] std::vector<Metric> steady_state_metrics(const VehicleTrajectory& trajectory, double wheelbase,
                                                       double begin = 0.0, double low = kGentlestTurn,
                                                       double high = kSharpestGentleTurn);

/// ISO 3888-1: whether and by how much the body stayed within the lanes; entry speed and peaks.
[[nodiscard]] std::vector<Metric> lane_change_metrics(const VehicleTrajectory& trajectory,
                                                      const DoubleLaneChange& course, const BodyOutline& body);

/// Our own: cones hit and passed, smallest margin, entry speed and the lowest one between the cones.
[[nodiscard]] std::vector<Metric> slalom_metrics(const VehicleTrajectory& trajectory, const Slalom& course,
                                                 const BodyOutline& body);

/// The gradients of `steady_state_metrics`, and the steer where lateral acceleration is largest.
[[nodiscard]] std::vector<Metric> ramp_steer_metrics(const VehicleTrajectory& trajectory, double wheelbase);

/// Of the manoeuvre of ISO 7975, our own choice: mean deceleration in the second from half a second after the pedal
/// moves, yaw rate 1 s after it moves over that before, and over what the speed left would have on the same circle; the
/// change of sideslip in that second.
[[nodiscard]] std::vector<Metric> braking_in_a_turn_metrics(const VehicleTrajectory& trajectory, double brake_time);

/// Responses to steer, estimated from a sweep or random steer (Welch's method, see `numerics::spectral_response`).
struct MeasuredFrequencyResponse {
  std::vector<numerics::ResponseEstimate> yaw_rate;              ///< [1/s]
  std::vector<numerics::ResponseEstimate> lateral_acceleration;  ///< [m/s^2/rad]
  std::vector<numerics::ResponseEstimate> sideslip;              ///< [1]
  std::vector<numerics::ResponseEstimate> roll;                  ///< [1]; empty when the model has none
};
/// Segments of two periods of the lowest frequency, at least 8 s and at most a quarter of the drive. Needs evenly
/// spaced samples. @throws InputError as `numerics::spectral_response`.
[[nodiscard]] MeasuredFrequencyResponse measured_frequency_response(const VehicleTrajectory& trajectory, double low_Hz,
                                                                    double high_Hz);
/// ISO 7401 frequency domain: steady gain (mean of the lowest third of an octave), bandwidth where the yaw rate gain
/// has fallen by 3 dB, peak and its frequency, phase lag at 1 Hz, smallest coherence.
[[nodiscard]] std::vector<Metric> frequency_response_metrics(const MeasuredFrequencyResponse& response);

/// Peaks of lateral acceleration, yaw rate, sideslip, roll; largest lateral load transfer ratio
/// |left - right|/(left + right) of normal forces (1: wheels of a side lift), smallest normal force over its static
/// value.
[[nodiscard]] std::vector<Metric> peak_metrics(const VehicleTrajectory& trajectory, double gravity = kGravity);

/// Vertical comfort: rms of the vertical acceleration of the sprung mass, plain and weighted with W_k of ISO 2631-1,
/// rms of suspension travel and of the change of wheel load over its mean. Empty when the model has no vertical motion.
[[nodiscard]] std::vector<Metric> ride_metrics(const VehicleTrajectory& trajectory);

/// |W_k| of ISO 2631-1 (1997, annex A) at a frequency: vertical vibration of seated people. 0.63 at 2.5 Hz and 1.05
/// near 6 Hz.
[[nodiscard]] double iso2631_weight(double frequency_Hz);

}  // namespace veridyn::vehicle
