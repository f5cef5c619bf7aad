#pragma once

#include <string>

#include "veridyn/estimation/output_error/parametric_model.hpp"

namespace veridyn::estimation {

/// Base of views of a model, which must outlive them: each function answers as the model does until a view says
/// otherwise.
class ModelView : public ParametricModel {
 public:
  explicit ModelView(const ParametricModel& model) : model_(&model) {}

  [[nodiscard]] std::span<const ModelParameter> parameters() const override { return model_->parameters(); }
  [[nodiscard]] std::span<const ModelOutput> outputs() const override { return model_->outputs(); }
  [[nodiscard]] std::size_t segments() const override { return model_->segments(); }
  [[nodiscard]] Eigen::Index samples(std::size_t segment) const override { return model_->samples(segment); }
  [[nodiscard]] std::span<const ModelParameter> initial_conditions(std::size_t segment) const override {
    return model_->initial_conditions(segment);
  }
  [[nodiscard]] std::string segment_name(std::size_t segment) const override { return model_->segment_name(segment); }
  [[nodiscard]] bool respond(std::size_t segment, const Eigen::VectorXd& theta, std::span<const Eigen::Index> active,
                             ModelResponse& response) const override {
    return model_->respond(segment, theta, active, response);
  }

 protected:
  [[nodiscard]] const ParametricModel& viewed() const { return *model_; }

 private:
  const ParametricModel* model_;
};

}  // namespace veridyn::estimation
