#pragma once

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/vehicle/simulated_drive.hpp"
#include "veridyn/vehicle/identification/validation/drive_open_loop.hpp"

namespace veridyn::vehicle::testing {

/// An estimate with these values, whose relative standard errors are `sigma`.
inline estimation::Estimate estimate_of(const std::vector<std::pair<const char*, double>>& values, double sigma = 0.0) {
  estimation::Estimate estimate;
  const auto n = static_cast<Eigen::Index>(values.size());
  estimate.covariance = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& [name, value] = values[i];
    estimate.parameters.push_back({.name = name, .value = value, .sigma = sigma * std::abs(value)});
    estimate.covariance(i, i) = std::pow(sigma * value, 2.0);
  }
  return estimate;
}

/// All of a drive at hand, none of which the identification has seen.
struct OpenLoopDrive {
  DriveSignals signals;
  DriveSegments segments;

  OpenLoopDrive(const VehicleTrajectory& trajectory, const DriveSensorSet& sensors, std::uint64_t seed)
      : signals(prepare_drive_signals(mapped(record_drive(trajectory, sensors, seed)), {})) {
    // The last inputs have no neighbours from which what lies between them is interpolated.
    segments.usable = {{1.0, signals.grid.at(signals.size() - 1) - 0.1}};
    segments.excited = segments.holdout = segments.usable;
  }
  [[nodiscard]] DriveOpenLoop driven(const VehicleParameters<double>& vehicle, const estimation::Estimate& estimate,
                                     const DriveOpenLoopOptions& options,
                                     OpenLoopUse use = OpenLoopUse::kOtherDrive) const {
    Progress silent;
    return drive_open_loop({signals, segments, use, vehicle, DriveModelOptions(), estimate}, options, silent);
  }
};

inline const estimation::OpenLoopState& state_of(const DriveOpenLoop& driven, std::string_view name) {
  return *std::ranges::find(driven.states, name, &estimation::OpenLoopState::name);
}

}  // namespace veridyn::vehicle::testing
