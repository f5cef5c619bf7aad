#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "veridyn/estimation/output_error/model_view.hpp"
#include "veridyn/numerics/batches/value_log.hpp"

namespace veridyn::estimation {

/// What a search asked of a model at one point.
struct ModelEvaluation {
  Eigen::VectorXd theta;            ///< the shared parameters
  bool derivatives = false;         ///< outputs with their sensitivities, or outputs alone
  std::vector<double> misfit = {};  ///< by segment; NaN: not asked for, or not finished
  std::vector<char> failed = {};    ///< by segment: the simulation could not finish
  double seconds = 0.0;             ///< of the simulations, by the clock; 0 of those answered from a log
};

/// View of a model that notes what is asked of it, and answers from a log what an earlier run was answered: an
/// estimation that was cut off takes the same path with the same bits, only faster, until it comes to where it was.
/// Works with every estimator, for all of them take the next step from responses alone.
class LoggedModel final : public ModelView {
 public:
  /// How far a segment's outputs are from what was measured, for `evaluations`.
  using Misfit = std::function<double(std::size_t segment, const RowMatrix& output)>;

  /// Model and log must outlive it.
  /// @param name  distinguishes models whose responses are in one log
  /// @param log  nullptr: nothing is kept
  LoggedModel(const ParametricModel& model, std::string name, Misfit misfit, numerics::ValueLog* log);

  [[nodiscard]] bool respond(std::size_t segment, const Eigen::VectorXd& theta, std::span<const Eigen::Index> active,
                             ModelResponse& response) const override;

  /// In the order in which they began.
  [[nodiscard]] std::vector<ModelEvaluation> evaluations() const;
  /// Simulations of segments that were answered from the log.
  [[nodiscard]] std::size_t resumed() const;

 private:
  [[nodiscard]] std::uint64_t key_of(std::size_t segment, const Eigen::VectorXd& theta,
                                     std::span<const Eigen::Index> active) const;
  void note(std::size_t segment, const Eigen::VectorXd& theta, bool derivatives, bool finished, double seconds,
            const ModelResponse& response) const;

  std::string name_;
  Misfit misfit_;
  numerics::ValueLog* log_;
  mutable std::mutex mutex_;
  mutable std::vector<ModelEvaluation> evaluations_;
  mutable std::map<std::pair<std::vector<double>, bool>, std::size_t> place_;  ///< of the shared parameters
  mutable std::size_t resumed_ = 0;
};

}  // namespace veridyn::estimation
