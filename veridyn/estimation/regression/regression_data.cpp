#include "veridyn/estimation/regression/regression_data.hpp"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"

namespace veridyn::estimation {

void check_error_covariance(const Eigen::MatrixXd& W, Eigen::Index size) {
  if (W.rows() != size || W.cols() != size) {
    throw InputError(
        "regression.error_covariance",
        fmt::format("is {} x {}; must be {} x {}, of [regressors, regressand]", W.rows(), W.cols(), size, size));
  }
  if (!W.allFinite()) throw InputError("regression.error_covariance", "has an element that is not finite");
  Eigen::VectorXd sd(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    if (!(W(i, i) >= 0.0)) {
      throw InputError("regression.error_covariance",
                       fmt::format("element ({0}, {0}) is {1}; must be >= 0", i, W(i, i)));
    }
    sd(i) = std::sqrt(W(i, i));
  }
  if (!(W(size - 1, size - 1) > 0.0)) {
    throw InputError("regression.error_covariance", "variance of the regressand's error is 0; must be > 0");
  }
  Eigen::MatrixXd correlation = Eigen::MatrixXd::Identity(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < size; ++j) {
      const double product = sd(i) * sd(j);
      if (std::abs(W(i, j) - W(j, i)) > 1e-9 * product) {
        throw InputError(
            "regression.error_covariance",
            fmt::format("element ({}, {}) is {} but ({}, {}) is {}; must be symmetric", i, j, W(i, j), j, i, W(j, i)));
      }
      if (product == 0.0 && W(i, j) != 0.0) {
        throw InputError("regression.error_covariance",
                         fmt::format("element ({}, {}) is {} although one of the two variances is 0", i, j, W(i, j)));
      }
      if (product > 0.0) correlation(i, j) = W(i, j) / product;
    }
  }
  const double smallest = numerics::symmetric_eigenvalues(correlation)(0);
  if (smallest < -1e-9) {
    throw InputError(
        "regression.error_covariance",
        fmt::format("is indefinite (its correlation matrix has the eigenvalue {:.3g}); must be positive semi-definite",
                    smallest));
  }
}

void RegressionData::validate() const {
  const Eigen::Index n = regressors.cols();
  const Eigen::Index N = regressors.rows();
  if (n < 1) throw InputError("regression", "has no regressor; must have at least 1");
  if (regressand.size() != N) {
    throw InputError("regression",
                     fmt::format("regressand has {} rows, regressors have {}; must be equal", regressand.size(), N));
  }
  if (signed_index(parameter_names.size()) != n) {
    throw InputError("regression", fmt::format("{} parameter names for {} regressors", parameter_names.size(), n));
  }
  std::set<std::string> seen;
  for (const std::string& name : parameter_names) {
    if (!seen.insert(name).second) throw InputError("regression", fmt::format("two parameters are named '{}'", name));
  }
  if (!parameter_units.empty() && signed_index(parameter_units.size()) != n) {
    throw InputError("regression", fmt::format("{} parameter units for {} regressors", parameter_units.size(), n));
  }
  if (N < n + 1) {
    throw InputError("regression", fmt::format("{} rows for {} parameters of {}; must have at least {}", N, n,
                                               regressand_name, n + 1));
  }
  for (Eigen::Index k = 0; k < N; ++k) {
    if (!std::isfinite(regressand(k))) {
      throw InputError(fmt::format("regression of {}: row {}", regressand_name, k),
                       fmt::format("regressand is {}; must be finite", regressand(k)));
    }
    for (Eigen::Index j = 0; j < n; ++j) {
      if (!std::isfinite(regressors(k, j))) {
        throw InputError(fmt::format("regression of {}: row {}", regressand_name, k),
                         fmt::format("regressor of {} is {}; must be finite", parameter_names[j], regressors(k, j)));
      }
    }
  }
  if (row_scale.size() > 0) {
    if (row_scale.size() != N)
      throw InputError("regression.row_scale", fmt::format("has {} values for {} rows", row_scale.size(), N));
    if (!(row_scale.array() > 0.0).all() || !row_scale.allFinite())
      throw InputError("regression.row_scale", "must be > 0 and finite everywhere");
  }
  if (!segment.empty()) {
    if (signed_index(segment.size()) != N)
      throw InputError("regression.segment", fmt::format("has {} ids for {} rows", segment.size(), N));
    std::set<int> done;
    for (const auto& [begin, end] : segment_ranges(N, segment)) {
      const int id = segment[begin];
      if (!done.insert(id).second)
        throw InputError("regression.segment",
                         fmt::format("id {} comes back at row {}; rows of a segment must be contiguous", id, begin));
    }
  }
  if (has_error_covariance() && !regressand_error_known && !error_scale_known) {
    throw InputError("regression.regressand_error_known",
                     "is false while the scale of the errors is not known either; one of them must be");
  }
  if (has_error_covariance()) check_error_covariance(error_covariance, n + 1);
}

std::vector<std::pair<Eigen::Index, Eigen::Index>> segment_ranges(Eigen::Index rows, std::span<const int> segment) {
  std::vector<std::pair<Eigen::Index, Eigen::Index>> ranges;
  Eigen::Index begin = 0;
  for (Eigen::Index k = 1; k <= rows; ++k) {
    if (k == rows || (!segment.empty() && segment[k] != segment[k - 1])) {
      ranges.emplace_back(begin, k);
      begin = k;
    }
  }
  if (rows == 0) ranges.clear();
  return ranges;
}

Eigen::Index drop_rows_that_are_not_finite(RegressionData& data) {
  const Eigen::Index N = data.rows();
  std::vector<Eigen::Index> kept;
  std::vector<int> ids;
  int id = -1;
  bool broken = true;
  for (Eigen::Index k = 0; k < N; ++k) {
    const bool finite = data.regressors.row(k).allFinite() && std::isfinite(data.regressand(k)) &&
                        (data.row_scale.size() == 0 || std::isfinite(data.row_scale(k)));
    const auto here = static_cast<std::size_t>(k);
    const bool new_segment = k > 0 && !data.segment.empty() && data.segment[here] != data.segment[here - 1];
    broken = broken || new_segment;
    if (!finite) {
      broken = true;
      continue;
    }
    if (broken) ++id;
    broken = false;
    kept.push_back(k);
    ids.push_back(id);
  }
  const auto count = signed_index(kept.size());
  if (count == N) return 0;
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index from = kept[k];
    data.regressors.row(k) = data.regressors.row(from).eval();
    data.regressand(k) = data.regressand(from);
    if (data.row_scale.size() > 0) data.row_scale(k) = data.row_scale(from);
  }
  data.regressors.conservativeResize(count, Eigen::NoChange);
  data.regressand.conservativeResize(count);
  if (data.row_scale.size() > 0) data.row_scale.conservativeResize(count);
  data.segment = std::move(ids);
  return N - count;
}

}  // namespace veridyn::estimation
