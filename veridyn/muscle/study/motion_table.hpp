#pragma once

#include <filesystem>
#include <optional>

#include "veridyn/core/study_keys.hpp"
#include "veridyn/muscle/model/external_load.hpp"
#include "veridyn/muscle/model/ramp.hpp"
#include "veridyn/muscle/study/motion_study.hpp"

namespace veridyn::muscle {

/// `[motion]` of a study as it is written; the parts of `read_study` check it against the model and each other.
struct MotionTable {
  MuscleMethod method = MuscleMethod::kForward;
  std::optional<double> begin, duration;  ///< [s]
  double rate_Hz = 200.0;
  double accuracy = 1e-5;
  double reserve_force = 1.0;  ///< [N m or N]
  std::optional<std::filesystem::path> file;
  std::optional<double> low_pass_Hz;  ///< of `file`
  std::optional<std::filesystem::path> start_file, excitation_file;
  Interpolation interpolation = Interpolation::kLinear;
  std::optional<ReactionFrame> reactions;
  std::optional<MetabolicModel> metabolic;
  double aerobic_factor = MetabolicOptions{}.aerobic_factor;
  bool induced_accelerations = false;
  std::optional<std::filesystem::path> external_loads, external_loads_data;
  std::optional<double> external_low_pass_Hz;
  ControlOptions control;
  StaticOptimizationOptions static_optimization{.force = StaticForce::kWithPassive};

  [[nodiscard]] static const KeyTable<MotionTable>& keys();
};

namespace internal {

/// Accuracies of simulations.
inline constexpr KeyRange kAccuracies = from_to(1e-13, 0.1);
/// Shares that leave something.
inline constexpr KeyRange kBelowOne{.low = 0.0, .high = 1.0, .with_high = false};
/// What the `interpolation` of controls may be.
[[nodiscard]] std::vector<std::pair<std::string, Interpolation>> interpolations();
/// `[motion.control]`: window, gains, least and greatest control.
[[nodiscard]] const KeyTable<ControlOptions>& control_keys();
/// `[[motion.ramp]]`, its values those of its coordinate.
[[nodiscard]] const KeyTable<Ramp>& ramp_keys();
/// `[[motion.external_load]]`.
[[nodiscard]] const KeyTable<ExternalLoadSource>& external_load_keys();
/// `[subject]`, `[[subject.load]]`.
[[nodiscard]] const KeyTable<SystemOptions>& subject_keys();
[[nodiscard]] const KeyTable<HeldLoad>& load_keys();

}  // namespace internal

}  // namespace veridyn::muscle
