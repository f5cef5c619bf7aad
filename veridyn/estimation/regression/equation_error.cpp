#include "veridyn/estimation/regression/equation_error.hpp"

#include <algorithm>

#include "veridyn/estimation/regression/total_least_squares.hpp"

namespace veridyn::estimation {
namespace {

double error_scale(const Eigen::MatrixXd& triangle, const Eigen::MatrixXd& W, double rows) {
  const WhitenedRegression white = whiten(triangle, W);
  const double smallest = white.singular_values(white.singular_values.size() - 1);
  return smallest * smallest / std::max(1.0, rows - static_cast<double>(triangle.cols() - 1));
}

}  // namespace

Eigen::MatrixXd with_equation_error(const Eigen::MatrixXd& triangle, const Eigen::MatrixXd& W, double rows) {
  if (error_scale(triangle, W, rows) <= 1.0) return W;
  const Eigen::Index last = W.cols() - 1;
  Eigen::MatrixXd raised = W;
  const auto scale_at = [&](double variance) {
    raised(last, last) = variance;
    return error_scale(triangle, raised, rows);
  };
  // The scale falls as W_zz rises; with W_zz the variance of z itself it is below 1.
  double low = W(last, last);
  double high = 2.0 * low;
  for (int i = 0; i < 200 && scale_at(high) > 1.0; ++i) low = high, high *= 2.0;
  for (int i = 0; i < 100 && high - low > 1e-13 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (scale_at(middle) > 1.0 ? low : high) = middle;
  }
  raised(last, last) = 0.5 * (low + high);
  return raised;
}

Eigen::MatrixXd with_smaller_regressor_errors(const Eigen::MatrixXd& triangle, const Eigen::MatrixXd& W, double rows) {
  const Eigen::Index n = W.cols() - 1;
  const auto reduced = [&](double f) {
    Eigen::MatrixXd less = W;
    less.topLeftCorner(n, n) *= f * f;
    less.col(n).head(n) *= f;
    less.row(n).head(n) *= f;
    return less;
  };
  if (error_scale(triangle, W, rows) >= 1.0) return W;
  double low = 0.0, high = 1.0;
  if (error_scale(triangle, reduced(0.0), rows) <= 1.0) return reduced(0.0);
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (error_scale(triangle, reduced(middle), rows) > 1.0 ? low : high) = middle;
  }
  return reduced(0.5 * (low + high));
}

}  // namespace veridyn::estimation
