#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/enum_array.hpp"
#include "veridyn/muscle/model/signals.hpp"
#include "veridyn/muscle/simulation/computed_muscle_control.hpp"
#include "veridyn/muscle/simulation/forward_simulation.hpp"
#include "veridyn/muscle/simulation/joint_reactions.hpp"
#include "veridyn/muscle/simulation/metabolic_cost.hpp"
#include "veridyn/muscle/simulation/static_optimization.hpp"
#include "veridyn/muscle/study/muscle_subject.hpp"

namespace veridyn::muscle {

/// What a muscle study computes.
enum class MuscleMethod {
  kForward,                ///< from excitations to the motion
  kInverseDynamics,        ///< from the motion to generalised forces
  kStaticOptimization,     ///< from the motion to activations, each instant by itself
  kComputedMuscleControl,  ///< from the motion to excitations that make the muscles follow it
};

/// Their names in studies and results, in the order of the enum.
inline constexpr EnumArray<MuscleMethod, std::string_view, 4> kMuscleMethodNames{
    "forward", "inverse dynamics", "static optimization", "computed muscle control"};
/// The word of the study.
[[nodiscard]] constexpr std::string_view method_name(MuscleMethod method) { return kMuscleMethodNames[method]; }

/// A study of a musculoskeletal model, read and checked: the prepared model, and what is to be computed.
struct MuscleStudy : MuscleSubject {
  MuscleMethod method = MuscleMethod::kForward;
  double begin = 0.0, end = 1.0;  ///< [s]
  double rate_Hz = 200.0;
  double accuracy = 1e-5;
  std::vector<double> reserves = {};  ///< by coordinate: force of the actuator that helps it [N m or N]; 0: none

  std::optional<ReactionFrame> reactions = {};     ///< what joints transmit is computed, in these axes
  std::optional<MetabolicOptions> metabolic = {};  ///< the energy that muscles use is computed
  bool induced_accelerations = false;              ///< what each force contributes to accelerations is computed

  StartState start = {};                               ///< forward
  MuscleControls controls = {};                        ///< forward
  Motion motion = {};                                  ///< otherwise: every free and driven coordinate
  std::vector<std::string> desired_coordinates = {};   ///< coordinates whose motion the study gives; the others rest
  ControlOptions control = {};                         ///< computed muscle control, begin to rate set from above
  StaticOptimizationOptions static_optimization = {};  ///< reserves set from above
};

}  // namespace veridyn::muscle
