#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"
#include "veridyn/estimation/result/analysis.hpp"
#include "veridyn/estimation/result/estimate.hpp"
#include "veridyn/estimation/uncertainty/profile_likelihood.hpp"
#include "veridyn/vehicle/identification/fit/axle_estimate.hpp"
#include "veridyn/vehicle/identification/fit/vehicle_estimate.hpp"
#include "veridyn/vehicle/identification/fit/vehicle_problem.hpp"
#include "veridyn/vehicle/identification/options/drive_structure.hpp"
#include "veridyn/vehicle/identification/options/vehicle_method.hpp"
#include "veridyn/vehicle/identification/structure/tried_structure.hpp"
#include "veridyn/vehicle/identification/validation/drive_validation.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"

namespace veridyn::vehicle {

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

/// Rows of what else is done with an estimate, asked for before it is judged; estimates, fit and hold-out are there.
using FurtherRows = std::function<std::vector<estimation::Evidence>(const VehicleIdentification&)>;

/// Identifies the vehicle from a drive: equation error by all methods (`vehicle_estimates.hpp`), output error started
/// from it, prediction of the hold-out (`vehicle_prediction.hpp`), checks and verdict (`vehicle_judgement.hpp`).
/// @param further  see FurtherRows; may be empty
/// @throws InputError when options and signals do not fit
[[nodiscard]] VehicleIdentification identify_parameters(const VehicleProblem& problem, Progress& progress,
                                                        const FurtherRows& further = {});

/// As estimate.json has it; `subject` is the vehicle's name.
[[nodiscard]] estimation::Estimate make_vehicle_estimate(const VehicleIdentification& identification,
                                                         const std::string& subject);

/// The vehicle as the one group of parameters that there is, and what was predicted of its hold-out, in the terms that
/// all domains share.
[[nodiscard]] estimation::ParameterGroup parameter_group(const VehicleIdentification& identification,
                                                         const std::string& subject);

/// The output-error estimate in the order of the drive's model, as reports compare profiles with it; those in the
/// vehicle's estimate as they are there.
[[nodiscard]] std::vector<estimation::Parameter> profiled_parameters(const VehicleIdentification& identification);

}  // namespace veridyn::vehicle
