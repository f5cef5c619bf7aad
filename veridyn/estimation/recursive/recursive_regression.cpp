#include "veridyn/estimation/recursive/recursive_regression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/recursive/recursive_state.hpp"

namespace veridyn::estimation {

void RecursiveOptions::validate(Eigen::Index parameters) const {
  if (parameters < 1 || parameters > kMaxRecursiveParameters) {
    throw InputError("recursive", fmt::format("{} parameters; must be 1 to {} (the batch estimators have no limit)",
                                              parameters, kMaxRecursiveParameters));
  }
  forgetting.validate();
  if (method == Method::kTls) {
    throw InputError("recursive.method", "is TLS; must be OLS, GTLS (TLS is GTLS with its identity W) or PCA-GTLS");
  }
  RegressionOptions batch;
  batch.signal_to_noise = signal_to_noise;
  batch.prior = prior;
  if (method == Method::kPcaGtls) batch.prior_weight = prior_weight;
  batch.unexcited_bound = unexcited_bound;
  batch.validate(parameters);
  if (block < 1) throw InputError("recursive.block", fmt::format("is {}; must be at least 1 sample", block));
  if (method == Method::kOls) return;
  if (error_covariance.size() == 0) {
    throw InputError("recursive.error_covariance",
                     fmt::format("is missing; {} needs it (OLS does not)", to_string(method)));
  }
  check_error_covariance(error_covariance, parameters + 1);
}

RecursiveRegression::RecursiveRegression(std::vector<std::string> names, RecursiveOptions options) {
  options.validate(names.size());
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (!seen.insert(name).second) throw InputError("recursive", fmt::format("two parameters are named '{}'", name));
  }
  state_ = std::make_unique<State>(std::move(names), std::move(options));
}

RecursiveRegression::~RecursiveRegression() = default;
RecursiveRegression::RecursiveRegression(RecursiveRegression&&) noexcept = default;
RecursiveRegression& RecursiveRegression::operator=(RecursiveRegression&&) noexcept = default;
RecursiveRegression::RecursiveRegression(const RecursiveRegression& other)
    : state_(std::make_unique<State>(*other.state_)) {}
RecursiveRegression& RecursiveRegression::operator=(const RecursiveRegression& other) {
  if (this != &other) state_ = std::make_unique<State>(*other.state_);
  return *this;
}

void RecursiveRegression::start(const Eigen::VectorXd& theta_0, const Eigen::MatrixXd& P_0, double rows,
                                double residual_sd) {
  const Eigen::Index n = parameters();
  if (theta_0.size() != n || P_0.rows() != n || P_0.cols() != n) {
    throw InputError("recursive.start", fmt::format("theta_0 has {} values and P_0 is {} x {}; must be {} and {} x {}",
                                                    theta_0.size(), P_0.rows(), P_0.cols(), n, n, n));
  }
  if (!theta_0.allFinite() || !P_0.allFinite()) {
    throw InputError("recursive.start", "theta_0 or P_0 has a value that is not finite; is the batch estimate usable?");
  }
  if (!(rows == 0.0 || rows > static_cast<double>(n)) || !std::isfinite(rows)) {
    throw InputError("recursive.start", fmt::format("rows is {}; must be 0 or above {}", rows, n));
  }
  if (!(residual_sd >= 0.0) || !std::isfinite(residual_sd)) {
    throw InputError("recursive.start", fmt::format("residual_sd is {}; must be >= 0 and finite", residual_sd));
  }
  if (state_->rows > 0 || state_->prior_rows > 0.0) {
    throw InputError("recursive.start", "comes after rows were taken; must come first, and once");
  }
  state_->start(theta_0, P_0, rows, residual_sd);
}

void RecursiveRegression::set_equation_error(double variance) {
  if (state_->options.method != Method::kOls && variance != state_->equation_error)
    state_->set_equation_error(variance);
}
double RecursiveRegression::equation_error() const { return state_->equation_error; }

RecursiveUpdate RecursiveRegression::update(std::span<const double> x, double z) { return state_->update(x, z); }

Eigen::Index RecursiveRegression::parameters() const { return signed_index(state_->names.size()); }
const std::vector<std::string>& RecursiveRegression::names() const { return state_->names; }
const RecursiveOptions& RecursiveRegression::options() const { return state_->options; }
const SmallVector& RecursiveRegression::theta() const { return state_->theta; }
EstimateTermination RecursiveRegression::termination() const { return state_->termination; }
const SmallMatrix& RecursiveRegression::covariance() const {
  return state_->error_bars(state_->options.covariance).covariance;
}
const SmallMatrix& RecursiveRegression::covariance_white() const {
  return state_->error_bars(CovarianceKind::kWhite).covariance;
}
const SmallVector& RecursiveRegression::sigma() const { return state_->error_bars(state_->options.covariance).sigma; }
const SmallVector& RecursiveRegression::singular_values() const { return state_->singular_values; }
double RecursiveRegression::threshold() const { return state_->threshold; }
Eigen::Index RecursiveRegression::excited_directions() const { return state_->excited_directions; }
const SmallMatrix& RecursiveRegression::unexcited() const { return state_->unexcited_combinations; }
const SmallVector& RecursiveRegression::unexcited_share() const { return state_->unexcited_share; }

std::string RecursiveRegression::unexcited_text() const {
  std::string text;
  for (Eigen::Index j = 0; j < unexcited().cols(); ++j) {
    text += (text.empty() ? "" : "; ") + describe_combination(unexcited().col(j), names());
  }
  return text;
}

ParameterStatus RecursiveRegression::status(Eigen::Index parameter, double significance) const {
  return state_->status(parameter, significance);
}

double RecursiveRegression::effective_samples() const { return state_->samples; }
double RecursiveRegression::residual_sd() const {
  return state_->residual_variance >= 0.0 ? std::sqrt(state_->residual_variance) : kNaN;
}
double RecursiveRegression::error_scale() const { return state_->options.method == Method::kOls ? 0.0 : state_->scale; }
double RecursiveRegression::degrees_of_freedom() const {
  return state_->error_bars(state_->options.covariance).degrees_of_freedom;
}
std::uint64_t RecursiveRegression::rows() const { return state_->rows; }
std::uint64_t RecursiveRegression::refused() const { return state_->refused; }
std::uint64_t RecursiveRegression::triggers() const { return state_->variable.triggers(); }

RegressionEstimate RecursiveRegression::estimate(double significance) const { return state_->estimate(significance); }

}  // namespace veridyn::estimation
