#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/estimation/regression/regression.hpp"

namespace veridyn::estimation {

/// How terms are chosen.
enum class StructureMethod {
  kStepwise,   ///< enter and remove single terms by their partial F
  kOrthogonal  ///< orthogonal functions, as many as minimise the predicted squared error
};

/// How terms are chosen among candidates, and when the search ends.
struct StructureOptions {
  StructureMethod method = StructureMethod::kStepwise;
  /// Stepwise: partial F above which a term enters. 20 instead of the 4 of a 95 % test, as Klein & Morelli advise,
  /// since residuals of flight are autocorrelated and terms many.
  double f_enter = 20.0;
  double f_remove = 20.0;        ///< stepwise: a term whose partial F fell below is removed; at most `f_enter`
  double min_r2_change = 0.005;  ///< stepwise: a term that explains less of the variance does not enter
  bool stop_at_least_press =
      true;  ///< stepwise: a term that raises the sum of squared prediction errors does not enter
  /// Orthogonal: multiply the penalty of the predicted squared error by how much the autocorrelation of the residuals
  /// raises the variance of parameters (median over the fit with all candidates). Without it a term enters for
  /// following autocorrelated noise: Morelli's penalty alone is right for white residuals.
  bool autocorrelation_penalty = true;
  /// Orthogonal: terms of the chosen model that contribute less than this share of its RMS are dropped.
  double least_contribution = 1e-3;
  /// Columns that are always in, in addition to constant ones.
  std::vector<Eigen::Index> always = {};
  double significance = 0.05;  ///< of the t-tests of the final estimate

  /// @throws InputError naming the option, its value and its rule.
  void validate(Eigen::Index parameters) const;
};

/// What happened to a term.
enum class StructureAction {
  kStart,   ///< the model before the search: constants and what is always in
  kEnter,   ///< came in
  kRemove,  ///< went out again (stepwise), or contributes too little to be kept (orthogonal)
  kRefuse   ///< the best of the rest, and why it stays out
};
[[nodiscard]] std::string_view to_string(StructureAction action);

/// One row of the history: the model after the action (for `kRefuse`: as it would have been).
struct StructureStep {
  StructureAction action = StructureAction::kStart;
  std::string term;  ///< empty at the start
  Eigen::Index terms = 0;
  double F = 0.0;            ///< partial F of the term
  double residual_sd = 0.0;  ///< sqrt(RSS / (N - terms))
  double r2 = 0.0;           ///< share of the variance of z explained
  double r2_change = 0.0;
  double press = 0.0;    ///< sum of squared errors of each row predicted by a fit to all others
  double pse = 0.0;      ///< predicted squared error: RSS/N + sigma_max^2 terms/N, sigma_max^2 the variance of z
  bool in_model = true;  ///< does this row lie on the way to the chosen model?
  std::string reason;    ///< for `kRefuse` and `kRemove`
};

/// The chosen structure in the ordinary terms of the data, and the way there.
struct StructureSearch {
  StructureMethod method = StructureMethod::kStepwise;
  std::vector<StructureStep> history;
  double penalty = 1.0;  ///< c of the predicted squared error: 1, or more where residuals are autocorrelated
  std::vector<Eigen::Index> selected;  ///< columns of the data, ascending
  RegressionEstimate estimate;         ///< OLS of the chosen terms, error bars for autocorrelated residuals
  std::string text;                    ///< one sentence
};

/// Which of the columns of `data` (candidate terms) belong into the model.
///
/// Stepwise (Klein & Morelli 2006, sec. 5.4.1): the term of largest partial F enters if it passes all three criteria;
/// then every term whose F fell below `f_remove` goes, smallest first. Orthogonal (Morelli 1993; sec. 5.4.2):
/// candidates are made orthogonal to those already chosen, the one that lowers the fit error most comes next, and the
/// number of terms is that of least predicted squared error over the whole sequence; retained functions are expanded in
/// ordinary terms without loss. Constant columns are always in. Columns that are linearly dependent on those in the
/// model cannot enter.
/// @throws InputError when data or options are wrong.
[[nodiscard]] StructureSearch search_structure(const RegressionData& data, const StructureOptions& options = {});

/// The data with some of its columns, in the given order; W reduced accordingly.
[[nodiscard]] RegressionData select_columns(const RegressionData& data, const std::vector<Eigen::Index>& columns);

}  // namespace veridyn::estimation
