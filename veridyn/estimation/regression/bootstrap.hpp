#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/regression/regression.hpp"

namespace veridyn::estimation {

/// How a bootstrap resamples.
struct BootstrapOptions {
  std::size_t replicates = 500;
  /// Rows per block; 0 chooses the rule of Politis & White (2004, corrected 2009) for the scores x_k r_k.
  Eigen::Index block_length = 0;
  /// Blocks wrap round the end of their segment, so that every row is drawn equally often; false: moving blocks, which
  /// draw rows near the ends less often.
  bool circular = true;
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: those of the progress; any number gives identical bits

  /// @throws InputError naming the option, its value and its rule.
  void validate(Eigen::Index rows) const;
};

/// An estimator to be resampled: parameters from rows, or none when it fails on them. Called from several threads.
using PointEstimator = std::function<std::optional<Eigen::VectorXd>(const RegressionData&)>;

/// theta of a method, without error bars. PCA-GTLS takes its thresholds and prior from `options`.
[[nodiscard]] PointEstimator point_estimator(Method method, const RegressionOptions& options = {});

/// Distribution of an estimate over resampled data.
struct Bootstrap {
  RowMatrix replicates;  ///< successful ones x parameters, in order of their number
  Eigen::VectorXd mean, sigma;
  Eigen::MatrixXd covariance;
  Eigen::VectorXd low95, high95;  ///< percentiles 2.5 and 97.5
  Eigen::Index block_length = 0;
  std::size_t failed = 0;  ///< replicates on which the estimator gave nothing
  bool interrupted = false;
  std::string message;  ///< one sentence
  /// At least 50 replicates, and nine of ten succeeded.
  [[nodiscard]] bool usable() const;
};

/// Block bootstrap of rows (Kuensch 1989; Politis & Romano 1992): whole blocks of neighbouring rows [x, z] are drawn
/// with replacement until there are as many rows as before, and the estimate repeated. It assumes neither a
/// distribution nor independence of X and residual, only that rows more than a block apart are independent: the error
/// bar of last resort for any estimator. Blocks stay within segments; each becomes a separate segment. Its variance
/// is too small by about the correlation length over the block length. Replicate i draws from stream i of the seed,
/// whatever the threads.
/// @throws InputError when data or options are wrong.
[[nodiscard]] Bootstrap block_bootstrap(const RegressionData& data, const PointEstimator& estimator,
                                        const BootstrapOptions& options = {});
/// The same, interruptible.
[[nodiscard]] Bootstrap block_bootstrap(const RegressionData& data, const PointEstimator& estimator,
                                        const BootstrapOptions& options, Progress& progress);

/// Block length that minimises the mean square error of a circular block bootstrap's variance of the mean of `x`:
/// (3/2 G^2/g(0)^2 N)^(1/3), with G = sum |k| R(k) and g(0) = sum R(k) under a flat-top window (Politis & White 2004,
/// Econometric Reviews 23; correction Patton, Politis & White 2009); 1 for white x, at most N/10.
[[nodiscard]] Eigen::Index politis_white_block_length(const Eigen::Ref<const Eigen::VectorXd>& x,
                                                      const std::vector<int>& segment = {});

}  // namespace veridyn::estimation
