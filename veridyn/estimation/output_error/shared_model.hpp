#pragma once

#include "veridyn/estimation/output_error/parametric_model.hpp"
#include "veridyn/numerics/ranks/shared_work.hpp"

namespace veridyn::estimation {

/// View of a model whose segments are simulated by all processes of a `SharedWork`: in the first process every
/// estimator works with it as with the model itself, and comes to the same bits, on as many threads as the work has.
/// The others serve `responses_of` the same model.
class SharedModel final : public ParametricModel {
 public:
  /// Model and work must outlive it.
  SharedModel(const ParametricModel& model, numerics::SharedWork& work) : model_(&model), work_(&work) {}

  /// What the work computes.
  [[nodiscard]] static numerics::SharedWork::Compute responses_of(const ParametricModel& model);

  [[nodiscard]] std::span<const ModelParameter> parameters() const override { return model_->parameters(); }
  [[nodiscard]] std::span<const ModelOutput> outputs() const override { return model_->outputs(); }
  [[nodiscard]] std::size_t segments() const override { return model_->segments(); }
  [[nodiscard]] Eigen::Index samples(std::size_t segment) const override { return model_->samples(segment); }
  [[nodiscard]] std::span<const ModelParameter> initial_conditions(std::size_t segment) const override {
    return model_->initial_conditions(segment);
  }
  [[nodiscard]] std::string segment_name(std::size_t segment) const override { return model_->segment_name(segment); }
  /// @throws what `numerics::SharedWork::ask` does
  [[nodiscard]] bool respond(std::size_t segment, const Eigen::VectorXd& theta, std::span<const Eigen::Index> active,
                             ModelResponse& response) const override;

 private:
  const ParametricModel* model_;
  numerics::SharedWork* work_;
};

}  // namespace veridyn::estimation
