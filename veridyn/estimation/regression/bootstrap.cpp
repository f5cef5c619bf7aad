#include "veridyn/estimation/regression/bootstrap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/regression/augmented_qr.hpp"
#include "veridyn/estimation/regression/equation_error.hpp"
#include "veridyn/estimation/regression/long_run_covariance.hpp"
#include "veridyn/estimation/regression/ordinary_least_squares.hpp"
#include "veridyn/estimation/regression/total_least_squares.hpp"
#include "veridyn/numerics/random.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::estimation {
namespace {

using Eigen::Index;

constexpr std::size_t kLeastReplicates = 50;

/// Blocks of rows, drawn until `rows` are filled.
RegressionData resample_rows(const RegressionData& data, const SegmentRanges& segments, Index block, bool circular,
                             numerics::RandomStream& random) {
  const Index N = data.rows();
  RegressionData drawn;
  drawn.parameter_names = data.parameter_names;
  drawn.parameter_units = data.parameter_units;
  drawn.regressand_name = data.regressand_name;
  drawn.error_covariance = data.error_covariance;
  drawn.error_scale_known = data.error_scale_known;
  drawn.regressand_error_known = data.regressand_error_known;
  drawn.regressors.resize(N, data.parameters());
  drawn.regressand.resize(N);
  if (data.row_scale.size() > 0) drawn.row_scale.resize(N);
  drawn.segment.resize(N);
  Index at = 0;
  for (int id = 0; at < N; ++id) {
    // A row decides segment and beginning, so segments are drawn in proportion to their length.
    const auto row = static_cast<Index>(random.index(static_cast<std::uint64_t>(N)));
    const auto range =
        std::find_if(segments.begin(), segments.end(), [&](const auto& s) { return row >= s.first && row < s.second; });
    const Index length = range->second - range->first;
    Index first = row - range->first;
    if (!circular) first = std::min(first, std::max<Index>(0, length - block));
    const Index count = std::min({block, length, N - at});
    for (Index i = 0; i < count; ++i, ++at) {
      const Index from = range->first + (first + i) % length;
      drawn.regressors.row(at) = data.regressors.row(from);
      drawn.regressand(at) = data.regressand(from);
      if (data.row_scale.size() > 0) drawn.row_scale(at) = data.row_scale(from);
      drawn.segment[at] = id;
    }
  }
  return drawn;
}

Index automatic_block(const RegressionData& data) {
  const OrdinaryLeastSquares ols = ordinary_least_squares(triangle_of(data));
  const Eigen::VectorXd residual = data.regressand - data.regressors * ols.theta;
  Index longest = 1;
  for (Index j = 0; j < data.parameters(); ++j) {
    const Eigen::VectorXd score = data.regressors.col(j).cwiseProduct(residual);
    longest = std::max(longest, politis_white_block_length(score, data.segment));
  }
  return longest;
}

}  // namespace

void BootstrapOptions::validate(Index rows) const {
  if (replicates < kLeastReplicates || replicates > 1000000) {
    throw InputError("bootstrap.replicates",
                     fmt::format("is {}; must be from {} to 1000000", replicates, kLeastReplicates));
  }
  if (block_length < 0 || block_length > rows)
    throw InputError("bootstrap.block_length",
                     fmt::format("is {}; must be from 0 to {}, the rows", block_length, rows));
  if (threads < 0)
    throw InputError("bootstrap.threads", fmt::format("is {}; must be >= 0 (0: those of the progress)", threads));
}

bool Bootstrap::usable() const {
  const auto done = static_cast<std::size_t>(replicates.rows());
  return !interrupted && done >= kLeastReplicates && failed * 9 <= done;
}

PointEstimator point_estimator(Method method, const RegressionOptions& options) {
  return [method, options](const RegressionData& data) -> std::optional<Eigen::VectorXd> {
    if (method == Method::kOls) {
      const OrdinaryLeastSquares ols = ordinary_least_squares(triangle_of(data));
      return ols.full_rank ? std::optional<Eigen::VectorXd>(ols.theta) : std::nullopt;
    }
    if (method == Method::kGtls && data.has_error_covariance()) {
      const Eigen::MatrixXd triangle = triangle_of(data);
      const auto rows = static_cast<double>(data.rows());
      const Eigen::MatrixXd W = data.regressand_error_known
                                    ? data.error_covariance
                                    : with_equation_error(triangle, data.error_covariance, rows);
      const ErrorRatio ratio = data.regressand_error_known ? ErrorRatio::kKnown : ErrorRatio::kEstimated;
      const TotalLeastSquares tls = total_least_squares(triangle, W, rows, ratio);
      return tls.solved && tls.full_rank ? std::optional<Eigen::VectorXd>(tls.theta) : std::nullopt;
    }
    RegressionOptions plain = options;
    plain.covariance = CovarianceKind::kWhite;
    const RegressionEstimate e = estimate(data, method, plain);
    return e.usable() ? std::optional<Eigen::VectorXd>(e.theta) : std::nullopt;
  };
}

Bootstrap block_bootstrap(const RegressionData& data, const PointEstimator& estimator,
                          const BootstrapOptions& options) {
  Progress silent;
  return block_bootstrap(data, estimator, options, silent);
}

Bootstrap block_bootstrap(const RegressionData& data, const PointEstimator& estimator, const BootstrapOptions& options,
                          Progress& progress) {
  data.validate();
  options.validate(data.rows());
  Bootstrap result;
  const SegmentRanges segments = segment_ranges(data.rows(), data.segment);
  result.block_length = options.block_length > 0 ? options.block_length : automatic_block(data);
  std::vector<std::optional<Eigen::VectorXd>> estimates(options.replicates);
  std::atomic<bool> stop{false};
  std::atomic<std::size_t> done{0};
  std::mutex mutex;
  const int threads = options.threads > 0 ? options.threads : progress.threads();
  numerics::parallel_for(options.replicates, threads, [&](std::size_t i) {
    if (stop) return;
    numerics::RandomStream random(options.seed, static_cast<std::uint64_t>(i));
    estimates[i] = estimator(resample_rows(data, segments, result.block_length, options.circular, random));
    const std::size_t finished = ++done;
    const std::lock_guard lock(mutex);
    if (!progress.update(static_cast<double>(finished) / static_cast<double>(options.replicates))) stop = true;
  });
  result.interrupted = stop;
  const Index n = data.parameters();
  for (const auto& e : estimates) {
    if (!e || !e->allFinite() || e->size() != n) {
      ++result.failed;
      continue;
    }
    result.replicates.conservativeResize(result.replicates.rows() + 1, n);
    result.replicates.row(result.replicates.rows() - 1) = e->transpose();
  }
  const Index count = result.replicates.rows();
  result.mean = result.sigma = result.low95 = result.high95 = Eigen::VectorXd::Constant(n, kNaN);
  result.covariance = Eigen::MatrixXd::Constant(n, n, kNaN);
  if (result.interrupted || count < 2) {
    result.message = result.interrupted ? "interrupted" : "the estimator failed on every resampled data set";
    return result;
  }
  result.mean = result.replicates.colwise().mean().transpose();
  const Eigen::MatrixXd centred = result.replicates.rowwise() - result.mean.transpose();
  result.covariance = centred.transpose() * centred / static_cast<double>(count - 1);
  result.sigma = result.covariance.diagonal().cwiseSqrt();
  for (Index j = 0; j < n; ++j) {
    std::vector<double> sorted(static_cast<std::size_t>(count));
    for (Index i = 0; i < count; ++i) sorted[i] = result.replicates(i, j);
    std::sort(sorted.begin(), sorted.end());
    result.low95(j) = numerics::quantile_of_sorted(sorted, 0.025);
    result.high95(j) = numerics::quantile_of_sorted(sorted, 0.975);
  }
  result.message =
      fmt::format("{} replicates of blocks of {} rows{}", count, result.block_length,
                  result.failed > 0 ? fmt::format("; the estimator failed on {} more", result.failed) : "");
  return result;
}

Index politis_white_block_length(const Eigen::Ref<const Eigen::VectorXd>& x, const std::vector<int>& segment) {
  const Index N = x.size();
  const SegmentRanges segments = segment_ranges(N, segment);
  const Eigen::VectorXd centred = x.array() - x.mean();
  const Index m = correlation_length(centred, segments, N / 8);
  if (m == 0) return 1;
  const Index lags = 2 * m;
  double density = 0.0, curvature = 0.0;
  for (Index lag = 0; lag < lags; ++lag) {
    double sum = 0.0;
    for (const auto& [begin, end] : segments) {
      const Index count = end - begin - lag;
      if (count > 0) sum += centred.segment(begin, count).dot(centred.segment(begin + lag, count));
    }
    const double weight = std::min(1.0, 2.0 * (1.0 - static_cast<double>(lag) / static_cast<double>(lags)));
    const double R = weight * sum / static_cast<double>(N);
    density += (lag == 0 ? 1.0 : 2.0) * R;
    curvature += 2.0 * static_cast<double>(lag) * R;
  }
  if (!(density > 0.0)) return std::min(lags, std::max<Index>(1, N / 10));
  const double ratio = curvature / density;
  const double length = std::cbrt(1.5 * ratio * ratio * static_cast<double>(N));
  return std::clamp<Index>(static_cast<Index>(std::ceil(length)), 1, std::max<Index>(1, N / 10));
}

}  // namespace veridyn::estimation
