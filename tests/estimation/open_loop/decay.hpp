#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/open_loop/open_loop_model.hpp"
#include "veridyn/estimation/output_error/autodiff_model.hpp"

namespace veridyn::estimation {

/// x = x_0 e^(-a t), every tenth of a second, with a and x_0 unknown; diverges where it leaves `limit`.
class Decay : public AutodiffModel<Decay, 8, OpenLoopModel> {
 public:
  Decay(std::vector<double> measured, double a, double limit = kInfinity, double prior = kInfinity)
      : measured_(std::move(measured)), limit_(limit), samples_(measured_.size()) {
    parameters_ = {{.name = "a", .unit = "1/s", .start = a, .fixed = true}};
    initial_ = {{.name = "x_0", .unit = "m/s", .start = 1.0, .prior_sigma = prior}};
  }
  [[nodiscard]] std::span<const ModelParameter> parameters() const override { return parameters_; }
  [[nodiscard]] std::span<const ModelOutput> outputs() const override { return outputs_; }
  [[nodiscard]] std::size_t segments() const override { return 1; }
  [[nodiscard]] Eigen::Index samples(std::size_t) const override { return samples_; }
  [[nodiscard]] std::span<const ModelParameter> initial_conditions(std::size_t) const override { return initial_; }
  [[nodiscard]] std::size_t forecast_outputs() const override { return 1; }
  [[nodiscard]] std::vector<RowMatrix> measured() const override {
    RowMatrix m(samples_, 1);
    for (Eigen::Index k = 0; k < samples_; ++k) m(k, 0) = measured_[k];
    return {m};
  }
  [[nodiscard]] TimeSpan segment_span(std::size_t) const override {
    return {100.0, 100.0 + kStep * static_cast<double>(samples_ - 1)};
  }
  [[nodiscard]] double sample_interval_s() const override { return kStep; }
  [[nodiscard]] Eigen::Index samples_before_divergence(std::size_t, const Eigen::VectorXd& theta) const override {
    Eigen::Index k = 0;
    while (k < samples_ && std::abs(theta(1) * std::exp(-theta(0) * kStep * static_cast<double>(k))) < limit_) ++k;
    return k;
  }
  void shorten(std::size_t, Eigen::Index samples) override { samples_ = samples; }

  template <typename Scalar>
  bool simulate(std::size_t, const Eigen::Matrix<Scalar, Eigen::Dynamic, 1>& theta,
                Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>& output) const {
    using std::exp;
    for (Eigen::Index k = 0; k < output.rows(); ++k)
      output(k, 0) = theta(1) * exp(-theta(0) * (kStep * static_cast<double>(k)));
    return true;
  }
  static constexpr double kStep = 0.1;

 private:
  std::vector<double> measured_;
  double limit_;
  Eigen::Index samples_;
  std::vector<ModelParameter> parameters_;
  std::vector<ModelOutput> outputs_{{"x", "m/s"}};
  std::vector<ModelParameter> initial_;
};

}  // namespace veridyn::estimation
