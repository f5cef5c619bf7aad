#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "veridyn/estimation/judgement/judgement.hpp"
#include "veridyn/estimation/judgement/unfinished_search.hpp"
#include "veridyn/estimation/result/analysis.hpp"
#include "veridyn/vehicle/identification/evidence/budget_conflicts.hpp"
#include "veridyn/vehicle/identification/evidence/drive_evidence.hpp"
#include "veridyn/vehicle/identification/evidence/vehicle_agreement.hpp"
#include "veridyn/vehicle/identification/fit/vehicle_estimates.hpp"
#include "veridyn/vehicle/identification/structure/tried_structure.hpp"
#include "veridyn/vehicle/identification/validation/drive_validation.hpp"

namespace veridyn::vehicle {

/// View of what is judged. `equation_error` and `output_error` are null where they were not tried.
struct VehicleFindings {
  const VehicleEstimate& chosen;
  const EquationErrorEstimates* equation_error = nullptr;
  const OutputErrorResult* output_error = nullptr;
  const DriveValidation& fit;         ///< of the chosen estimate on the identification segments
  const DriveValidation& validation;  ///< on the hold-out
  const DriveValidation& by_noise;    ///< see with_noisier_inputs
  std::optional<PartsAgreement> parts = {};
  std::optional<DelayByModel> delay = {};                 ///< see StructureLadder
  std::span<const BudgetConflict> conflicts = {};         ///< the same
  std::span<const StructureDoubt> structure_doubts = {};  ///< which the intervals of `chosen` have
  estimation::UnfinishedSearch unfinished = {};           ///< by an interruption
  std::span<const estimation::Evidence> further = {};     ///< rows of what else was done with the estimate
};

/// The verdict on an identified vehicle and what it rests on.
struct VehicleJudgement {
  estimation::GroupVerdict verdict = estimation::GroupVerdict::kRejected;
  std::string reason;                        ///< one sentence
  std::vector<estimation::Evidence> checks;  ///< in the order of the report
  estimation::Judgement judgement;           ///< of them
};

/// Equation error against output error, and the regressions' consistency equation; each is missing where there is
/// nothing to compare.
struct AgreementChecks {
  std::optional<estimation::Evidence> consistency, methods;
};
/// The checks of an estimate against the others of the same drive.
[[nodiscard]] AgreementChecks check_agreement(const VehicleProblem& problem, const VehicleFindings& findings);

/// Of a drive that determines none of the vehicle's parameters, whose names are given: no parameters, and no prediction
/// to judge.
[[nodiscard]] std::vector<estimation::Evidence> not_excited_rows(std::span<const std::string> unexcited);

/// The rows of a drive, the grades that follow and the verdict: effective where the parameters are no physical
/// constants but predict the hold-out, not excited where no parameter of the vehicle is determined.
[[nodiscard]] VehicleJudgement judge_vehicle(const VehicleProblem& problem, const VehicleFindings& findings);

}  // namespace veridyn::vehicle
