#pragma once

#include "veridyn/estimation/output_error/model_view.hpp"
#include "veridyn/numerics/ranks/shared_work.hpp"

namespace veridyn::estimation {

/// View of a model whose segments are simulated by all processes of a `SharedWork`: in the first process every
/// estimator works with it as with the model itself, and comes to the same bits, on as many threads as the work has.
/// The others serve `responses_of` the same model.
class SharedModel final : public ModelView {
 public:
  /// Model and work must outlive it.
  SharedModel(const ParametricModel& model, numerics::SharedWork& work) : ModelView(model), work_(&work) {}

  /// What the work computes.
  [[nodiscard]] static numerics::SharedWork::Compute responses_of(const ParametricModel& model);

  /// @throws what `numerics::SharedWork::ask` does
  [[nodiscard]] bool respond(std::size_t segment, const Eigen::VectorXd& theta, std::span<const Eigen::Index> active,
                             ModelResponse& response) const override;

 private:
  numerics::SharedWork* work_;
};

}  // namespace veridyn::estimation
