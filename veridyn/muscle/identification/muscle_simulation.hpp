#pragma once

#include <Eigen/Core>
#include <span>
#include <string>

#include "veridyn/muscle/identification/muscle_parametric_model.hpp"

/// Simulations of `MuscleParametricModel`, without and with tangents.
namespace veridyn::muscle::internal {

/// View of what one simulation is made of.
struct MuscleTask {
  const MusculoskeletalSystem* system = nullptr;
  const MotionSegment* segment = nullptr;
  std::span<const MuscleUnknown> unknowns;
  std::span<const MuscleOutput> outputs;
  double accuracy = 1e-6;
};

/// Fills `response.output`, which comes sized. False when the simulation diverges; `trouble`, where given, then says at
/// what time, and which state.
[[nodiscard]] bool simulate_values(const MuscleTask& task, const Eigen::VectorXd& theta,
                                   estimation::ModelResponse& response, std::string* trouble = nullptr);
/// Fills `response.output` and `response.sensitivity` for theta(active[0]), ...
[[nodiscard]] bool simulate_tangents(const MuscleTask& task, const Eigen::VectorXd& theta,
                                     std::span<const Eigen::Index> active, estimation::ModelResponse& response);

}  // namespace veridyn::muscle::internal
