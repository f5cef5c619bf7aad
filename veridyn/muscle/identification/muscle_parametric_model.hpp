#pragma once

#include <string>
#include <vector>

#include "veridyn/core/index.hpp"
#include "veridyn/estimation/output_error/parametric_model.hpp"
#include "veridyn/muscle/identification/muscle_outputs.hpp"
#include "veridyn/muscle/identification/muscle_unknowns.hpp"
#include "veridyn/muscle/simulation/forward_simulation.hpp"
#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"

namespace veridyn::muscle {

/// One motion for estimation or sensitivity (a task): where it starts, what drives it, when it is sampled. A view of
/// its system, where it has one of its own.
struct MotionSegment {
  StartState start;  ///< the fibres are in equilibrium with their tendons; `fiber_length` is not read
  MuscleControls controls;
  std::vector<double> time;  ///< increasing; the first is where it starts [s]
  /// Of this task: with its load, its locked coordinates. Must outlive the model. Null: the model's own.
  const MusculoskeletalSystem* system = nullptr;
  std::string name = {};  ///< for messages; empty: by number
};

/// What `MuscleParametricModel` shows, and how it integrates.
struct MuscleModelOptions {
  double accuracy = 1e-6;  ///< largest error of a step in units of `MusculoskeletalSystem::scales`
  /// Values and speeds where segments start are unknowns too; else they are fixed.
  bool estimate_start = false;
  /// Empty: all coordinates that are free in a segment.
  std::vector<MuscleOutput> outputs = {};
};

/// View of systems, which must outlive it: their forward simulations as estimators see them
/// (`estimation::ParametricModel`). theta are unknowns of the muscles, which all segments share, and of each segment
/// the values and speeds of its free coordinates where it starts. A coordinate that a segment's system locks is an
/// output that rests.
///
/// Derivatives by variational equations, integrated with the state on the same steps, whose errors they help to choose;
/// one linearisation of the system serves all unknowns (`SystemLinearization`). They contain the equilibrium at the
/// start. Where an excitation is held and its delay is an unknown, the jump of the tangents at each step of the
/// excitation is included.
class MuscleParametricModel final : public estimation::ParametricModel {
 public:
  /// @throws InputError when unknowns contradict each other, or a segment's system has other muscles than `system`.
  MuscleParametricModel(const MusculoskeletalSystem& system, std::vector<MuscleUnknown> unknowns,
                        std::vector<MotionSegment> segments, const MuscleModelOptions& options);
  /// Single parameters, each from the model's value within half and one and a half of it.
  MuscleParametricModel(const MusculoskeletalSystem& system, const std::vector<MuscleParameterName>& parameters,
                        std::vector<MotionSegment> segments, double accuracy = 1e-6, bool estimate_start = false);

  [[nodiscard]] std::span<const estimation::ModelParameter> parameters() const override { return parameters_; }
  [[nodiscard]] std::span<const estimation::ModelOutput> outputs() const override { return outputs_; }
  [[nodiscard]] std::size_t segments() const override { return segments_.size(); }
  [[nodiscard]] Eigen::Index samples(std::size_t segment) const override {
    return signed_index(segments_[segment].time.size());
  }
  [[nodiscard]] std::span<const estimation::ModelParameter> initial_conditions(std::size_t segment) const override {
    return initial_[segment];
  }
  [[nodiscard]] std::string segment_name(std::size_t segment) const override;
  [[nodiscard]] bool respond(std::size_t segment, const Eigen::VectorXd& theta, std::span<const Eigen::Index> active,
                             estimation::ModelResponse& response) const override;

  /// Why a segment cannot be simulated at `theta` (unknowns of the muscles; it starts where it starts): at what time,
  /// and which state. Empty where it can.
  [[nodiscard]] std::string trouble(std::size_t segment, const Eigen::VectorXd& theta) const;

  [[nodiscard]] std::span<const MuscleUnknown> unknowns() const { return unknowns_; }
  [[nodiscard]] std::span<const MotionSegment> motion() const { return segments_; }
  [[nodiscard]] const MusculoskeletalSystem& system_of(std::size_t segment) const {
    return segments_[segment].system != nullptr ? *segments_[segment].system : *system_;
  }
  [[nodiscard]] double accuracy() const { return accuracy_; }
  /// Standard deviations of the outputs' noise for `OutputErrorOptions::noise_start`; empty unless all are known.
  [[nodiscard]] Eigen::VectorXd output_noise() const;

 private:
  void check_systems() const;
  void list_outputs(const std::vector<MuscleOutput>& chosen);
  void list_initial_conditions(bool estimate);

  const MusculoskeletalSystem* system_;
  std::vector<MuscleUnknown> unknowns_;
  std::vector<MotionSegment> segments_;
  double accuracy_;
  std::vector<MuscleOutput> chosen_;
  std::vector<estimation::ModelParameter> parameters_;
  std::vector<estimation::ModelOutput> outputs_;
  std::vector<std::vector<estimation::ModelParameter>> initial_;
};

}  // namespace veridyn::muscle
