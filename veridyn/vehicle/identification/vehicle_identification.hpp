#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/analysis.hpp"
#include "veridyn/estimation/estimate.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"
#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/estimation/uncertainty/profile_likelihood.hpp"
#include "veridyn/vehicle/identification/fit/axle_estimate.hpp"
#include "veridyn/vehicle/identification/fit/drive_parametric_model.hpp"
#include "veridyn/vehicle/identification/options/vehicle_method.hpp"
#include "veridyn/vehicle/identification/signals/drive_log.hpp"
#include "veridyn/vehicle/identification/signals/drive_segments.hpp"
#include "veridyn/vehicle/identification/validation/drive_validation.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"

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
  double min_holdout_r2 = 0.5;   ///< `min_holdout_r2`: of the predicted yaw rate; below it everything is rejected
  /// `max_unmodelled`: largest share of an output's power that may be left as autocorrelated residual.
  double max_unmodelled = 0.1;
  double contradiction_level = 1e-3;  ///< `contradiction_level`: p below which methods or data parts contradict
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

/// The vehicle's parameters by one method.
struct VehicleEstimate {
  VehicleMethod method = VehicleMethod::kNone;
  bool usable = false;
  std::string message;
  /// C_f, C_r, I_z [, mu, ...], understeer_gradient [rad/(m/s^2)], nuisances: sensors' biases; of
  /// equation error `steer_offset`, what the biases of steering, gyro and accelerometer add up to as a steer angle.
  std::vector<estimation::Parameter> parameters;
  Eigen::MatrixXd covariance;  ///< in their order
  /// The part of it that comes from what is not known of mass, a and b; empty: none.
  Eigen::MatrixXd given_covariance = {};
  double degrees_of_freedom = 1.0;
  /// Null where the method does not estimate it.
  [[nodiscard]] const estimation::Parameter* find(std::string_view name) const;
};

/// Everything that identification made of a drive.
struct VehicleIdentification {
  std::optional<DriveRegressionResult> regression;              ///< equation error, where it was tried
  std::optional<estimation::OutputErrorEstimate> output_error;  ///< as the estimator gave it
  std::vector<VehicleEstimate> estimates;                       ///< one per method, the chosen one among them
  VehicleMethod chosen = VehicleMethod::kNone;                  ///< its method
  DriveStructure structure = DriveStructure::kBicycle;          ///< of the model of output and filter error
  DriveEffects effects = {};                                    ///< added to it
  std::vector<TriedStructure> tried_structures;                 ///< the simplest first
  std::vector<StructureDoubt> structure_doubts;                 ///< others that are left open; in the intervals
  std::string structure_reason;                                 ///< why this one; empty where the study fixes it
  estimation::GroupVerdict verdict = estimation::GroupVerdict::kRejected;
  std::string reason;                        ///< one sentence
  std::vector<estimation::Evidence> checks;  ///< residuals, agreement of methods, of data parts, hold-out
  estimation::Judgement judgement;           ///< of them; what was not estimated is not judged
  VehicleParameters<double> identified;      ///< the subject with what was identified
  estimation::ProfileResult profiles;        ///< of the output error, where the study asks for them
  DriveValidation fit;                       ///< on the identification segments
  DriveValidation validation;                ///< on the hold-out
  std::vector<std::string> warnings;
  /// Something was left out because of an interruption: without a `best()` all, else what the rows say.
  bool interrupted = false;

  /// Null where that method was not tried.
  [[nodiscard]] const VehicleEstimate* find(VehicleMethod method) const;
  /// The chosen estimate; null where no method gave one. What was not excited has one too, whose parameters are marked
  /// so.
  [[nodiscard]] const VehicleEstimate* best() const { return find(chosen); }
};

/// View of what identification is given. Mass, a and b of `start` are known; C_f, C_r, I_z are where the search begins.
struct VehicleProblem {
  const DriveSignals& signals;
  const DriveSegments& segments;
  const VehicleParameters<double>& start;
  const DriveSignalOptions& signal_options;
  const VehicleIdentifyOptions& options;
  /// What was found of the recording: rows that bear on the estimate too.
  std::span<const estimation::Evidence> recording = {};
};

/// Identifies the vehicle from a drive: equation error by all methods (`vehicle_estimates.hpp`), output error started
/// from it, prediction of the hold-out (`vehicle_prediction.hpp`), checks and verdict (`vehicle_judgement.hpp`).
/// @throws InputError when options and signals do not fit
[[nodiscard]] VehicleIdentification identify_parameters(const VehicleProblem& problem, Progress& progress);

/// As estimate.json has it; `subject` is the vehicle's name.
[[nodiscard]] estimation::Estimate make_vehicle_estimate(const VehicleIdentification& identification,
                                                         const std::string& subject);

/// The vehicle as the one group of parameters that there is, and what was predicted of its hold-out, in the terms that
/// all domains share.
[[nodiscard]] estimation::ParameterGroup parameter_group(const VehicleIdentification& identification,
                                                         const std::string& subject);

/// m/(2 L) (b/C_f - a/C_r) [rad/(m/s^2)]: extra steer angle per lateral acceleration of the linear bicycle. Positive:
/// understeer.
[[nodiscard]] double understeer_gradient(const VehicleParameters<double>& p);

}  // namespace veridyn::vehicle
