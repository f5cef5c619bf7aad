#pragma once

#include <Eigen/Core>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/output_error/parametric_model.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::muscle::test {

/// Two tasks of 50 samples that are linear in their parameters: y = known t + (left + right) t^2, and `idle`, which
/// moves nothing. With priors and noise of normal distribution its posterior is known in closed form. The second task
/// is the first one over half the time.
class TwoTasks final : public estimation::ParametricModel {
 public:
  [[nodiscard]] std::span<const estimation::ModelParameter> parameters() const override { return parameters_; }
  [[nodiscard]] std::span<const estimation::ModelOutput> outputs() const override { return outputs_; }
  [[nodiscard]] std::size_t segments() const override { return 2; }
  [[nodiscard]] Eigen::Index samples(std::size_t) const override { return kSamples; }
  [[nodiscard]] std::span<const estimation::ModelParameter> initial_conditions(std::size_t) const override {
    return {};
  }
  [[nodiscard]] bool respond(std::size_t segment, const Eigen::VectorXd& theta, std::span<const Eigen::Index> active,
                             estimation::ModelResponse& response) const override {
    const Eigen::MatrixXd X = design(segment);
    response.output = X * theta;
    response.sensitivity.resize(X.rows(), active.size());
    for (std::size_t j = 0; j < active.size(); ++j) response.sensitivity.col(j) = X.col(active[j]);
    return true;
  }
  /// dy/dtheta.
  [[nodiscard]] static Eigen::MatrixXd design(std::size_t segment) {
    Eigen::MatrixXd X = Eigen::MatrixXd::Zero(kSamples, 4);
    for (Eigen::Index k = 0; k < kSamples; ++k) {
      const double t = (segment == 0 ? 1.0 : 0.5) * static_cast<double>(k) / static_cast<double>(kSamples);
      X(k, 0) = t;
      X(k, 1) = X(k, 2) = t * t;
    }
    return X;
  }
  /// Both tasks at `theta` with white noise of this standard deviation.
  [[nodiscard]] std::vector<estimation::RowMatrix> recorded(const Eigen::Vector4d& theta, double noise) const {
    numerics::RandomStream random(3, "noise of two tasks");
    std::vector<estimation::RowMatrix> all;
    for (std::size_t s = 0; s < 2; ++s) {
      estimation::RowMatrix y = design(s) * theta;
      for (Eigen::Index k = 0; k < y.rows(); ++k) y(k, 0) += noise * random.normal();
      all.push_back(y);
    }
    return all;
  }
  std::vector<estimation::ModelParameter> parameters_{
      {.name = "known", .start = 1.0, .low = 0.0, .high = 2.0, .prior_sigma = 0.5},
      {.name = "left", .start = 1.0, .low = 0.0, .high = 2.0, .prior_sigma = 0.3},
      {.name = "right", .start = 1.0, .low = 0.0, .high = 2.0, .prior_sigma = 0.3},
      {.name = "idle", .start = 1.0, .low = 0.0, .high = 2.0, .prior_sigma = 0.3}};

 private:
  static constexpr Eigen::Index kSamples = 50;
  std::vector<estimation::ModelOutput> outputs_{{"angle", "rad"}};
};

/// Standard deviation of the noise that most cases add and state.
inline constexpr double kTaskNoise = 0.01;

/// Mean and covariance of a posterior.
struct NormalPosterior {
  Eigen::Vector4d mean;
  Eigen::Matrix4d covariance;
};

/// Of two tasks, by the normal equations with the priors as further rows.
inline NormalPosterior posterior_of(const TwoTasks& model, const std::vector<estimation::RowMatrix>& measured,
                                    double noise) {
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (Eigen::Index i = 0; i < 4; ++i) {
    const estimation::ModelParameter& p = model.parameters()[i];
    information(i, i) += 1.0 / (p.prior_sigma * p.prior_sigma);
    right(i) += p.start / (p.prior_sigma * p.prior_sigma);
  }
  for (std::size_t s = 0; s < 2; ++s) {
    const Eigen::MatrixXd X = TwoTasks::design(s);
    information += X.transpose() * X / (noise * noise);
    right += X.transpose() * measured[s].col(0) / (noise * noise);
  }
  const Eigen::Matrix4d covariance = information.inverse();
  return {covariance * right, covariance};
}

}  // namespace veridyn::muscle::test
