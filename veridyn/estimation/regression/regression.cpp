#include "veridyn/estimation/regression/regression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/regression/regression_analysis.hpp"

namespace veridyn::estimation {

std::string_view to_string(Method method) {
  switch (method) {
    case Method::kOls:
      return "OLS";
    case Method::kTls:
      return "TLS";
    case Method::kGtls:
      return "GTLS";
    case Method::kPcaGtls:
      return "PCA-GTLS";
  }
  return "";
}

std::string_view to_string(EstimateTermination termination) {
  switch (termination) {
    case EstimateTermination::kEstimated:
      return "estimated";
    case EstimateTermination::kRankDeficient:
      return "rank deficient";
    case EstimateTermination::kNongeneric:
      return "nongeneric";
    case EstimateTermination::kTooFewRows:
      return "too few rows";
  }
  return "";
}

void RegressionOptions::validate(Eigen::Index parameters) const {
  if (!(significance > 0.0 && significance < 1.0)) {
    throw InputError("regression.significance", fmt::format("is {}; must be in (0, 1)", significance));
  }
  if (!(signal_to_noise >= 1.0 && signal_to_noise <= 10.0)) {
    throw InputError("regression.signal_to_noise", fmt::format("is {}; must be in [1, 10]", signal_to_noise));
  }
  if (!(unexcited_bound >= 0.0) || !std::isfinite(unexcited_bound)) {
    throw InputError("regression.unexcited_bound", fmt::format("is {}; must be >= 0 and finite", unexcited_bound));
  }
  if (max_lag < 0) throw InputError("regression.max_lag", fmt::format("is {}; must be >= 0", max_lag));
  if (prior.size() > 0 && (prior.size() != parameters || !prior.allFinite())) {
    throw InputError("regression.prior", fmt::format("has {} values for {} parameters; must have one finite value each",
                                                     prior.size(), parameters));
  }
  if (prior_weight.size() == 0) return;
  if (prior_weight.size() != parameters) {
    throw InputError("regression.prior_weight",
                     fmt::format("has {} values for {} parameters", prior_weight.size(), parameters));
  }
  if (!(prior_weight.array() > 0.0).all()) throw InputError("regression.prior_weight", "has a value that is not > 0");
  if (!(prior_weight.array() < kInfinity).any()) {
    throw InputError("regression.prior_weight", "pins every parameter; at least one must be finite");
  }
}

const Parameter* RegressionEstimate::find(std::string_view name) const { return find_parameter(parameters, name); }

const RegressionEstimate* RegressionComparison::find(Method method) const {
  const auto found =
      std::find_if(estimates.begin(), estimates.end(), [&](const RegressionEstimate& e) { return e.method == method; });
  return found == estimates.end() ? nullptr : &*found;
}

RegressionEstimate estimate(const RegressionData& data, Method method, const RegressionOptions& options) {
  const internal::RegressionAnalysis analysis(data, options);
  return analysis.run(method);
}

void widen(RegressionEstimate& estimate, double variance_factor, double significance) {
  if (!(variance_factor > 1.0)) return;
  estimate.covariance *= variance_factor;
  for (Parameter& p : estimate.parameters) widen(p, variance_factor, estimate.degrees_of_freedom, significance);
}

std::string describe_combination(const Eigen::VectorXd& combination, const std::vector<std::string>& names) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(combination.size()));
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<Eigen::Index>(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return std::abs(combination(a)) > std::abs(combination(b)); });
  const double largest = std::abs(combination(order.front()));
  const double sign =
      combination(order.front()) < 0.0 ? -1.0 : 1.0;  // a direction has no sign: lead with a positive term
  std::string text;
  for (const Eigen::Index i : order) {
    const double value = sign * combination(i);
    if (std::abs(value) < 0.05 * largest) break;
    const std::string& name = names[i];
    if (text.empty()) {
      text = std::abs(value) > 0.9995 ? name : fmt::format("{:.2f} {}", value, name);
    } else {
      text += fmt::format(" {} {:.2f} {}", value < 0.0 ? "-" : "+", std::abs(value), name);
    }
  }
  return text;
}

}  // namespace veridyn::estimation
