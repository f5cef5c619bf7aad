#pragma once

#include <optional>
#include <string>
#include <vector>

#include "veridyn/core/study.hpp"
#include "veridyn/estimation/judgement/limits.hpp"
#include "veridyn/vehicle/identification/options/drive_model_options.hpp"
#include "veridyn/vehicle/identification/options/drive_structure.hpp"
#include "veridyn/vehicle/identification/options/vehicle_method.hpp"

namespace veridyn::vehicle {

/// What identification may do and what it demands of its result. Study table `[identify]`; every key is optional.
struct VehicleIdentifyOptions {
  bool equation_error = true;  ///< `equation_error`
  bool output_error = true;    ///< `output_error`
  /// `structure`: "auto" (nothing) takes the richest that the data ask for, see `structure_ladder.hpp`; a name of
  /// kDriveStructureNames fixes it.
  std::optional<DriveStructure> structure = {};
  /// `effects`: "auto" (nothing) adds what road, air and pedals do to the structure, where the drive tells
  /// (`drive_effects.hpp`) and asks for it; a list of kDriveEffectNames, or [], fixes them. With a fixed structure
  /// "auto" is [].
  std::optional<DriveEffects> effects = {};
  /// `method`: "auto" (nothing) takes output error where it converged, else the equation error that its comparison
  /// recommends; "output error", "OLS", "TLS", "GTLS", "PCA-GTLS" fixes it.
  std::optional<VehicleMethod> method = {};
  DriveModelOptions model = {};  ///< `tyre`, `estimate`, `[identify.prior]`, ...: see DriveModelOptions
  double signal_to_noise = 1.0;  ///< `signal_to_noise`: S/n of the excitation threshold, 1 to 10
  double significance = 0.05;    ///< `significance`: level of the t-tests
  double min_holdout_r2 =
      estimation::kHoldOutFailed;  ///< `min_holdout_r2`: of the predicted yaw rate; below it everything is rejected
  /// `max_unmodelled`: largest share of an output's power that may be left as autocorrelated residual.
  double max_unmodelled = estimation::kMostUnmodelled;
  double contradiction_level =
      estimation::kPartsContradict;  ///< `contradiction_level`: p below which methods or data parts contradict
  /// `max_relative_sigma`: a stiffness or inertia whose standard error is a larger share of it counts as not excited.
  double max_relative_sigma = 0.25;
  /// `[identify.uncertainty]`: standard deviations of what is taken as known: `mass` [kg], `a`, `b` [m]. Motion alone
  /// shows only ratios to the mass: C_f/m, C_r/m and I_z/m; the rest of the error bars comes from here.
  double mass_sigma = 0.0;
  double a_sigma = 0.0;
  double b_sigma = 0.0;
  /// `profiles`: free unknowns whose profile likelihood is followed by output error; `true`: all of them.
  std::vector<std::string> profiles = {};

  /// @throws InputError for values that make no sense.
  [[nodiscard]] static VehicleIdentifyOptions read(const StudyTable& table);
};

}  // namespace veridyn::vehicle
