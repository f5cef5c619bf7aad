#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "veridyn/estimation/recursive/forgetting.hpp"
#include "veridyn/estimation/recursive/small_matrix.hpp"
#include "veridyn/estimation/regression/regression.hpp"

namespace veridyn::estimation {

/// How a regression is estimated row by row.
struct RecursiveOptions {
  /// OLS, GTLS or PCA-GTLS.
  Method method = Method::kPcaGtls;
  ForgettingOptions forgetting = {};
  /// W, covariance of the errors of one row [x, z], (n_p + 1) x (n_p + 1); rows of exact columns are zero. Needed by
  /// GTLS and PCA-GTLS, ignored by OLS.
  Eigen::MatrixXd error_covariance = {};
  /// False: W is known up to a factor; the threshold then uses the factor estimated from the residual.
  bool error_scale_known = true;
  /// S/n of the threshold (S/n + 1) sqrt(N - n_p), N the effective number of samples; in [1, 10].
  double signal_to_noise = 1.0;
  /// Estimate before there are data; empty means 0. Pinned parameters stay there.
  Eigen::VectorXd prior = {};
  /// PCA-GTLS: weights U of |U (theta - theta_0)|, > 0, infinity pins. Empty means 1.
  Eigen::VectorXd prior_weight = {};
  /// PCA-GTLS: B_0, 95 % bound on |U (theta - theta_0)| along a direction that is not excited. 0 chooses
  /// 10 max(1, largest |U (theta - prior)|_i); never below 1.96 sigma of GTLS in that direction.
  double unexcited_bound = 0.0;
  /// Error bars for autocorrelated residuals (the default) from sums of scores over blocks, or for white ones.
  CovarianceKind covariance = CovarianceKind::kAutocorrelated;
  /// Length of a block of scores [samples]: longer than the residual stays correlated (1 s at 100 Hz).
  Eigen::Index block = 100;

  /// @throws InputError naming the option, its value and its rule.
  void validate(Eigen::Index parameters) const;
};

/// What one row did.
struct RecursiveUpdate {
  double innovation = 0.0;        ///< z - x theta with theta before this row [unit of z]; NaN when refused
  double innovation_sigma = 0.0;  ///< its standard deviation: errors of row and estimate; NaN until it is known
  double lambda = 1.0;            ///< weight of squares that was applied
  bool accepted = false;   ///< false: the row holds a number that is not finite (or beyond 1e150); nothing changed
  bool triggered = false;  ///< variable forgetting was triggered by a change
};

/// One linear regression z = x theta estimated row by row, by OLS, GTLS or PCA-GTLS, with constant or variable
/// forgetting. Cost of a row does not depend on the rows before it, and `update` and all accessors but `estimate` and
/// `unexcited_text` do not allocate (at most 8 parameters; construction and `start` may).
///
/// With lambda = 1 theta and its white covariance are those of the batch estimators of the same rows
/// (veridyn/estimation/regression/regression.hpp); with forgetting they are those of rows weighted by lambda^(k/2), k
/// the age. Before there are as many independent rows as parameters theta is the prior (OLS, GTLS), and `usable` is
/// false.
///
/// PCA-GTLS holds what is not excited: theta_0 of its minimisation |U (theta - theta_0)| is the estimate before the
/// row, at first the prior. So along directions below the threshold theta stays where it was when they were last
/// excited; their error bars are the bound B_0, since what was known of them is
/// forgotten, and `unexcited` names them. Exact regressors have no noise, hence no threshold: they are held when
/// linearly dependent to rounding.
///
/// Error bars. White: s2 M^-1 A2 M^-1 with its second-order term, where squares carry their weight and A2 the weight
/// squared (docs/estimation.md). For autocorrelated residuals: M^-1 S M^-1, S from sums of scores over blocks of
/// `block` samples under the same weights, hence correct for any correlation shorter than a block, and extrapolated
/// from blocks of four times that length for what is longer. Degrees of freedom are, parameter by parameter, the blocks
/// that determine it. Scores begin again when a direction is excited for the first time: innovations before held its
/// error.
class RecursiveRegression {
 public:
  /// @param names of the parameters, 1 to 8 @throws InputError when names or options are wrong
  RecursiveRegression(std::vector<std::string> names, RecursiveOptions options);
  ~RecursiveRegression();
  RecursiveRegression(RecursiveRegression&&) noexcept;
  RecursiveRegression& operator=(RecursiveRegression&&) noexcept;
  RecursiveRegression(const RecursiveRegression&);
  RecursiveRegression& operator=(const RecursiveRegression&);

  /// Hybrid start from a batch estimate theta_0 with covariance P_0 (n_p x n_p, positive definite): rows
  /// [P_0^-1/2, P_0^-1/2 theta_0], in GTLS and PCA-GTLS times c_0 = sqrt(h' W h), in OLS times residual_sd. They are
  /// forgotten like any rows.
  /// @param rows number of rows behind the estimate: counts as samples (threshold, degrees of freedom); 0: unknown,
  ///   the rows themselves count
  /// @param residual_sd of the batch estimate [unit of z]: scale of its rows against those to come. 0 takes
  ///   sqrt(h' W h), or without W 1 (then P_0 must be (X'X)^-1).
  /// @throws InputError when sizes do not fit, P_0 is not positive definite or rows were already taken
  void start(const Eigen::VectorXd& theta_0, const Eigen::MatrixXd& P_0, double rows = 0.0, double residual_sd = 0.0);

  /// GTLS and PCA-GTLS: from now on, and for the rows that were taken, W has this variance more in z alone: an error of
  /// the equation. The estimate is that of the same rows with that W, which must stay positive semi-definite with
  /// W_zz > 0; less than what was given is allowed too. Allocates. No effect with OLS.
  void set_equation_error(double variance);
  /// Variance of z that was added to W.
  [[nodiscard]] double equation_error() const;

  /// Takes one row. Does not allocate or throw; `x` must have n_p values.
  RecursiveUpdate update(std::span<const double> x, double z);

  [[nodiscard]] Eigen::Index parameters() const;
  [[nodiscard]] const std::vector<std::string>& names() const;
  [[nodiscard]] const RecursiveOptions& options() const;

  [[nodiscard]] const SmallVector& theta() const;
  /// Is theta determined by rows (and start)? PCA-GTLS: as far as directions are excited.
  [[nodiscard]] bool usable() const { return termination() == EstimateTermination::kEstimated; }
  [[nodiscard]] EstimateTermination termination() const;
  /// n_p x n_p, of the chosen kind, bound on what is not excited included; infinite diagonal when not usable.
  /// Computed at the first call after an update.
  [[nodiscard]] const SmallMatrix& covariance() const;
  [[nodiscard]] const SmallMatrix& covariance_white() const;
  /// Square roots of the diagonal of `covariance`.
  [[nodiscard]] const SmallVector& sigma() const;

  /// Singular values of the whitened part with errors (one more than regressor combinations with errors), descending;
  /// OLS: empty.
  [[nodiscard]] const SmallVector& singular_values() const;
  /// Directions with larger singular values are excited (PCA-GTLS; the others only report it).
  [[nodiscard]] double threshold() const;
  /// Of n_p; exact ones included.
  [[nodiscard]] Eigen::Index excited_directions() const;
  /// Parameter combinations (unit columns) that are held; n_p x 0 when all are excited or the method is not PCA-GTLS.
  [[nodiscard]] const SmallMatrix& unexcited() const;
  /// Share (0..1) of each parameter's unit vector in held directions.
  [[nodiscard]] const SmallVector& unexcited_share() const;
  /// "0.71 CY_p + 0.70 CY_r; CY_dr", empty when all are excited. Allocates.
  [[nodiscard]] std::string unexcited_text() const;
  /// Of one parameter, by the rules of the batch estimators.
  [[nodiscard]] ParameterStatus status(Eigen::Index parameter, double significance = 0.05) const;

  /// N: sum of the weights of the rows.
  [[nodiscard]] double effective_samples() const;
  /// Weighted standard deviation of z - x theta [unit of z]; NaN until there are more rows than parameters.
  [[nodiscard]] double residual_sd() const;
  /// Estimated factor on W: 1 when model and assumed errors are right. OLS: 0.
  [[nodiscard]] double error_scale() const;
  /// Of Student's t: N - n_p, or the blocks that determine the parameter of which there are fewest.
  [[nodiscard]] double degrees_of_freedom() const;
  /// Rows taken and refused.
  [[nodiscard]] std::uint64_t rows() const;
  [[nodiscard]] std::uint64_t refused() const;
  /// Onsets of variable forgetting's trigger.
  [[nodiscard]] std::uint64_t triggers() const;

  /// The state in the form of a batch estimate (no residual statistics), for reports. Allocates.
  [[nodiscard]] RegressionEstimate estimate(double significance = 0.05) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace veridyn::estimation
