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
  std::string reason;  ///< one sentence; empty where the study fixes the structure
  [[nodiscard]] bool empty() const { return tried.empty(); }
};

/// The largest residual over what sensors and the steering's error leave (normalised chi-square of an output) at which
/// nothing richer is looked for.
inline constexpr double kExplained = 1.25;

/// Fits the structure that the study fixes, or all of them, each from where the one before it ended: until one without
/// roll leaves no more residual than the sensors do. What comes after roll is tried only where roll is taken,
/// relaxation only where roll leaves something; saturation always, since what it moves stiffnesses by hides in the
/// noise. A recording that contradicts itself (a failed row) says nothing of the structure: only the bicycle is fitted
/// to it.
[[nodiscard]] StructureLadder climb_structures(const VehicleProblem& problem,
                                               const EquationErrorEstimates* equation_error, Progress& progress);

}  // namespace veridyn::vehicle
