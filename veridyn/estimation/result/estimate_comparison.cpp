#include "veridyn/estimation/result/estimate_comparison.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::estimation {
namespace {

bool comparable(const Parameter& p) {
  const bool stated = p.status != ParameterStatus::kRejected && p.status != ParameterStatus::kNotExcited &&
                      p.status != ParameterStatus::kFixed && p.status != ParameterStatus::kAtBound;
  return stated && std::isfinite(p.value) && std::isfinite(p.sigma) && p.sigma > 0.0;
}

const Parameter* comparable_in(const Estimate& estimate, const std::string& name) {
  const Parameter* p = estimate.find(name);
  return p != nullptr && comparable(*p) ? p : nullptr;
}

ComparedParameter compared(const std::string& name, std::span<const NamedEstimate> estimates) {
  ComparedParameter row{.name = name};
  double weights = 0.0, sum = 0.0, squares = 0.0, count = 0.0;
  for (const NamedEstimate& e : estimates) {
    const Parameter* p = comparable_in(e.estimate, name);
    row.by.push_back(p);
    if (p == nullptr) continue;
    if (row.unit.empty()) row.unit = p->unit;
    if (p->unit != row.unit)
      throw InputError(e.name,
                       fmt::format("has {} in {}, where another estimate has it in {}", name, p->unit, row.unit));
    const double w = 1.0 / (p->sigma * p->sigma);
    weights += w;
    squares += w * w;
    sum += w * p->value;
    count += 1.0;
  }
  if (count == 0.0) return row;
  row.mean = sum / weights;
  row.sigma = 1.0 / std::sqrt(weights);
  for (const Parameter* p : row.by)
    if (p != nullptr) row.q += std::pow((p->value - row.mean) / p->sigma, 2.0);
  const double freedom = count - 1.0;
  if (freedom < 1.0) return row;
  row.p = numerics::chi_square_upper_p(row.q, freedom);
  row.between_sigma = std::sqrt(std::max(0.0, (row.q - freedom) / (weights - squares / weights)));
  return row;
}

/// Covariance of some parameters; where a file has none, or one of another size, their variances.
Eigen::MatrixXd covariance_of(const Estimate& estimate, const std::vector<std::string>& names) {
  const auto n = signed_index(names.size());
  std::vector<Eigen::Index> index;
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(n, n);
  for (const std::string& name : names) index.push_back(estimate.find(name) - estimate.parameters.data());
  const bool whole = estimate.covariance.rows() == signed_index(estimate.parameters.size());
  for (Eigen::Index i = 0; i < n; ++i) {
    const double sigma = estimate.parameters[index[i]].sigma;
    for (Eigen::Index j = 0; j < n; ++j) {
      const double other = estimate.parameters[index[j]].sigma;
      const double vi = whole ? estimate.covariance(index[i], index[i]) : 0.0;
      const double vj = whole ? estimate.covariance(index[j], index[j]) : 0.0;
      const bool correlated = i != j && vi > 0.0 && vj > 0.0;
      // Intervals may have been widened beyond the covariance: correlations are its, sizes the intervals'.
      const double r = correlated ? estimate.covariance(index[i], index[j]) / std::sqrt(vi * vj) : 0.0;
      P(i, j) = i == j ? sigma * sigma : std::isfinite(r) ? r * sigma * other : 0.0;
    }
  }
  return P;
}

/// Of the variance that directions of parameters in units of their standard errors have: one that has less is a
/// function of others (an understeer gradient of stiffnesses), which is linear only so far, and no more information
/// than they are.
constexpr double kOwn = 1e-2;

/// d' P^-1 d over the directions in which P says something of its own.
struct ChiSquare {
  double value = 0.0;
  double freedom = 0.0;
};
ChiSquare chi_square_of(const Eigen::VectorXd& d, const Eigen::MatrixXd& P) {
  const Eigen::VectorXd scale = P.diagonal().cwiseSqrt().cwiseInverse();
  const numerics::SymmetricEigen eigen =
      numerics::symmetric_eigen(Eigen::MatrixXd(scale.asDiagonal() * P * scale.asDiagonal()));
  const Eigen::VectorXd along = eigen.vectors.transpose() * (scale.asDiagonal() * d);
  ChiSquare chi;
  for (Eigen::Index i = 0; i < along.size(); ++i) {
    if (!(eigen.values(i) > kOwn)) continue;
    chi.value += along(i) * along(i) / eigen.values(i);
    chi.freedom += 1.0;
  }
  return chi;
}

ComparedPair compared(std::span<const NamedEstimate> estimates, std::size_t first, std::size_t second) {
  ComparedPair pair{.first = first, .second = second};
  const Estimate &a = estimates[first].estimate, &b = estimates[second].estimate;
  std::vector<std::string> names;
  for (const Parameter& p : a.parameters)
    if (comparable(p) && comparable_in(b, p.name) != nullptr) names.push_back(p.name);
  pair.parameters = names.size();
  if (names.empty()) return pair;
  Eigen::VectorXd d(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Parameter &pa = *a.find(names[i]), &pb = *b.find(names[i]);
    d(i) = pa.value - pb.value;
    const double sigmas = std::abs(pa.value - pb.value) / std::hypot(pa.sigma, pb.sigma);
    if (!(sigmas > pair.largest_sigmas)) continue;
    pair.largest_sigmas = sigmas;
    pair.largest = names[i];
  }
  const ChiSquare chi = chi_square_of(d, covariance_of(a, names) + covariance_of(b, names));
  pair.chi_square = chi.value;
  if (chi.freedom > 0.0) pair.p = numerics::chi_square_upper_p(chi.value, chi.freedom);
  return pair;
}

Evidence pair_row(const ComparedPair& pair, std::span<const NamedEstimate> estimates) {
  return row_of(Check::kEstimatesAgree,
                fmt::format("{} and {}", estimates[pair.first].name, estimates[pair.second].name), pair.p)
      .with("parameters", static_cast<double>(pair.parameters))
      .with("chi_square", pair.chi_square)
      .with("largest", pair.largest)
      .with("largest_sigmas", pair.largest_sigmas);
}

}  // namespace

EstimateComparison compare_estimates(std::span<const NamedEstimate> estimates) {
  if (estimates.size() < 2) throw InputError("compare", "needs at least two estimates");
  EstimateComparison result;
  std::vector<std::string> seen;
  for (const NamedEstimate& e : estimates) {
    for (const Parameter& p : e.estimate.parameters) {
      if (std::ranges::find(seen, p.name) != seen.end()) continue;
      seen.push_back(p.name);
      ComparedParameter row = compared(p.name, estimates);
      const auto having = row.by.size() - static_cast<std::size_t>(std::ranges::count(row.by, nullptr));
      if (having >= 2)
        result.parameters.push_back(std::move(row));
      else
        result.notes.push_back(
            fmt::format("{}: {} estimate has it with an interval", p.name, having == 0 ? "no" : "one"));
    }
  }
  if (result.parameters.empty())
    throw InputError(estimates.front().name, "shares no parameter with an interval with any other of the estimates");
  for (std::size_t i = 0; i < estimates.size(); ++i)
    for (std::size_t j = i + 1; j < estimates.size(); ++j)
      if (const ComparedPair pair = compared(estimates, i, j); pair.parameters > 0) result.pairs.push_back(pair);
  std::size_t agreeing = 0;
  for (const ComparedPair& pair : result.pairs) {
    result.evidence.push_back(pair_row(pair, estimates));
    agreeing += result.evidence.back().passed() ? 1U : 0U;
  }
  std::vector<std::string> scattering;
  for (const ComparedParameter& p : result.parameters) {
    Evidence row = row_of(Check::kOneValue, p.name, p.p).with("between", p.between_sigma);
    if (row.passed()) continue;
    result.evidence.push_back(std::move(row));
    scattering.push_back(p.name);
  }
  result.text =
      fmt::format("{} of {} pairs of estimates agree in what they share{}", agreeing, result.pairs.size(),
                  scattering.empty() ? "" : fmt::format("; not of one value: {}", fmt::join(scattering, ", ")));
  return result;
}

}  // namespace veridyn::estimation
