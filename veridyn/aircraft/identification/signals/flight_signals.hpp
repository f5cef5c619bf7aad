#pragma once

#include <array>
#include <string>
#include <vector>

#include "veridyn/aircraft/identification/signals/air_rates.hpp"
#include "veridyn/aircraft/identification/signals/measured_coefficients.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/aircraft/reconstruction/corrected_flow.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_options.hpp"
#include "veridyn/aircraft/sensors/channel_map.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/numerics/filters.hpp"
#include "veridyn/recording/grid_signals.hpp"

namespace veridyn::aircraft {

/// What flow angles coefficients are regressed on.
enum class FlowAngles {
  kAuto,     ///< a vane's where there is one, else the smoother's
  kVane,     ///< the filtered vane: its error is independent of the truth, and total least squares corrects for it
  kSmoothed  ///< the smoother's: their error is independent of the estimate, so that least squares needs no correction
};

/// How recorded channels become signals for regression. Study table `[signals]`.
struct SignalOptions {
  double rate_Hz = 0.0;  ///< of the common grid; 0: by the gyro
  double pass_Hz = 0.0;  ///< kept unchanged; 0: by the rate
  FlowAngles flow_angles = FlowAngles::kAuto;
  recording::GivenNoise noise;  ///< what is not given is measured

  [[nodiscard]] static const KeyTable<SignalOptions>& keys();
};

using recording::ErrorKind;
using recording::GridSignal;

/// A deflection that jumps from one sample to the next, as of a servo without lag: when between the two is not known.
struct DeflectionJump {
  FlightSignal control = FlightSignal::kElevator;
  std::size_t after = 0;  ///< the first grid point with the new value
};

/// All signals of a flight on one uniform grid, through one zero-phase filter, so that a relation that is linear in the
/// unfiltered signals holds for the filtered ones too.
struct FlightSignals : recording::GridSignals<FlightSignal, kFlightSignals> {
  numerics::LowPassDesign filter;
  std::size_t stride = 1;  ///< every stride-th sample is as good as all: the pass band's Nyquist rate
  std::vector<DeflectionJump> jumps;
  /// What an impulse midway between two samples becomes, from `-jump_response.size() / 2` samples before the second on.
  std::vector<double> jump_response;
  std::vector<double> air_density;
  /// Change of a computed thrust with the airspeed that it is computed from [N s/m]; empty where it is recorded.
  std::vector<double> thrust_per_airspeed;
  std::vector<double> torque;                            ///< reaction torque of the engine about x [N m]; empty without
  std::vector<double> roll, pitch, yaw;                  ///< smoothed attitude
  double roll_sigma = 0.0, pitch_sigma = 0.0;            ///< typical error of these [rad]; 0: not known
  std::vector<double> vel_north, vel_east, vel_down;     ///< smoothed ground velocity; without: through the mean air
  bool over_ground = false;                              ///< whether that is the velocity over ground
  std::vector<double> wind_north, wind_east, wind_down;  ///< smoothed slow wind
  std::vector<double> alpha_smoothed, beta_smoothed;     ///< the smoother's, whatever is regressed on

  AirRates air_rates;  ///< beside the body's own

  /// The sample at grid point k; missing signals are 0.
  [[nodiscard]] FlightSample<double> sample(std::size_t k) const;
  /// The same with the rates against the air.
  [[nodiscard]] FlightSample<double> sample_in_air(std::size_t k) const { return air_rates.against_air(sample(k), k); }
};

/// Resamples, filters and differentiates the mapped channels; takes airspeed, attitude, wind and (where there is no
/// vane) flow angles from the reconstruction `smoothed` (channels `airspeed`, `alpha`, `sigma_airspeed`, ...). The
/// accelerometer is moved to the centre of gravity. Thrust is the channel `thrust` or, with `throttle`, the subject's
/// propulsion model.
/// `vanes` is what is known of them (`flow_sensors`): angles are those of the centre of gravity, by `corrected_flow`.
/// `known` gives the sensors' noise where their data sheet is known; otherwise it is measured.
/// Where `smoothed.information` says that the airspeed is as recorded, its error is taken for a classical one.
/// What the recording and `smoothed` lack is not available, and attitude and wind are NaN.
/// @param threads  0: as many as the machine has
/// @throws InputError when gyro or smoothed airspeed are missing.
[[nodiscard]] FlightSignals prepare_signals(const MappedRecording& mapped, const Recording& smoothed,
                                            const FlowSensors& vanes, const Subject& subject,
                                            const SignalOptions& options, const SensorSigma* known = nullptr,
                                            int threads = 0);

}  // namespace veridyn::aircraft
