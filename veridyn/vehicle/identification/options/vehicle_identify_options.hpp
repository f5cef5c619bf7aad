#pragma once

#include <optional>
#include <string>
#include <vector>

#include "veridyn/core/study.hpp"
#include "veridyn/estimation/judgement/limits.hpp"
#include "veridyn/vehicle/identification/options/drive_budget.hpp"
#include "veridyn/vehicle/identification/options/drive_model_options.hpp"
#include "veridyn/vehicle/identification/options/drive_structure.hpp"
#include "veridyn/vehicle/identification/options/vehicle_method.hpp"

namespace veridyn::vehicle {

/// How well what is taken as known is known: standard deviations. Study table `[identify.uncertainty]`.
struct GivenVehicleSigma {
  double mass = 0.0;                            ///< [kg]
  double a = 0.0;                               ///< [m]
  double b = 0.0;                               ///< [m]
  double steer_scale = kSteerScalePrior.sigma;  ///< of what is recorded over true
};

/// What identification may do and what it demands of its result. Study table `[identify]`, with the keys of
/// DriveModelOptions.
struct VehicleIdentifyOptions {
  bool equation_error = true;
  bool output_error = true;
  std::optional<DriveStructure> structure = {};  ///< nothing: the richest that the data determine
  std::optional<DriveEffects> effects = {};      ///< nothing: those that the drive shows
  std::optional<VehicleMethod> method = {};      ///< nothing: output error where it converged
  DriveModelOptions model = {};
  double signal_to_noise = 1.0;
  double significance = 0.05;
  double min_holdout_r2 = estimation::kHoldOutFailed;
  double max_unmodelled = estimation::kMostUnmodelled;
  double contradiction_level = estimation::kPartsContradict;
  double max_relative_sigma = 0.25;
  GivenVehicleSigma given = {};
  std::vector<std::string> profiles = {};  ///< free unknowns whose profile likelihood is followed

  [[nodiscard]] static const KeyTable<VehicleIdentifyOptions>& keys();
};

}  // namespace veridyn::vehicle
