#pragma once

#include <optional>

#include "veridyn/estimation/regression/bootstrap.hpp"
#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/estimation/regression/structure_search.hpp"
#include "veridyn/estimation/result/analysis.hpp"

namespace veridyn::estimation {

/// How rows of any origin are regressed and judged.
struct JudgedRegressionOptions {
  std::optional<Method> method = {};              ///< nothing: what `compare` recommends
  std::optional<StructureMethod> structure = {};  ///< nothing: all columns
  std::size_t bootstrap = 0;                      ///< replicates of a block bootstrap; 0: none
  std::uint64_t seed = 1;                         ///< of the bootstrap
  RegressionOptions regression = {};
};

/// A regression with everything that may be said of it.
struct JudgedRegression : Analysis {
  RegressionData data;  ///< of the chosen columns, complete rows only
  RegressionComparison comparison;
  std::optional<RegressionEstimate> chosen;
  std::optional<StructureSearch> search;
  Eigen::VectorXd predicted;  ///< of every row by the chosen estimate, empty without one
  Eigen::Index dropped = 0;   ///< rows that were not complete
};

/// All methods on the rows, the recommended one (or the one that is asked for), and the rows of evidence that decide:
/// - *rows*: whether there are ten a parameter, and *incomplete rows*: how many were left out;
/// - *collinearity*, *residual autocorrelation*, size and place of the errors: those of `compare`;
/// - *agreement of the parts*: both halves of the rows (or of the segments), estimated separately, must agree within
///   their error bars; where they differ beyond chance at 5 % the intervals are widened by what they differ by;
/// - *cross-validation*: every fifth of the rows (or every segment) predicted by an estimate from the others must be
///   nearer than the mean of these.
/// @throws InputError when data or options are wrong
[[nodiscard]] JudgedRegression judged_regression(RegressionData data, const JudgedRegressionOptions& options,
                                                 Progress& progress);

}  // namespace veridyn::estimation
