#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "veridyn/core/index.hpp"
#include "veridyn/estimation/recursive/forgetting.hpp"
#include "veridyn/estimation/recursive/recursive_regression.hpp"
#include "veridyn/estimation/recursive/recursive_total_least_squares.hpp"
#include "veridyn/estimation/recursive/score_blocks.hpp"

namespace veridyn::estimation {

namespace internal {

/// Columns of one row, on the stack.
using RecursiveRow = std::array<double, kMaxRecursiveColumns>;

/// Error bars of all parameters, computed at the first call after an update.
struct RecursiveErrorBars {
  SmallMatrix covariance;
  SmallVector sigma;
  SmallVector excited_variance;     ///< part of sigma^2 that does not come from the bound
  SmallVector freedom;              ///< of Student's t, parameter by parameter
  double degrees_of_freedom = 0.0;  ///< least of them
  bool fresh = false;
};

}  // namespace internal

/// Parameters are split in free and pinned ones; the regression runs on the free ones, z less the pinned part.
struct RecursiveRegression::State {
  State(std::vector<std::string> parameter_names, RecursiveOptions recursive_options);

  void start(const Eigen::VectorXd& theta_0, const Eigen::MatrixXd& P_0, double rows_behind, double residual_sd);
  void set_equation_error(double variance);
  RecursiveUpdate update(std::span<const double> x, double z);
  /// Free regressors, and z less the pinned part, as a row. @return whether it can be taken
  [[nodiscard]] bool take_row(std::span<const double> x, double z, internal::RecursiveRow& row) const;
  /// Score of a row before it is taken, and what its innovation says: forgetting and sigma go into `result`.
  void score_row(const internal::RecursiveRow& row, RecursiveUpdate& result);
  void solve();
  bool solve_least();
  bool solve_excited(int excited);
  const internal::RecursiveErrorBars& error_bars(CovarianceKind kind) const;
  void add_unexcited_bound(const SmallMatrix& jacobian, SmallMatrix& bound) const;
  void compute_error_bars(CovarianceKind kind, internal::RecursiveErrorBars& bars) const;
  bool inverse_jacobian(const SmallVector& h, SmallMatrix& inverse) const;
  void inverse_on_excited(const SmallMatrix& jacobian, SmallMatrix& inverse) const;
  void white_filling(const SmallMatrix& jacobian, const SmallVector& W_h, double s2, SmallMatrix& S) const;
  void add_collinearity(RegressionEstimate& result) const;
  [[nodiscard]] double long_correlation(const SmallMatrix& inverse) const;
  void corrected_jacobian(SmallMatrix& M) const;
  ParameterStatus status(Eigen::Index parameter, double significance) const;
  RegressionEstimate estimate(double significance) const;
  [[nodiscard]] Eigen::Index count() const { return signed_index(free.size()); }

  std::vector<std::string> names;
  RecursiveOptions options;
  std::vector<Eigen::Index> free;    // indices of parameters that are not pinned
  std::vector<Eigen::Index> pinned;  // and of those that are
  SmallVector prior;                 // of all parameters
  SmallVector free_weight;           // U
  SmallMatrix W;                     // of the free regressors and z
  double equation_error = 0.0;       // variance of z in W beyond what was given
  bool forgets = false;

  RecursiveTotalLeastSquares data;
  VariableForgetting variable;
  internal::ScoreBlocks scores;
  SmallVector column_sums, column_squares;  // of the free regressors, weighted, rows of a start not among them
  double column_weight = 0.0;
  SmallMatrix squares;  // A2: sum of w_k^2 x x', free parameters

  std::uint64_t rows = 0;
  std::uint64_t refused = 0;
  double prior_rows = 0.0;       // what a hybrid start counts for
  double samples = 0.0;          // N = sum w_k
  double squared_weights = 0.0;  // sum w_k^2

  EstimateTermination termination = EstimateTermination::kTooFewRows;
  SmallVector theta;
  SmallVector free_theta;
  SmallVector h;    // [free theta; -1]
  SmallVector W_h;  // W h
  double h_W_h = 1.0;
  double scale = 0.0;               // c = s_min^2/(N - n)
  double residual_variance = -1.0;  // of z - x theta; negative while unknown
  double threshold = 0.0;
  int excited_noisy = 0;
  Eigen::Index excited_directions = 0;
  Eigen::Index most_excited = 0;  // so far
  SmallVector singular_values;
  SmallMatrix unexcited;               // orthonormal in U coordinates, free parameters
  SmallMatrix unexcited_combinations;  // unit columns, all parameters
  SmallVector unexcited_share;         // all parameters

  mutable internal::RecursiveErrorBars white_bars;
  mutable internal::RecursiveErrorBars autocorrelated_bars;
};

}  // namespace veridyn::estimation
