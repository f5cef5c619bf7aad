#pragma once

#include <array>
#include <string>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/result/estimate.hpp"
#include "veridyn/vehicle/identification/vehicle_identification.hpp"
#include "veridyn/vehicle/tracking/axle_curve.hpp"

namespace veridyn::vehicle {

/// Where tracking knows a body from.
enum class BodySource {
  kNone,      ///< nowhere: the vehicle is taken for one that does not lean, on tyres that push at once
  kLearned,   ///< from the beginning of the drive
  kEstimate,  ///< from the estimate that tracking starts from
};

/// What tracking takes as known of a vehicle beside mass, a and b: it does not change with the road.
struct KnownBody {
  BodySource source = BodySource::kNone;
  double I_z = 0.0;                             ///< [kg m^2]
  BodyRoll<double> roll = {};                   ///< gradient 0: it does not lean
  double relaxation_length = 0.0;               ///< of the tyres [m]
  double a = kNaN;                              ///< where it was estimated [m]
  double accel_scale = 0.0, steer_scale = 0.0;  ///< of the sensors, measured over true less 1
  bool accepted = true;                         ///< whether the estimate that it comes from may be used
  /// How tyres saturate, by their own stiffnesses: shape only.
  AnyRollingBicycle tyres = {};
  /// What is not known of it makes of C_f, C_r and the understeer gradient: standard deviations, the stiffnesses' as a
  /// share of them, the gradient's in rad/(m/s^2).
  std::array<double, 3> sigma{};
  std::string text = {};  ///< one sentence: what is known, or why nothing is
};

/// Of an estimate as `identify` writes it, of an earlier drive; what it does not have is that of the vehicle.
[[nodiscard]] KnownBody known_body(const estimation::Estimate& estimate, const VehicleParameters<double>& vehicle,
                                   const DriveModelOptions& options);

/// Learned by identifying the beginning of the drive (`identify_parameters`). Without a usable stretch, or
/// where no method gives an estimate: kNone.
[[nodiscard]] KnownBody learned_body(const DriveSignals& signals, const DriveSegmentOptions& segment_options,
                                     const VehicleParameters<double>& vehicle, const DriveSignalOptions& signal_options,
                                     const VehicleIdentifyOptions& options, Progress& progress);

}  // namespace veridyn::vehicle
