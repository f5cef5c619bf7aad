#pragma once

#include <optional>
#include <span>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/estimation/open_loop/open_loop.hpp"
#include "veridyn/estimation/result/estimate.hpp"
#include "veridyn/vehicle/identification/options/drive_open_loop_options.hpp"
#include "veridyn/vehicle/identification/signals/drive_path.hpp"
#include "veridyn/vehicle/identification/signals/drive_segments.hpp"
#include "veridyn/vehicle/identification/signals/drive_signals.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"

namespace veridyn::vehicle {

/// The identified vehicle driven open loop: integrated from recorded steering and speed alone.
struct DriveOpenLoop : estimation::OpenLoop {
  /// Period of the undamped yaw oscillation of its linear bicycle at the mean speed; nothing where nothing was driven.
  std::optional<double> yaw_period_s = {};
  DrivePath path = {};  ///< where the drive recorded its heading or positions
};

/// The horizon is measured in periods of the yaw oscillation, but in none shorter than this [s]: drivers and the tests
/// of ISO 7401 steer up to about 1 Hz. A car whose yaw oscillation is faster follows its steering at once, and ten of
/// its periods hold nothing that was driven.
inline constexpr double kShortestYawPeriod_s = 1.0;

/// What an estimate is driven over.
enum class OpenLoopUse {
  kHoldout,      ///< what its identification did not use of the same drive
  kOtherDrive,   ///< all of a drive that it knows nothing of
  kOtherHoldout  ///< the hold-out of such a drive alone
};

/// View of an estimate and a drive.
struct DriveOpenLoopProblem {
  const DriveSignals& signals;
  const DriveSegments& segments;
  OpenLoopUse use = OpenLoopUse::kHoldout;
  const VehicleParameters<double>& vehicle;  ///< mass and geometry are taken of it
  const DriveModelOptions& model;            ///< priors and whatever the estimate does not say
  /// C_f, C_r, I_z and whatever else there is of DriveUnknowns, their covariance, and in `fit` the residuals.
  const estimation::Estimate& estimate;
};

/// Drives the model of an estimate, whatever its structure, over data that it was not identified from:
/// DriveParametricModel, from recorded steering and speed. Position and heading do not act back: they are integrated
/// from its motion, and scored without bands (`drive_path`).
///
/// A window begins at the begin of each excited span, and where the one before it ends in there, and lasts for
/// `open_loop`, or until the stretch that is usable (fast enough, all signals there) and that identification did not
/// see is over. Its first `open_loop_start` seconds give the initial state and the offsets, whose priors are those of
/// the identification's biases; all else is forecast. A road's bank that the estimate has in its segments does not
/// stay: its prior is in the bands throughout.
///
/// Bands and horizon are those of `estimation::open_loop_forecasts`. Errors are those of the sensors, and what lasts:
/// what noise of the recorded steering gives the outputs, or what the residual of the estimate's own data has beyond
/// the sensors (`fit`, "yaw_rate.rmse") where that is more: road, wind, what the model lacks.
///
/// The integration is that of Runge-Kutta of fourth order at steps of 2 ms and 0.08 of the bicycle's fastest time
/// constant at most. Windows run on the threads of `progress`, to the same bits on any number.
[[nodiscard]] DriveOpenLoop drive_open_loop(const DriveOpenLoopProblem& problem, const DriveOpenLoopOptions& options,
                                            Progress& progress);

/// The rows that grade it, which bear on the prediction: *open loop horizon* in periods of the yaw oscillation
/// (kShortestYawPeriod_s at least), *open loop against the mean* of each output, *open loop divergence*. Limits are
/// those of `estimation::open_loop_horizon`.
[[nodiscard]] std::vector<estimation::Evidence> open_loop_evidence(const DriveOpenLoop& driven);

}  // namespace veridyn::vehicle
