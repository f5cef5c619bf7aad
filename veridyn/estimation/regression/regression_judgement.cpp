#include "veridyn/estimation/regression/regression_judgement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/index.hpp"
#include "veridyn/estimation/judgement/agreement.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/estimation/judgement/limits.hpp"
#include "veridyn/estimation/regression/regression_evidence.hpp"

namespace veridyn::estimation {
namespace {

constexpr Eigen::Index kFolds = 5;

/// The number of each row's part: its segment where there are at least `parts`, else of `parts` equal stretches.
std::vector<Eigen::Index> parts_of(const RegressionData& data, Eigen::Index parts) {
  const auto ranges = segment_ranges(data.rows(), data.segment);
  std::vector<Eigen::Index> part(at(data.rows()));
  const bool by_segment = signed_index(ranges.size()) >= parts;
  for (std::size_t s = 0; s < ranges.size(); ++s)
    for (Eigen::Index i = ranges[s].first; i < ranges[s].second; ++i)
      part[i] = by_segment ? signed_index(s) * parts / signed_index(ranges.size()) : i * parts / data.rows();
  return part;
}

/// The rows of one part, or all others.
RegressionData rows_where(const RegressionData& data, const std::vector<Eigen::Index>& part, Eigen::Index which,
                          bool inside) {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < data.rows(); ++i)
    if ((part[i] == which) == inside) rows.push_back(i);
  RegressionData some = data;
  some.regressors = data.regressors(rows, Eigen::all);
  some.regressand = data.regressand(rows);
  some.segment.clear();
  int id = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const bool next = k > 0 && rows[k] == rows[k - 1] + 1 &&
                      (data.segment.empty() || data.segment[rows[k]] == data.segment[rows[k - 1]]);
    if (k > 0 && !next) ++id;
    some.segment.push_back(id);
  }
  if (data.row_scale.size() > 0) some.row_scale = data.row_scale(rows);
  return some;
}

Evidence rows_row(const RegressionData& data) {
  const auto rows = static_cast<double>(data.rows()), parameters = static_cast<double>(data.parameters());
  Evidence row = row_of(Check::kRows, "", rows / parameters);
  if (!row.passed()) row.cause = Cause::kLength;
  return std::move(row).with("rows", rows).with("parameters", parameters);
}

Evidence incomplete_rows(const RegressionData& data, Eigen::Index dropped) {
  const auto missing = static_cast<double>(dropped);
  Evidence row = row_of(Check::kIncompleteRows, "", missing / (static_cast<double>(data.rows()) + missing));
  if (!row.passed()) row.cause = Cause::kMissing;
  return std::move(row).with("dropped", missing);
}

/// Whether estimates of these rows have errors that are known.
bool enough_rows(const RegressionData& rows) {
  return static_cast<double>(rows.rows()) >=
         info_of(Check::kRows).tolerance.low * static_cast<double>(rows.parameters());
}

/// Both halves, each by the method of the whole.
std::optional<Agreement> agreement_of_halves(const RegressionData& data, Method method,
                                             const RegressionOptions& options) {
  const std::vector<Eigen::Index> part = parts_of(data, 2);
  std::array<RegressionEstimate, 2> half;
  for (Eigen::Index k = 0; k < 2; ++k) {
    const RegressionData rows = rows_where(data, part, k, true);
    if (!enough_rows(rows)) return std::nullopt;
    half[k] = estimate(rows, method, options);
    if (!half[k].usable()) return std::nullopt;
  }
  return agreement(half[0].theta - half[1].theta, half[0].covariance + half[1].covariance);
}

/// The factor on all variances by which halves scatter more than their error bars; 1 where that may be chance.
double widening_of(const std::optional<Agreement>& halves) {
  return halves && halves->p < kPartsDiffer ? std::max(1.0, halves->ratio) : 1.0;
}

Evidence agreement_row(const std::optional<Agreement>& halves) {
  if (!halves) return row_of(Check::kHalvesAgree, "", Outcome::kNotVerified);
  Evidence row = row_of(Check::kHalvesAgree, "", halves->p);
  if (!row.passed()) row.cause = Cause::kMissingTerm;
  return std::move(row).with("widening", std::sqrt(widening_of(halves)));
}

/// What is left of the variance when every part is predicted by the others.
std::optional<double> cross_validated_r2(const RegressionData& data, Method method, const RegressionOptions& options) {
  const auto segments = signed_index(segment_ranges(data.rows(), data.segment).size());
  const Eigen::Index folds = std::max(kFolds, std::min<Eigen::Index>(segments, 10));
  const std::vector<Eigen::Index> part = parts_of(data, folds);
  double missed = 0.0, varied = 0.0;
  for (Eigen::Index k = 0; k < folds; ++k) {
    const RegressionData others = rows_where(data, part, k, false), left_out = rows_where(data, part, k, true);
    if (left_out.rows() == 0) continue;
    if (others.rows() <= others.parameters() + 1) return std::nullopt;
    const RegressionEstimate fit = estimate(others, method, options);
    if (!fit.usable()) return std::nullopt;
    missed += (left_out.regressand - left_out.regressors * fit.theta).squaredNorm();
    varied += (left_out.regressand.array() - others.regressand.mean()).square().sum();
  }
  return varied > 0.0 ? std::optional(1.0 - missed / varied) : std::nullopt;
}

Evidence cross_validation_row(const std::optional<double>& r2) {
  return r2 ? row_of(Check::kCrossValidation, "", *r2) : row_of(Check::kCrossValidation, "", Outcome::kMissing);
}

/// What is recommended, or asked for, or (to be shown with the reason against it) what there is.
const RegressionEstimate* choose(const RegressionComparison& comparison, std::optional<Method> method) {
  if (method) {
    const RegressionEstimate* wanted = comparison.find(*method);
    return wanted != nullptr && wanted->usable() ? wanted : nullptr;
  }
  if (const RegressionEstimate* best = comparison.best()) return best;
  for (const Method fallback : {Method::kPcaGtls, Method::kGtls, Method::kOls})
    if (const RegressionEstimate* e = comparison.find(fallback); e != nullptr && e->usable()) return e;
  return nullptr;
}

Evidence method_row(const RegressionComparison& comparison, std::optional<Method> method, bool found) {
  const std::string recommended(comparison.recommends ? to_string(comparison.recommended) : "none");
  const std::string taken(method ? to_string(*method) : recommended);
  Evidence row = row_of(Check::kMethod, "", passed_or(found && (method || comparison.recommends), Outcome::kFailed));
  if (!row.passed()) row.cause = found ? Cause::kNoise : Cause::kMissing;
  return std::move(row).with("method", taken).with("recommended", recommended);
}

MethodResult by_bootstrap(const JudgedRegression& result, const JudgedRegressionOptions& options, Progress& progress) {
  const RegressionEstimate& chosen = *result.chosen;
  BootstrapOptions o;
  o.replicates = options.bootstrap;
  o.seed = options.seed;
  const Bootstrap b = block_bootstrap(result.data, point_estimator(chosen.method, options.regression), o, progress);
  MethodResult row{
      .method = fmt::format("bootstrap of {}", to_string(chosen.method)), .usable = b.usable(), .message = b.message};
  for (std::size_t i = 0; b.usable() && i < chosen.parameters.size(); ++i) {
    Parameter p = chosen.parameters[i];
    p.sigma = b.sigma(i);
    p.low95 = b.low95(i);
    p.high95 = b.high95(i);
    row.parameters.push_back(std::move(p));
  }
  return row;
}

std::string verdict_text(const JudgedRegression& result, const ParameterGroup& group) {
  if (!result.chosen) return fmt::format("{}: {}", to_string(group.verdict), result.comparison.reason);
  return fmt::format("{} by {}: it explains {:.1f} % of the variance of {} ({} rows)", to_string(group.verdict),
                     to_string(result.chosen->method), 100.0 * result.chosen->r_squared, result.data.regressand_name,
                     result.data.rows());
}

}  // namespace

JudgedRegression judged_regression(RegressionData data, const JudgedRegressionOptions& options, Progress& progress) {
  JudgedRegression result;
  result.dropped = drop_rows_that_are_not_finite(data);
  data.validate();
  if (options.structure) {
    StructureOptions search;
    search.method = *options.structure;
    search.significance = options.regression.significance;
    result.search = search_structure(data, search);
    if (!result.search->selected.empty()) data = select_columns(data, result.search->selected);
  }
  result.data = std::move(data);
  progress.stage("estimating");
  result.comparison = compare(result.data, options.regression);
  ParameterGroup group{.name = result.data.regressand_name};
  for (const RegressionEstimate& e : result.comparison.estimates)
    group.methods.push_back({std::string(to_string(e.method)), e.usable(), e.message, e.parameters});
  if (const RegressionEstimate* chosen = choose(result.comparison, options.method)) result.chosen = *chosen;

  group.evidence = {rows_row(result.data), incomplete_rows(result.data, result.dropped)};
  const RegressionEstimate* examined = result.chosen ? &*result.chosen : result.comparison.examined_estimate();
  if (examined != nullptr) group.evidence.push_back(collinearity(*examined));
  group.evidence.insert(group.evidence.end(), result.comparison.checks.begin(), result.comparison.checks.end());
  group.evidence.push_back(method_row(result.comparison, options.method, result.chosen.has_value()));
  if (result.chosen) {
    const auto halves = agreement_of_halves(result.data, result.chosen->method, options.regression);
    widen(*result.chosen, widening_of(halves), options.regression.significance);
    group.evidence.push_back(agreement_row(halves));
    const auto r2 = cross_validated_r2(result.data, result.chosen->method, options.regression);
    group.evidence.push_back(cross_validation_row(r2));
  }
  for (Evidence& row : group.evidence) row.about = group.name;
  group.judgement = judge(group.evidence);
  group.verdict = result.chosen ? verdict_of(group.judgement) : GroupVerdict::kRejected;
  result.estimate.subject = result.data.regressand_name;
  result.estimate.verdict = verdict_text(result, group);
  group.reason = result.estimate.verdict;
  if (result.chosen) {
    group.method = to_string(result.chosen->method);
    group.parameters = marked(result.chosen->parameters, group.verdict);
    result.predicted = result.data.regressors * result.chosen->theta;
    result.estimate.method = group.method;
    result.estimate.parameters = group.parameters;
    result.estimate.covariance = result.chosen->covariance;
    result.estimate.fit = {{"rows", static_cast<double>(result.data.rows())},
                           {"residual_sd", result.chosen->residual_sd},
                           {"r2", result.chosen->r_squared},
                           {"condition_number", result.chosen->condition_number},
                           {"degrees_of_freedom", result.chosen->degrees_of_freedom}};
    if (options.bootstrap > 0) {
      progress.stage("bootstrap");
      group.methods.push_back(by_bootstrap(result, options, progress));
    }
  }
  result.estimate.judgement = group.judgement;
  result.estimate.evidence = group.evidence;
  if (result.search) result.estimate.warnings.push_back("terms were chosen on the same rows: " + result.search->text);
  result.groups.push_back(std::move(group));
  result.interrupted = progress.interrupted();
  return result;
}

}  // namespace veridyn::estimation
