#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "veridyn/estimation/recursive/recursive_regression.hpp"
#include "veridyn/estimation/regression/regression_data.hpp"

namespace veridyn::estimation::testing_support {

/// By which recursive and batch estimates may differ.
inline constexpr double kLastDigits = 1e-9;

/// Errors of a constant, of regressors and of z, neighbours correlated.
inline Eigen::MatrixXd neighbouring_errors(Eigen::Index n, double ratio) {
  Eigen::MatrixXd W = ratio * Eigen::MatrixXd::Identity(n + 1, n + 1);
  W.row(0).setZero();
  W.col(0).setZero();
  for (Eigen::Index i = 1; i < n; ++i) W(i, i + 1) = W(i + 1, i) = 0.3 * ratio;
  return W;
}

/// All rows, one after the other.
inline void feed(RecursiveRegression& recursive, const RegressionData& data) {
  for (Eigen::Index k = 0; k < data.rows(); ++k) {
    const auto result = recursive.update(
        std::span(data.regressors.row(k).data(), static_cast<std::size_t>(data.parameters())), data.regressand(k));
    ASSERT_TRUE(result.accepted);
  }
}

/// |a - b| over the largest element: the tolerance is on digits of the whole.
inline double relative(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

}  // namespace veridyn::estimation::testing_support
