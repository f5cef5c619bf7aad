#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/estimation/simulated_regression.hpp"
#include "veridyn/estimation/output_error/autodiff_model.hpp"

/// Models with closed forms, for tests of output error.
namespace veridyn::estimation::testing_support {

using Eigen::Index;
using Eigen::VectorXd;

template <typename Scalar>
using Column = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
template <typename Scalar>
using Table = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// x' = -a x + b u with u held over each step, sampled exactly; outputs x and its rate. Diverges for a < 0 when told
/// to.
class FirstOrder : public AutodiffModel<FirstOrder, 2> {  // stride 2: three unknowns take two passes
 public:
  FirstOrder(std::vector<VectorXd> inputs, double dt) : inputs_(std::move(inputs)), dt_(dt) {
    for (std::size_t s = 0; s < inputs_.size(); ++s) initial_.push_back({ModelParameter{.name = "x0"}});
  }
  std::vector<ModelParameter> unknowns{{.name = "a", .unit = "1/s", .start = 1.0}, {.name = "b", .start = 1.0}};
  bool refuses_growth = false;

  std::span<const ModelParameter> parameters() const override { return unknowns; }
  std::span<const ModelOutput> outputs() const override { return outputs_; }
  std::size_t segments() const override { return inputs_.size(); }
  Index samples(std::size_t s) const override { return inputs_[s].size(); }
  std::span<const ModelParameter> initial_conditions(std::size_t s) const override { return initial_[s]; }

  template <typename Scalar>
  bool simulate(std::size_t s, const Column<Scalar>& theta, Table<Scalar>& y) const {
    using std::exp;
    const Scalar &a = theta(0), &b = theta(1);
    if (refuses_growth && a < Scalar(0.0)) return false;
    Scalar x = theta(2);
    const Scalar decay = exp(-a * Scalar(dt_));
    for (Index k = 0; k < y.rows(); ++k) {
      const double u = inputs_[s](k);
      y(k, 0) = x;
      y(k, 1) = -a * x + b * Scalar(u);
      x = decay * x + (Scalar(1.0) - decay) * b * Scalar(u) / a;
    }
    return true;
  }

 private:
  std::vector<VectorXd> inputs_;
  double dt_;
  std::vector<ModelOutput> outputs_{{"x", "m"}, {"rate", "m/s"}};
  std::vector<std::vector<ModelParameter>> initial_;
};

/// y_j = X_j theta: no dynamics, no initial conditions.
class Static : public AutodiffModel<Static, 4> {
 public:
  explicit Static(std::vector<std::vector<RowMatrix>> regressors) : X_(std::move(regressors)) {
    for (Index i = 0; i < X_[0][0].cols(); ++i) unknowns.push_back({.name = "theta" + std::to_string(i)});
    for (std::size_t j = 0; j < X_[0].size(); ++j) outputs_.push_back({"y" + std::to_string(j), "1"});
  }
  std::vector<ModelParameter> unknowns;
  std::span<const ModelParameter> parameters() const override { return unknowns; }
  std::span<const ModelOutput> outputs() const override { return outputs_; }
  std::size_t segments() const override { return X_.size(); }
  Index samples(std::size_t s) const override { return X_[s][0].rows(); }
  std::span<const ModelParameter> initial_conditions(std::size_t) const override { return {}; }
  template <typename Scalar>
  bool simulate(std::size_t s, const Column<Scalar>& theta, Table<Scalar>& y) const {
    for (std::size_t j = 0; j < X_[s].size(); ++j) {
      for (Index k = 0; k < y.rows(); ++k) {
        Scalar sum(0.0);
        for (Index i = 0; i < X_[s][j].cols(); ++i) sum += Scalar(X_[s][j](k, i)) * theta(i);
        y(k, j) = sum;
      }
    }
    return true;
  }

 private:
  std::vector<std::vector<RowMatrix>> X_;
  std::vector<ModelOutput> outputs_;
};

inline std::vector<VectorXd> doublets(std::size_t segments, Index samples) {
  std::vector<VectorXd> inputs;
  for (std::size_t s = 0; s < segments; ++s) {
    VectorXd u = VectorXd::Zero(samples);
    const Index first = samples / 10 + static_cast<Index>(3 * s), width = samples / 5;
    u.segment(first, width).setConstant(1.0);
    u.segment(first + width, width).setConstant(-1.0);
    inputs.push_back(u);
  }
  return inputs;
}

inline constexpr double kA = 1.7, kB = 2.4;

inline std::vector<RowMatrix> truth_of(const FirstOrder& model) {
  std::vector<RowMatrix> y;
  for (std::size_t s = 0; s < model.segments(); ++s) {
    ModelResponse r;
    EXPECT_TRUE(model.respond(s, Eigen::Vector3d(kA, kB, 0.3 + 0.1 * static_cast<double>(s)), {}, r));
    y.push_back(r.output);
  }
  return y;
}

inline void add_noise(std::vector<RowMatrix>& z, std::mt19937_64& generator, double sd0, double sd1, double rho = 0.0) {
  for (RowMatrix& m : z) {
    m.col(0) += sd0 * correlated_noise(generator, m.rows(), rho);
    m.col(1) += sd1 * correlated_noise(generator, m.rows(), rho);
  }
}

}  // namespace veridyn::estimation::testing_support
