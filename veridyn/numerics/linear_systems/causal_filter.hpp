#pragma once

#include <Eigen/Core>

#include "veridyn/numerics/linear_algebra/matrix_exponential.hpp"
#include "veridyn/numerics/linear_systems/discretisation.hpp"

namespace veridyn::numerics {

/// A linear system of one input and one output that is fed sample by sample, at steps that may differ from each to the
/// next: exact for inputs that are held as `hold` says. Nothing is allocated, thrown or looked up after construction;
/// copying it saves and restores its state. A step that is the last one again costs n^2 products; another one costs a
/// matrix exponential besides.
class CausalFilter {
 public:
  static constexpr Eigen::Index kMostStates = 6;

  /// @throws InputError where the system has more than one input or output, or more than `kMostStates` states.
  explicit CausalFilter(const StateSpace& system, Hold hold = Hold::kFirstOrder);
  explicit CausalFilter(const TransferFunction& transfer, Hold hold = Hold::kFirstOrder)
      : CausalFilter(realise(transfer), hold) {}

  /// At rest with a constant input, and its output. A system without such a rest (an integrator with an input that is
  /// not zero) is put where every state is zero.
  double reset(double input);
  /// The output at a sample `step` [s] after the last one. An input that is not finite stands for the last one; a step
  /// that is negative or not finite for none.
  double step(double input, double step);
  /// That of the last `reset` or `step`.
  [[nodiscard]] double output() const { return output_; }
  [[nodiscard]] double input() const { return input_; }

 private:
  using State = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostStates, 1>;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostStates, kMostStates>;

  void set_step(double step);
  double observe(double input);

  Square A_, rest_;  ///< rest_ of the states at rest: x = rest_ B u
  State B_, C_;
  double D_ = 0.0;
  Hold hold_;
  Square Phi_;
  State Gamma_, Slope_;
  double step_ = -1.0;  ///< of Phi_, Gamma_ and Slope_ [s]
  State x_, next_;
  double input_ = 0.0, output_ = 0.0;
};

}  // namespace veridyn::numerics
