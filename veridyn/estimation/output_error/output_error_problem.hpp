#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "veridyn/estimation/output_error/output_error.hpp"
#include "veridyn/estimation/output_error/residual_spectrum.hpp"

namespace veridyn::estimation::internal {

/// One segment's whitened linearisation [-S_own, -S_shared | nu] reduced to a triangle: the same cost, gradient and
/// Gauss-Newton matrix in few rows.
struct SegmentTriangle {
  bool valid = false;
  double squares = 0.0;  ///< nu' R^-1 nu over the segment
  RowMatrix matrix;      ///< (unknowns + 1) x (unknowns + 1), local unknowns first
};

/// View of model, measurements and options with the state of their estimation: current unknowns, noise covariance, and
/// each segment's residual and triangle at them. The unknowns live in blocks whose addresses do not change, where Ceres
/// moves them.
class OutputErrorProblem {
 public:
  /// @throws InputError when the measurements do not fit the model.
  OutputErrorProblem(const ParametricModel& model, const std::vector<RowMatrix>& measured,
                     const OutputErrorOptions& options);

  [[nodiscard]] const ParametricModel& model() const { return model_; }
  [[nodiscard]] std::size_t segments() const { return segments_.size(); }
  [[nodiscard]] Eigen::Index values() const { return values_; }
  [[nodiscard]] Eigen::Index all_unknowns() const;
  [[nodiscard]] bool estimates_noise() const { return options_.noise != OutputNoise::kGiven; }

  [[nodiscard]] Eigen::Index shared_count() const { return shared_.size(); }
  [[nodiscard]] const std::vector<Eigen::Index>& free_shared() const { return free_shared_; }
  [[nodiscard]] std::vector<const ModelParameter*> shared_unknowns() const;
  [[nodiscard]] double* shared_block() { return shared_.data(); }
  [[nodiscard]] const Eigen::VectorXd& shared() const { return shared_; }
  [[nodiscard]] Eigen::VectorXd full_shared() const;

  [[nodiscard]] Eigen::Index local_count(std::size_t s) const { return segments_[s].local.size(); }
  [[nodiscard]] double* local_block(std::size_t s) { return segments_[s].local.data(); }
  [[nodiscard]] std::vector<const ModelParameter*> local_unknowns(std::size_t s) const;
  [[nodiscard]] std::vector<std::string> local_names(std::size_t s) const;
  [[nodiscard]] std::vector<std::string> local_units(std::size_t s) const;
  [[nodiscard]] Eigen::Index unknowns(std::size_t s) const { return local_count(s) + shared_count(); }

  /// Residuals at the current unknowns, and triangles where derivatives are needed.
  void evaluate(bool derivatives);
  [[nodiscard]] bool valid() const;
  [[nodiscard]] const SegmentTriangle& triangle(std::size_t s) const { return segments_[s].triangle; }
  [[nodiscard]] int diverged_evaluations() const { return diverged_evaluations_; }
  [[nodiscard]] const std::string& diverged_segment() const { return diverged_segment_; }
  [[nodiscard]] SimulationCount simulations() const;

  void start_noise();
  /// R from the residuals; returns the largest relative change of a standard deviation.
  double update_noise();
  [[nodiscard]] const Eigen::MatrixXd& noise() const { return noise_; }
  /// How many samples say what one would if the model were right (`OutputErrorOptions::model_error`): priors count by
  /// it. 1 at least.
  [[nodiscard]] double samples_per_independent_one() const { return discount_; }
  /// What the model's error adds to it.
  [[nodiscard]] double model_error() const { return model_error_; }
  /// 1/sigma of an unknown's prior against the samples; 0 without one.
  [[nodiscard]] double prior_root(const ModelParameter& unknown) const;

  /// Whether a shared unknown is at a bound.
  [[nodiscard]] bool reaches_bounds() const;
  /// Of the shared unknowns that are at a bound, those that the cost would drive beyond it, by their place; the
  /// triangles are those of the current unknowns. None with `hold_undetermined`, whose directions are held already.
  [[nodiscard]] std::vector<int> pressed_on_bounds() const;
  /// |R^-1/2 S (now - before)|, an upper bound of every shared parameter's change in its own sigma.
  [[nodiscard]] double largest_change_in_sigma(const Eigen::VectorXd& before) const;
  /// A with A'A the information of the shared unknowns, the segments' local ones eliminated; priors are not in it.
  [[nodiscard]] RowMatrix shared_root() const;
  [[nodiscard]] std::vector<RowMatrix> whitened_residuals() const;
  [[nodiscard]] Eigen::MatrixXd spectral_filling(const ResidualSpectrum& spectrum);
  [[nodiscard]] double negative_log_likelihood() const;
  [[nodiscard]] std::vector<OutputFit> output_fits() const;
  [[nodiscard]] const RowMatrix& predicted(std::size_t s) const { return segments_[s].predicted; }

 private:
  struct Simulated {
    ModelResponse response;
    Eigen::VectorXd theta;  // that it is of; empty: none
  };
  struct Segment {
    std::vector<Eigen::Index> free_initial;  // of the model's initial conditions
    Eigen::VectorXd initial;                 // all initial conditions, at their start
    Eigen::VectorXd local;                   // free initial conditions, then output biases
    std::vector<Eigen::Index> active;        // of theta: free initial conditions, then free shared parameters
    SegmentTriangle triangle;
    RowMatrix residual;  // samples x outputs, NaN where missing
    RowMatrix predicted;
    // The last two simulations with derivatives, where they are kept, the later one first: a search goes back by a
    // step.
    std::array<Simulated, 2> simulated;
    SimulationCount simulations;
  };

  [[nodiscard]] Eigen::VectorXd theta_of(const Segment& segment) const;
  [[nodiscard]] bool fits_in_memory() const;
  /// Brings a kept simulation of the current unknowns to the front; false where there is none.
  static bool recall(Segment& segment, const Eigen::VectorXd& theta);
  /// Outputs at the current unknowns; false when it diverges.
  bool simulate(std::size_t s, ModelResponse& values);
  /// The same with derivatives, to the front of those kept, where they are not there already.
  bool simulate_with_derivatives(std::size_t s);
  static void forget(Segment& segment);
  /// Residual and, with derivatives, the whitened rows [-S_own, -S_shared | nu] of a simulation.
  void linearise(std::size_t s, bool derivatives, const ModelResponse& response, RowMatrix& residual,
                 RowMatrix& predicted, RowMatrix& rows) const;
  /// R^-1/2 times the rows of every sample, in place; missing ones become zero.
  void whiten(const RowMatrix& residual, RowMatrix& rows) const;
  void set_noise(const Eigen::MatrixXd& noise);
  void update_discount();

  const ParametricModel& model_;
  const std::vector<RowMatrix>& measured_;
  const OutputErrorOptions& options_;
  Eigen::Index outputs_ = 0;
  Eigen::Index values_ = 0;
  std::vector<Eigen::Index> free_shared_;
  Eigen::VectorXd all_shared_;  // fixed ones at their start
  Eigen::VectorXd shared_;
  std::vector<Eigen::Index> biased_;  // outputs with a bias
  std::vector<ModelParameter> bias_parameters_;
  std::vector<Segment> segments_;
  bool keeps_ = false;  // simulations with derivatives, for another R
  double discount_ = 1.0;
  double model_error_ = 0.0;
  Eigen::MatrixXd noise_;
  Eigen::MatrixXd whitener_;  // inverse of the Cholesky factor of R
  Eigen::VectorXd noise_floor_;
  int diverged_evaluations_ = 0;
  std::string diverged_segment_;
};

}  // namespace veridyn::estimation::internal
