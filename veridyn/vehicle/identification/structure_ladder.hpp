#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/vehicle/identification/drive_structure.hpp"
#include "veridyn/vehicle/identification/vehicle_estimates.hpp"

namespace veridyn::vehicle {

/// All structures that were tried, the simplest first, and which of them the data ask for.
struct StructureLadder {
  std::vector<TriedStructure> tried;
  std::size_t chosen = 0;
  DriveModelOptions model = {};  ///< of the chosen one
  OutputErrorResult fit = {};    ///< of it, to the end
  /// How late the recorded steering is where the model with roll is left free to say so.
  std::optional<estimation::Parameter> steer_delay = {};
  std::vector<StructureDoubt> doubts;  ///< what the structures that are left open would change
  std::string reason;                  ///< one sentence; empty where the study fixes the structure
  [[nodiscard]] bool empty() const { return tried.empty(); }
};

/// The largest residual over what sensors and the steering's error leave (normalised chi-square of an output) at which
/// nothing richer is looked for.
inline constexpr double kExplained = 1.25;

/// Fits the structure that the study fixes, or all of them, each from where the one before it ended: until one without
/// roll leaves no more residual than the sensors do. Relaxation and saturation are tried wherever roll is taken, since
/// what they move stiffnesses by hides in the noise of a gentle drive; there all residuals are weighed by the filter of
/// the roll's fit, and one that is not taken leaves a doubt, by its probability. A recording that contradicts itself (a
/// failed row) says nothing of the structure: only the bicycle is fitted to it.
[[nodiscard]] StructureLadder climb_structures(const VehicleProblem& problem,
                                               const EquationErrorEstimates* equation_error, Progress& progress);

}  // namespace veridyn::vehicle
