#pragma once

#include <Eigen/Core>
#include <string>

#include "veridyn/aircraft/reconstruction/reconstruct_options.hpp"
#include "veridyn/core/recording.hpp"
#include "veridyn/recording/channel_map.hpp"

namespace veridyn::aircraft {

/// What the study says of the vanes, and what the reconstruction found of them: a vane at `position` shows
/// (1 + scale) times the angle of the flow there, and a bias.
struct FlowSensors {
  Eigen::Vector3d position{0.0, 0.0, 0.0};   ///< from the centre of gravity, body axes [m]
  bool beta_is_flank = false;                ///< atan2(v, u) in place of asin(v/Va)
  double alpha_bias = 0.0, beta_bias = 0.0;  ///< [rad]
  double alpha_scale = 0.0;

  [[nodiscard]] bool exact() const {
    return position.isZero(0.0) && !beta_is_flank && alpha_bias == 0.0 && beta_bias == 0.0 && alpha_scale == 0.0;
  }
};

/// @param smoothed the reconstruction's, of whose `alpha_bias`, `beta_bias` and `alpha_scale` the medians are taken
[[nodiscard]] FlowSensors flow_sensors(const ReconstructOptions& options, const Recording& smoothed);

/// A recording with the flow angles of the centre of gravity.
struct CorrectedFlow {
  recording::MappedRecording mapped;
  std::string note;  ///< what was done; empty: nothing
};

/// The recording with `alpha` and `beta` of the centre of gravity at the stamps of the vanes: biases and scale taken
/// off, and the velocity omega x r that rotation adds at the vanes. The reconstruction's angle stands in for a vane
/// that is missing or has no value. Without rates or airspeed there is no angle.
/// @param smoothed with `airspeed` [m/s], and `alpha`, `beta` [rad] where they are known
[[nodiscard]] CorrectedFlow with_corrected_flow(recording::MappedRecording mapped, const FlowSensors& sensors,
                                                const Recording& smoothed);

}  // namespace veridyn::aircraft
