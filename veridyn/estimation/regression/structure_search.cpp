#include "veridyn/estimation/regression/structure_search.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/option_check.hpp"
#include "veridyn/estimation/regression/augmented_qr.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/numerics/linear_algebra/products.hpp"

namespace veridyn::estimation {
namespace {

using Eigen::Index;

/// A column whose part outside the model is smaller than this share of it cannot enter.
constexpr double kDependent = 1e-9;

/// View of data and options that walks through the structures they allow.
class Search {
 public:
  Search(const RegressionData& data, const StructureOptions& options) : options_(options), data_(data) {
    X_ = data.regressors;
    z_ = data.regressand;
    if (data.row_scale.size() > 0) {
      X_ = data.row_scale.cwiseInverse().asDiagonal() * data.regressors;
      z_ = data.regressand.cwiseQuotient(data.row_scale);
    }
    triangle_ = triangle_of(data);
    N_ = static_cast<double>(data.rows());
    total_ = (z_.array() - z_.mean()).square().sum();
    for (Index j = 0; j < data.parameters(); ++j) {
      const bool constant = (data.regressors.col(j).array() == data.regressors(0, j)).all();
      const auto& always = options.always;
      if (constant || std::find(always.begin(), always.end(), j) != always.end()) always_.push_back(j);
    }
  }

  StructureSearch run() {
    result_.method = options_.method;
    model_ = always_;
    if (options_.method == StructureMethod::kOrthogonal && options_.autocorrelation_penalty)
      result_.penalty = autocorrelation_penalty();
    result_.history.push_back(describe(StructureAction::kStart, -1, 0.0, model_));
    result_.history.back().r2_change = result_.history.back().r2;
    if (options_.method == StructureMethod::kStepwise)
      stepwise();
    else
      orthogonal();
    std::sort(model_.begin(), model_.end());
    result_.selected = model_;
    finish();
    return std::move(result_);
  }

 private:
  /// Residual sum of squares of the columns; infinite when they are dependent.
  [[nodiscard]] double rss(const std::vector<Index>& columns) const {
    const auto k = static_cast<Index>(columns.size());
    const Index n = triangle_.cols() - 1;
    if (k == 0) return triangle_.col(n).squaredNorm();
    Eigen::MatrixXd part(triangle_.rows(), k);
    for (Index j = 0; j < k; ++j) part.col(j) = triangle_.col(columns[j]);
    const numerics::HouseholderQr qr(part);
    for (Index j = 0; j < k; ++j) {
      if (!(std::abs(qr.R()(j, j)) > kDependent * part.col(j).norm())) return kInfinity;
    }
    const Eigen::VectorXd rest = qr.apply_transposed(Eigen::VectorXd(triangle_.col(n)));
    return rest.tail(rest.size() - k).squaredNorm();
  }

  [[nodiscard]] double press(const std::vector<Index>& columns) const {
    const auto k = static_cast<Index>(columns.size());
    if (k == 0) return z_.squaredNorm();
    Eigen::MatrixXd part(triangle_.rows(), k);
    RowMatrix X(X_.rows(), k);
    for (Index j = 0; j < k; ++j) {
      part.col(j) = triangle_.col(columns[j]);
      X.col(j) = X_.col(columns[j]);
    }
    const numerics::HouseholderQr qr(part);
    const Eigen::VectorXd theta = qr.solve(Eigen::VectorXd(triangle_.col(triangle_.cols() - 1)));
    // Leverage x_k' (X'X)^-1 x_k = |R^-T x_k|^2.
    const Eigen::MatrixXd inverse = numerics::solve_upper(qr.R(), Eigen::MatrixXd(Eigen::MatrixXd::Identity(k, k)));
    const Eigen::VectorXd leverage = (X * inverse).rowwise().squaredNorm();
    const Eigen::VectorXd residual = z_ - X * theta;
    double sum = 0.0;
    for (Index i = 0; i < residual.size(); ++i) {
      const double e = residual(i) / std::max(1e-12, 1.0 - leverage(i));
      sum += e * e;
    }
    return sum;
  }

  StructureStep describe(StructureAction action, Index term, double F, const std::vector<Index>& columns) const {
    StructureStep step;
    step.action = action;
    if (term >= 0) step.term = data_.parameter_names[term];
    step.terms = static_cast<Index>(columns.size());
    step.F = F;
    const double squares = rss(columns), k = static_cast<double>(step.terms);
    step.residual_sd = std::sqrt(squares / std::max(1.0, N_ - k));
    step.r2 = total_ > 0.0 ? 1.0 - squares / total_ : 0.0;
    step.press = press(columns);
    step.pse = squares / N_ + result_.penalty * total_ / N_ * k / N_;
    return step;
  }

  static std::vector<Index> with(std::vector<Index> columns, Index added) {
    columns.push_back(added);
    return columns;
  }
  static std::vector<Index> without(std::vector<Index> columns, Index removed) {
    std::erase(columns, removed);
    return columns;
  }
  [[nodiscard]] bool in_model(Index j) const { return std::find(model_.begin(), model_.end(), j) != model_.end(); }

  [[nodiscard]] double partial_F(double without_it, double with_it, std::size_t terms_with_it) const {
    const double freedom = std::max(1.0, N_ - static_cast<double>(terms_with_it));
    return with_it > 0.0 ? (without_it - with_it) / (with_it / freedom) : kInfinity;
  }

  /// The column that lowers the residual sum of squares most, or -1.
  [[nodiscard]] Index best_candidate(double& squares) const {
    Index best = -1;
    squares = kInfinity;
    for (Index j = 0; j < data_.parameters(); ++j) {
      if (in_model(j) || static_cast<double>(model_.size()) + 2.0 > N_) continue;
      const double candidate = rss(with(model_, j));
      if (candidate < squares) squares = candidate, best = j;
    }
    return best;
  }

  /// Median over the parameters of the full model of their variance with autocorrelated over that with white residuals.
  [[nodiscard]] double autocorrelation_penalty() const {
    std::vector<Index> all;
    for (Index j = 0; j < data_.parameters(); ++j) {
      if (static_cast<double>(all.size()) + 2.0 <= N_ && std::isfinite(rss(with(all, j)))) all.push_back(j);
    }
    if (all.empty()) return 1.0;
    const RegressionEstimate full = estimate(select_columns(data_, all), Method::kOls);
    if (!full.usable()) return 1.0;
    std::vector<double> ratio;
    for (const Parameter& p : full.parameters)
      if (p.sigma_white > 0.0) ratio.push_back(p.sigma * p.sigma / (p.sigma_white * p.sigma_white));
    return ratio.empty() ? 1.0 : std::max(1.0, numerics::median(ratio));
  }

  void stepwise() {
    // Each cycle enters one term; more cycles than this would be going in circles.
    for (Index cycle = 0; cycle < 4 * data_.parameters(); ++cycle) {
      double squares = 0.0;
      const Index term = best_candidate(squares);
      if (term < 0) return;
      StructureStep step = describe(StructureAction::kEnter, term, partial_F(rss(model_), squares, model_.size() + 1),
                                    with(model_, term));
      const double r2_before = r2_now(), press_before = press(model_);
      step.r2_change = step.r2 - r2_before;
      if (!(step.F >= options_.f_enter)) {
        step.reason = fmt::format("F = {:.3g} < {:.3g}", step.F, options_.f_enter);
      } else if (!(step.r2_change >= options_.min_r2_change)) {
        step.reason = fmt::format("explains {:.2g} % of the variance, less than {:.2g} %", 100.0 * step.r2_change,
                                  100.0 * options_.min_r2_change);
      } else if (options_.stop_at_least_press && !(step.press < press_before)) {
        step.reason = "raises the prediction error (PRESS)";
      }
      if (!step.reason.empty()) {
        step.action = StructureAction::kRefuse;
        step.in_model = false;
        result_.history.push_back(std::move(step));
        return;
      }
      model_.push_back(term);
      result_.history.push_back(std::move(step));
      remove_weak(term);
    }
  }

  [[nodiscard]] double r2_now() const { return total_ > 0.0 ? 1.0 - rss(model_) / total_ : 0.0; }

  void remove_weak(Index entered) {
    while (true) {
      Index weakest = -1;
      double least = options_.f_remove;
      const double now = rss(model_);
      for (const Index j : model_) {
        if (j == entered || std::find(always_.begin(), always_.end(), j) != always_.end()) continue;
        const double F = partial_F(rss(without(model_, j)), now, model_.size());
        if (F < least) least = F, weakest = j;
      }
      if (weakest < 0) return;
      const double r2 = r2_now();
      model_ = without(model_, weakest);
      StructureStep step = describe(StructureAction::kRemove, weakest, least, model_);
      step.r2_change = step.r2 - r2;
      step.reason = fmt::format("F fell to {:.3g} < {:.3g}", least, options_.f_remove);
      result_.history.push_back(std::move(step));
    }
  }

  void orthogonal() {
    std::vector<Index> best_model = model_;
    std::size_t best_step = 0;
    double least = result_.history.front().pse;
    while (true) {
      double squares = 0.0;
      const Index term = best_candidate(squares);
      if (term < 0) break;
      const double F = partial_F(rss(model_), squares, model_.size() + 1), r2 = r2_now();
      model_.push_back(term);
      StructureStep step = describe(StructureAction::kEnter, term, F, model_);
      step.r2_change = step.r2 - r2;
      result_.history.push_back(std::move(step));
      if (result_.history.back().pse < least) {
        least = result_.history.back().pse;
        best_model = model_;
        best_step = result_.history.size() - 1;
      }
    }
    for (std::size_t i = best_step + 1; i < result_.history.size(); ++i) {
      result_.history[i].action = StructureAction::kRefuse;
      result_.history[i].in_model = false;
      result_.history[i].reason = "does not lower the predicted squared error";
    }
    model_ = best_model;
    drop_small_terms();
  }

  void drop_small_terms() {
    while (model_.size() > always_.size()) {
      const RegressionData part = select_columns(data_, model_);
      const Eigen::VectorXd theta = numerics::least_squares(part.regressors, part.regressand);
      const double rms = (part.regressors * theta).norm();
      Index weakest = -1;
      double least = options_.least_contribution * rms;
      for (std::size_t i = 0; i < model_.size(); ++i) {
        if (std::find(always_.begin(), always_.end(), model_[i]) != always_.end()) continue;
        const double contribution = std::abs(theta(i)) * part.regressors.col(i).norm();
        if (contribution < least) least = contribution, weakest = model_[i];
      }
      if (weakest < 0) return;
      const double r2 = r2_now();
      const double F = partial_F(rss(without(model_, weakest)), rss(model_), model_.size());
      model_ = without(model_, weakest);
      StructureStep step = describe(StructureAction::kRemove, weakest, F, model_);
      step.r2_change = step.r2 - r2;
      step.reason = fmt::format("contributes {:.2g} % of the model's RMS", 100.0 * least / rms);
      result_.history.push_back(std::move(step));
    }
  }

  void finish() {
    std::vector<std::string> names;
    for (const Index j : model_) names.push_back(data_.parameter_names[j]);
    const char* how = options_.method == StructureMethod::kStepwise
                          ? "stepwise regression"
                          : "orthogonal functions with least predicted squared error";
    if (model_.empty()) {
      result_.text = fmt::format("{} keeps none of {} candidate terms", how, data_.parameters());
      return;
    }
    RegressionOptions options;
    options.significance = options_.significance;
    result_.estimate = estimate(select_columns(data_, model_), Method::kOls, options);
    result_.text = fmt::format("{} keeps {} of {} candidate terms ({}), which explain {:.1f} % of the variance", how,
                               model_.size(), data_.parameters(), fmt::join(names, ", "), 100.0 * r2_now());
  }

  const StructureOptions& options_;
  const RegressionData& data_;
  RowMatrix X_;
  Eigen::VectorXd z_;
  Eigen::MatrixXd triangle_;
  double N_ = 0.0;
  double total_ = 0.0;  // sum of squares of z about its mean
  std::vector<Index> always_, model_;
  StructureSearch result_;
};

}  // namespace

std::string_view to_string(StructureAction action) {
  switch (action) {
    case StructureAction::kStart:
      return "start";
    case StructureAction::kEnter:
      return "enter";
    case StructureAction::kRemove:
      return "remove";
    case StructureAction::kRefuse:
      return "refuse";
  }
  return "";
}

void StructureOptions::validate(Index parameters) const {
  const OptionCheck require("structure_search");
  require(f_enter > 0.0, "f_enter", f_enter, "> 0");
  require(f_remove >= 0.0 && f_remove <= f_enter, "f_remove", f_remove, fmt::format("from 0 to f_enter = {}", f_enter));
  require(min_r2_change >= 0.0 && min_r2_change < 1.0, "min_r2_change", min_r2_change, "in [0, 1)");
  require(least_contribution >= 0.0 && least_contribution < 1.0, "least_contribution", least_contribution, "in [0, 1)");
  require(significance > 0.0 && significance < 1.0, "significance", significance, "in (0, 1)");
  for (const Index j : always)
    require(j >= 0 && j < parameters, "always", static_cast<double>(j),
            fmt::format("a column, 0 to {}", parameters - 1));
}

StructureSearch search_structure(const RegressionData& data, const StructureOptions& options) {
  data.validate();
  options.validate(data.parameters());
  return Search(data, options).run();
}

RegressionData select_columns(const RegressionData& data, const std::vector<Index>& columns) {
  RegressionData part;
  const auto k = static_cast<Index>(columns.size());
  part.regressors.resize(data.rows(), k);
  std::vector<Index> kept = columns;
  kept.push_back(data.parameters());
  for (Index j = 0; j < k; ++j) {
    const Index from = columns[j];
    part.regressors.col(j) = data.regressors.col(from);
    part.parameter_names.push_back(data.parameter_names[from]);
    if (!data.parameter_units.empty()) part.parameter_units.push_back(data.parameter_units[from]);
  }
  part.regressand = data.regressand;
  part.regressand_name = data.regressand_name;
  part.segment = data.segment;
  if (data.has_error_covariance()) part.error_covariance = data.error_covariance(kept, kept);
  part.error_scale_known = data.error_scale_known;
  part.regressand_error_known = data.regressand_error_known;
  part.row_scale = data.row_scale;
  return part;
}

}  // namespace veridyn::estimation
