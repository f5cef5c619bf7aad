#include "veridyn/estimation/output_error/input_error_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/core/assert.hpp"
#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"

namespace veridyn::estimation {
namespace {

using Eigen::Index;

/// Singular values of the whitened response below this share of the noise change nothing.
constexpr double kNegligible = 1e-12;

/// H in units of the noise; rows without a measurement are 0.
RowMatrix in_noise_units(const RowMatrix& response, const Eigen::VectorXd& sigma, const RowMatrix& measured) {
  RowMatrix scaled = response;
  const Index outputs = sigma.size();
  for (Index i = 0; i < scaled.rows(); ++i) {
    if (std::isfinite(measured(i / outputs, i % outputs)))
      scaled.row(i) /= sigma(i % outputs);
    else
      scaled.row(i).setZero();
  }
  return scaled;
}

}  // namespace

ErrorWhitening::ErrorWhitening(const RowMatrix& response, const Eigen::VectorXd& sigma, const RowMatrix& measured) {
  const Index outputs = sigma.size(), rows = measured.rows() * outputs;
  VERIDYN_ASSERT(response.rows() == rows && measured.cols() == outputs);
  inverse_sigma_.resize(rows);
  for (Index i = 0; i < rows; ++i) inverse_sigma_(i) = 1.0 / sigma(i % outputs);
  const RowMatrix scaled = in_noise_units(response, sigma, measured);
  const numerics::SymmetricEigen eigen = numerics::symmetric_eigen(scaled.transpose() * scaled);
  Index kept = 0;
  for (const double value : eigen.values) kept += value > kNegligible ? 1 : 0;
  basis_.resize(rows, kept);
  change_.resize(kept);
  double input = 0.0;
  for (Index j = 0; j < kept; ++j) {
    const Index from = eigen.values.size() - 1 - j;  // ascending
    const double lambda = eigen.values(from);
    basis_.col(j) = scaled * eigen.vectors.col(from) / std::sqrt(lambda);
    change_(j) = 1.0 / std::sqrt(1.0 + lambda) - 1.0;
    input += lambda;
  }
  const double values = static_cast<double>((measured.array() == measured.array()).count());
  input_share_ = values > 0.0 ? input / (input + values) : 0.0;
}

void ErrorWhitening::apply(Eigen::Ref<RowMatrix> columns) const {
  columns.array().colwise() *= inverse_sigma_.array();
  if (change_.size() == 0) return;
  const Eigen::MatrixXd along = basis_.transpose() * columns;
  columns += basis_ * (change_.asDiagonal() * along);
}

InputErrorModel::InputErrorModel(const ParametricModel& model, std::vector<ErrorWhitening> whitening)
    : ModelView(model), whitening_(std::move(whitening)) {
  VERIDYN_ASSERT(whitening_.size() == model.segments());
  for (const ModelOutput& output : model.outputs()) outputs_.push_back({output.name, "1"});
}

InputErrorModel InputErrorModel::on(const ParametricModel& model) const { return InputErrorModel(model, whitening_); }

bool InputErrorModel::respond(std::size_t segment, const Eigen::VectorXd& theta, std::span<const Index> active,
                              ModelResponse& response) const {
  if (!viewed().respond(segment, theta, active, response)) return false;
  Eigen::Map<RowMatrix> column(response.output.data(), response.output.size(), 1);
  whitening_[segment].apply(column);
  if (!active.empty()) whitening_[segment].apply(response.sensitivity);
  return response.output.allFinite() && response.sensitivity.allFinite();
}

RowMatrix InputErrorModel::whitened(std::size_t segment, const RowMatrix& measured) const {
  RowMatrix values = measured;
  for (double& value : values.reshaped())
    if (std::isnan(value)) value = 0.0;
  Eigen::Map<RowMatrix> column(values.data(), values.size(), 1);
  whitening_[segment].apply(column);
  for (Index i = 0; i < values.size(); ++i)
    if (std::isnan(measured.data()[i])) values.data()[i] = measured.data()[i];
  return values;
}

}  // namespace veridyn::estimation
