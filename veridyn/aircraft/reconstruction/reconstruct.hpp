#pragma once

#include <optional>
#include <string>
#include <vector>

#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/aircraft/reconstruction/observability.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_options.hpp"
#include "veridyn/aircraft/reconstruction/sensor_errors.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/core/recording.hpp"
#include "veridyn/estimation/kalman/innovation.hpp"

namespace veridyn::aircraft {

/// A sensor as the filter saw it.
struct SensorReport {
  std::string channel;  ///< "vel_north", "alpha"
  std::string unit;     ///< of `sigma`
  double sigma = 0.0;   ///< assumed white error per sample (1 sigma)
  double rate_Hz = 0.0;
  estimation::InnovationSummary innovations;
};

/// How well a quantity of the motion is known.
struct QuantityReport {
  std::string quantity;  ///< channel name, "beta"
  std::string unit;
  double prior_sigma = 0.0;  ///< from the assumed wind and turbulence (or the prior of the sensor error) alone
  double sigma = 0.0;        ///< median over the record, smoother
  Observability observability = Observability::kObservable;
  std::string statement;  ///< one sentence
};

/// What the guard of `filter = "guarded"` did.
struct GuardReport {
  double model_based_share = 0.0;    ///< of the time
  std::size_t reverts = 0;           ///< changes from the model-based to the model-free filter
  std::vector<TimeSpan> model_free;  ///< when the model was not trusted
  std::string statement;             ///< one sentence
};

/// A sensor that the filter refused for so long that what it measures was dead reckoning: it contradicts the others,
/// and one of them is wrong.
struct Contradiction {
  std::string channel;     ///< "vel_down"
  std::string against;     ///< "accelerometer and attitude"
  bool by_gyro = false;    ///< the attitude was reckoned from the gyro; else the velocity from the accelerometer
  TimeSpan span;           ///< from the first refusal to where the reconstruction ended
  double departure = 0.0;  ///< the largest of the reconstruction from the sensor, in `unit`
  double expected = 0.0;   ///< standard deviation that the filter expected of it
  std::string unit;        ///< SI
  std::string meaning;     ///< "as if the accelerometer were off by 9.8 m/s^2"
  std::string statement;   ///< one sentence
};

/// Errors of one filter and its smoother for one quantity, where the truth is known.
struct FilterError {
  std::string quantity;    ///< "alpha"
  std::string unit;        ///< SI
  double signal_sd = 0.0;  ///< standard deviation of the truth
  /// Of one filter and its smoother, in `unit`.
  struct Of {
    double filter_rms = 0.0, smoother_rms = 0.0, smoother_bias = 0.0;
    double filter_bound = 0.0, smoother_bound = 0.0;  ///< information bound; 0 where there is none
  };
  Of model_free, model_based;
};

/// The motion through the air, with error bars and reports.
///
/// `filtered` (what was known at the time) and `smoothed` (what is known from the whole record) hold the same channels
/// on the same stamps, SI, frame frd:
/// - `airspeed`, `alpha`, `beta`: of the centre of gravity relative to the air, gusts included;
/// - `air_velocity_x|y|z`: the same as a vector in body axes;
/// - `wind_north|east|down`: the slow wind; `wind_total_north|east|down`: with gusts, from where v = R v_r + wind;
/// - `gust_x|y|z`: the gusts in body axes (without sigma);
/// - `roll`, `pitch`, `yaw`, `vel_north|east|down`; `air_density` as used (no sigma);
/// - what the options estimate of `gyro_bias_x|y|z`, `accel_bias_x|y|z`, `alpha_bias`, `beta_bias`, `alpha_scale`,
///   `pitot_scale`, `pitot_bias`, `gyro_scale_x|y|z`, `accel_scale_x|y|z`;
/// - of the model-based filter: `CL_error`, `CD_error`, `CY_error`, by how much the coefficients of the model are off;
/// - of the guarded filter: `model_based` (1 where the estimate is the model-based filter's; `filtered` only) and
///   `guard_ratio` (squared innovations of the last window over their limit; no sigma).
/// Each has its `sigma_...` channel: one standard deviation; the 95 % band is +-1.96 sigma. Where gyro or accelerometer
/// are missing for longer than `max_gap` there are no samples.
struct Reconstruction {
  Recording smoothed;
  Recording filtered;              ///< empty unless `keep_filter`
  std::vector<TimeSpan> segments;  ///< stretches without a long gap, each estimated separately
  std::vector<SensorReport> sensors;
  /// Where `keep_innovations`: of each sensor the innovations of the forward pass under the channel's name, with
  /// `sigma_...`, the standard deviation that the filter expected, and `refused_...`, 1 where it was beyond the gate.
  Recording innovations;
  std::vector<QuantityReport> quantities;
  std::vector<SensorErrorReport> sensor_errors;  ///< those that were to be estimated
  std::optional<GuardReport> guard;
  /// Where the reconstruction ended because of one: the results then end where it began, and may be empty.
  std::optional<Contradiction> contradiction;
  std::vector<FilterError> comparison;  ///< filled by `compare_filters`, where the truth is known
  FilterKind filter = FilterKind::kModelFree;
  SensorSigma sigma;              ///< as used
  DrydenSettings turbulence;      ///< as used
  std::string turbulence_origin;  ///< "low_moderate", "auto: low altitude, 1.4 x light"
  std::string density_origin;     ///< "static pressure and temperature"
  double log_likelihood = 0.0;    ///< of all accepted innovations
  bool interrupted = false;       ///< the results end where the forward pass was stopped
  std::vector<std::string> warnings;
};

/// Why no filter can run on these channels: one clause ("the recording has neither attitude nor ground velocity"), or
/// empty. A recording of airspeed and vanes may be analysed as it is then (`filter = "none"`).
[[nodiscard]] std::string reconstruction_obstacle(const Recording& mapped, const ReconstructOptions& options);

/// Estimates airspeed, angles of attack and sideslip, and wind of a recording with standard channel names (frd): a
/// model-free extended Kalman filter (see AirDataModel) and its fixed-interval smoother, every sensor at its own time
/// stamps.
///
/// Needs `accel_x|y|z` and `gyro_x|y|z`, of attitude (`roll`, `pitch`) and ground velocity (`vel_north`, `vel_east`)
/// one, of ground velocity and airspeed one. Uses what there is of these, of `vel_down`, `yaw`, `dynamic_pressure` (or
/// else `airspeed`), `alpha`, `beta`, and for the air density `air_density`, `static_pressure`, `air_temperature`,
/// `alt`. `quantities` and the sigma channels show what is then not known:
/// - without a ground velocity, wind and motion over the ground are not distinguishable: the velocity is the one
/// through the slow
///   wind, and there are no channels of either;
/// - without heading it follows from the ground velocity in manoeuvres; without both there is no channel `yaw`;
/// - without attitude it follows from gyro, accelerometer and ground velocity, with the gyro's biases as states;
/// - without a pitot tube or vanes the air moves as the model of wind and gusts allows.
///
/// Each segment starts from the first attitude, ground velocity and airspeed: v_r points as the vanes show, without
/// vanes along the ground velocity, and is scaled to the airspeed; the rest of the ground velocity is wind.
/// @throws InputError as `reconstruction_obstacle` says, or that there is too little data.
///
/// Attitude, ground velocity and airspeed are corrected by one sensor each. Where that is refused for 10 s
/// (`dead_reckoning`), and a twentieth of the recording, longer than it is accepted, the estimate is dead reckoning,
/// which grows to absurd values with a small sigma: the reconstruction ends, and `contradiction` says which sensors
/// contradict each other. A short fault or dropout does not: the estimate is still near when the sensor is back.
///
/// The model-based and the guarded filter need `subject` with values for CL (and CD, CY as far as known), deflections,
/// and `thrust` or `throttle`; see ModelBasedAirData and GuardedFilter.
[[nodiscard]] Reconstruction reconstruct(const Recording& mapped, const ReconstructOptions& options, Progress& progress,
                                         const Subject* subject = nullptr);

}  // namespace veridyn::aircraft
