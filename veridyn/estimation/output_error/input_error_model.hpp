#pragma once

#include <Eigen/Core>
#include <vector>

#include "veridyn/estimation/output_error/model_view.hpp"

namespace veridyn::estimation {

/// Residuals of one segment that follow from white noise of the outputs and from errors of recorded inputs:
/// z - y = nu + H c, nu_kj ~ N(0, sigma_j^2), c ~ N(0, I), so that their covariance is R = diag(sigma^2) + H H'.
///
/// `apply` multiplies by R^-1/2, the symmetric root, which leaves a value as near to its own place as whitening can:
/// with D = diag(sigma) and the singular vectors U of D^-1 H with squares lambda of its singular values,
/// R^-1/2 = (I + U ((1 + lambda)^-1/2 - 1) U') D^-1. Cost: samples x outputs x errors.
class ErrorWhitening {
 public:
  /// `response`: H, (samples outputs) x errors, row k outputs + j for output j at sample k. `measured`: samples x
  /// outputs; rows of values that are NaN are left out of R.
  ErrorWhitening(const RowMatrix& response, const Eigen::VectorXd& sigma, const RowMatrix& measured);

  /// Columns of (samples outputs) values, in place.
  void apply(Eigen::Ref<RowMatrix> columns) const;

  /// Share of the residuals' variance (with R) that the errors of the inputs make, for a report.
  [[nodiscard]] double input_share() const { return input_share_; }

 private:
  Eigen::VectorXd inverse_sigma_;  ///< by row
  Eigen::MatrixXd basis_;          ///< U
  Eigen::VectorXd change_;         ///< (1 + lambda)^-1/2 - 1
  double input_share_ = 0.0;
};

/// View of a model, which must outlive it, in units in which the residuals of a recording are independent of each other
/// with standard deviation 1: generalised least squares for estimators that know only white noise. R is that of the
/// parameters at which H was computed.
class InputErrorModel final : public ModelView {
 public:
  /// One whitening a segment.
  InputErrorModel(const ParametricModel& model, std::vector<ErrorWhitening> whitening);

  [[nodiscard]] std::span<const ModelOutput> outputs() const override { return outputs_; }
  [[nodiscard]] bool respond(std::size_t segment, const Eigen::VectorXd& theta, std::span<const Eigen::Index> active,
                             ModelResponse& response) const override;

  /// The same units of another model, which must outlive it: of a view of this one, say.
  [[nodiscard]] InputErrorModel on(const ParametricModel& model) const;

  /// A recording in the same units; NaN stays.
  [[nodiscard]] RowMatrix whitened(std::size_t segment, const RowMatrix& measured) const;

 private:
  std::vector<ErrorWhitening> whitening_;
  std::vector<ModelOutput> outputs_;
};

}  // namespace veridyn::estimation
