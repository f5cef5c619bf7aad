#pragma once

#include <optional>
#include <span>
#include <vector>

#include "veridyn/estimation/result/estimate.hpp"
#include "veridyn/vehicle/identification/signals/drive_signals.hpp"

namespace veridyn::vehicle {

/// A stretch whose lateral motion was simulated: yaw rate and lateral velocity of the centre of gravity [rad/s, m/s], a
/// value for each sample of the signals' grid from `first` on.
struct SimulatedTurning {
  std::size_t first = 0;
  std::size_t forecast_from = 0;  ///< samples ahead of it, counted from `first`, say where and which way it begins
  std::vector<double> yaw_rate = {}, lateral_velocity = {};
};

/// Where a simulated motion goes against where the vehicle was recorded to go.
struct DrivePath {
  /// Of measured less simulated, over the forecasts.
  struct Error {
    double rmse = 0.0;
    double at_end = 0.0;  ///< median over the windows of its size at their end
    std::size_t samples = 0;
  };
  std::optional<Error> heading;   ///< [rad]
  std::optional<Error> position;  ///< distance between both [m]
  double across_rmse = 0.0;       ///< of the position: its part across the simulated path [m]
  double distance_m = 0.0;        ///< median over the windows of the way that was forecast [m]
  /// All windows one after the other, NaN between them and where nothing was recorded; SI, on the recording's ground.
  std::vector<double> time, x, y, yaw, x_model, y_model, yaw_model;

  [[nodiscard]] bool available() const { return heading || position; }
};

/// Integrates heading and position of simulated motions, which do not act back on them,
///
///     psi' = r,   x' = u cos psi - v sin psi,   y' = u sin psi + v cos psi,
///
/// with the recorded forward speed u (trapezoidal rule; between two samples along their mean heading). Where and which
/// way a window begins is fitted to its first samples (least squares): the heading to the recorded heading, the path,
/// turned and moved, to the recorded positions, so that an offset of the heading's sensor is not the path's. Along the
/// path an error is the recorded speed's; across it, the model's.
///
/// What the positions are of is taken to be the centre of gravity: of another point, a metre away, the path is a metre
/// times the turn of the heading off.
[[nodiscard]] DrivePath drive_path(const DriveSignals& signals, std::span<const SimulatedTurning> windows);

/// The scores in the terms of estimate.json, in `fit`: "open_loop.yaw.rmse", "open_loop.position.at_end", ...
void add_path(const DrivePath& path, estimation::Estimate& estimate);

}  // namespace veridyn::vehicle
