#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/judgement/unfinished_search.hpp"
#include "veridyn/vehicle/identification/evidence/budget_conflicts.hpp"
#include "veridyn/vehicle/identification/evidence/drive_evidence.hpp"
#include "veridyn/vehicle/identification/fit/vehicle_estimates.hpp"
#include "veridyn/vehicle/identification/structure/tried_structure.hpp"

namespace veridyn::vehicle {

/// All structures that were tried, the simplest first, and which of them the data ask for.
struct StructureLadder {
  std::vector<TriedStructure> tried;
  std::size_t chosen = 0;
  DriveModelOptions model = {};  ///< of the chosen one
  OutputErrorResult fit = {};    ///< of it, to the end
  /// How late the vehicle answers the recorded steering, where that is estimated.
  std::optional<DelayByModel> delay = {};
  std::vector<BudgetConflict> conflicts = {};  ///< what the drive shows against its priors, which `model` has widened
  std::vector<StructureDoubt> doubts;          ///< what the structures that are left open would change
  std::string reason;                          ///< one sentence; empty where the study fixes the structure
  /// What an interruption kept it from; `fit` is the best that was there by then.
  estimation::UnfinishedSearch unfinished = {};
  [[nodiscard]] bool empty() const { return tried.empty(); }
};

/// Fits the structure that the study fixes, or all of them, each from where it ends with sensors that are taken for
/// exact. Up to roll all are tried, however little the bicycle leaves: in a gentle drive a stiffness that is a tenth
/// too low leaves no more than the sensors do. Where roll is likelier what tyres do beside is tried too (relaxation,
/// saturation). One that is not taken leaves a doubt, by its probability. A recording that contradicts itself (a failed
/// row) says nothing of the structure: only the bicycle is fitted to it; nor is anything richer fitted to rounding
/// errors. Where the drive contradicts the prior of a delay the climb is made once more with that prior widened.
/// Interrupted, it takes the structure so of those whose fits had ended; of none, where the search of the first
/// stood.
[[nodiscard]] StructureLadder climb_structures(const VehicleProblem& problem,
                                               const EquationErrorEstimates* equation_error, Progress& progress);

}  // namespace veridyn::vehicle
