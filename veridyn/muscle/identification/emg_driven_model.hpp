#pragma once

#include <string>
#include <vector>

#include "veridyn/core/index.hpp"
#include "veridyn/estimation/output_error/parametric_model.hpp"
#include "veridyn/muscle/identification/emg_error.hpp"
#include "veridyn/muscle/identification/muscle_outputs.hpp"
#include "veridyn/muscle/identification/muscle_unknowns.hpp"
#include "veridyn/muscle/model/signals.hpp"
#include "veridyn/muscle/simulation/forward_simulation.hpp"
#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"
#include "veridyn/numerics/piecewise_polynomial.hpp"

namespace veridyn::muscle {

struct MuscleAlongPath;
struct MuscleValues;

/// A recorded motion as `EmgDrivenModel` uses it: what of the muscles follows from the angles alone, and the EMG.
struct EmgSegment {
  std::string name;
  double begin = 0.0;                                 ///< fibres are in equilibrium there [s]
  std::vector<double> time;                           ///< of the samples, none before `begin` [s]
  std::vector<numerics::PiecewisePolynomial> length;  ///< by muscle: of its path, over time [m]
  /// By sample; column o muscles + m: output o per tension of muscle m, where the output is a moment [m or 1].
  estimation::RowMatrix arm;
  std::vector<MuscleControls> emg;  ///< by signal: one excitation each
};

/// The paths of a motion: lengths tabulated every 2 ms and joined by quintic splines, arms at the samples. Coordinates
/// that `motion` does not have rest at `rest`; coupled ones follow, and their moments count at those they follow.
/// Without `emg`. @throws std::invalid_argument for times that do not increase from `begin` on.
[[nodiscard]] EmgSegment along_motion(const MusculoskeletalSystem& system, const Motion& motion,
                                      const Eigen::VectorXd& rest, double begin, std::vector<double> time,
                                      std::span<const MuscleOutput> outputs);

/// View of a system, which must outlive it: its muscles along recorded joint angles, driven by recorded EMG (Lloyd &
/// Besier 2003, J Biomech 36:765). The skeleton is not integrated: paths are known functions of time, muscles are
/// independent of each other, and a moment is the sum of their tensions times their arms. theta are unknowns of the
/// muscles, after which the errors of the segment's EMG may stand in standard deviations, signal by signal; without
/// them the EMG is taken as it was recorded. Outputs are moments, fibre lengths and tendon forces.
///
/// An EMG signal may drive several muscles, each with its own gain and delay: u(t) = gain e(t - delay), kept between
/// the muscle's least activation and 1. Derivatives are those of `simulate_along_path`.
class EmgDrivenModel final : public estimation::ParametricModel {
 public:
  /// `signal_of`: by muscle the signal that drives it; -1: it stays at its least activation.
  /// @throws InputError when unknowns contradict each other, or an output is a coordinate's value or speed.
  EmgDrivenModel(const MusculoskeletalSystem& system, std::vector<MuscleUnknown> unknowns,
                 std::vector<EmgSegment> segments, std::vector<MuscleOutput> outputs, std::vector<int> signal_of,
                 double accuracy = 1e-6, const EmgError& error = {.relative = 0.0});

  [[nodiscard]] std::span<const estimation::ModelParameter> parameters() const override { return parameters_; }
  [[nodiscard]] std::span<const estimation::ModelOutput> outputs() const override { return outputs_; }
  [[nodiscard]] std::size_t segments() const override { return segments_.size(); }
  [[nodiscard]] Eigen::Index samples(std::size_t segment) const override {
    return signed_index(segments_[segment].time.size());
  }
  [[nodiscard]] std::span<const estimation::ModelParameter> initial_conditions(std::size_t) const override {
    return {};
  }
  [[nodiscard]] std::string segment_name(std::size_t segment) const override { return segments_[segment].name; }
  [[nodiscard]] bool respond(std::size_t segment, const Eigen::VectorXd& theta, std::span<const Eigen::Index> active,
                             estimation::ModelResponse& response) const override;

  /// Errors of a segment's EMG: those of one signal as `error_shapes` has them, over all delays within the bounds of
  /// the unknowns, times signals.
  [[nodiscard]] Eigen::Index errors(std::size_t segment) const;
  /// By error of a segment the part that it belongs to.
  [[nodiscard]] std::vector<int> error_parts(std::size_t segment) const;
  /// Derivatives of the outputs with respect to the errors of the signals at `theta`, which has them: rows as in
  /// `ModelResponse::sensitivity`. Muscles of one signal share its errors. False as `respond`.
  [[nodiscard]] bool error_response(std::size_t segment, const Eigen::VectorXd& theta,
                                    estimation::RowMatrix& response) const;
  /// Why a segment cannot be simulated at `theta`: which muscle, at what time, its state. Empty where it can.
  [[nodiscard]] std::string trouble(std::size_t segment, const Eigen::VectorXd& theta) const;
  /// By muscle: share of the segment's samples at which gain times EMG is above 1.
  [[nodiscard]] std::vector<double> saturation(std::size_t segment, const Eigen::VectorXd& theta) const;

 private:
  [[nodiscard]] bool acts(std::size_t segment, std::size_t muscle) const;
  /// Excitations by signal, with the errors at the end of `theta` taken out.
  [[nodiscard]] std::vector<MuscleControls> signals_at(std::size_t segment, const Eigen::VectorXd& theta) const;
  /// The muscle as `values` has it along the segment, driven by `signals`; views all three, and this.
  [[nodiscard]] MuscleAlongPath along(std::size_t segment, std::size_t muscle, const MuscleValues& values,
                                      const std::vector<MuscleControls>& signals) const;

  const MusculoskeletalSystem* system_;
  std::vector<MuscleUnknown> unknowns_;
  std::vector<EmgSegment> segments_;
  std::vector<MuscleOutput> chosen_;
  std::vector<int> signal_of_;
  double accuracy_;
  EmgError error_;
  std::vector<std::vector<EmgErrorShape>> shapes_;  ///< by segment, of each signal
  std::vector<MuscleGroup<double>> alone_;          ///< each muscle in a group by itself
  std::vector<MuscleControls> least_;               ///< by muscle: its least activation
  std::vector<estimation::ModelParameter> parameters_;
  std::vector<estimation::ModelOutput> outputs_;
};

}  // namespace veridyn::muscle
