#include "veridyn/estimation/regression/group_scatter.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/numerics/linear_algebra/cholesky.hpp"

namespace veridyn::estimation {
namespace {

/// A group that determines all parameters.
struct ComparedGroup {
  const RegressionEstimate* estimate;
  Eigen::MatrixXd information;  ///< P^-1
};

std::vector<ComparedGroup> compared_groups(std::span<const RegressionEstimate> groups) {
  std::vector<ComparedGroup> compared;
  for (const RegressionEstimate& e : groups) {
    if (!e.usable() || !e.unexcited.empty() || !e.covariance.allFinite()) continue;
    // In units of the standard errors: parameters differ by orders of magnitude.
    const Eigen::VectorXd inverse = e.covariance.diagonal().cwiseSqrt().cwiseInverse();
    if (!inverse.allFinite()) continue;
    const numerics::Cholesky factor(inverse.asDiagonal() * e.covariance * inverse.asDiagonal());
    if (!factor.positive_definite()) continue;
    const Eigen::Index n = e.covariance.rows();
    const Eigen::MatrixXd unit = factor.solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n)));
    compared.push_back({&e, inverse.asDiagonal() * unit * inverse.asDiagonal()});
  }
  return compared;
}

/// Cochran's Q of all parameters together.
double cochrans_q(std::span<const ComparedGroup> groups) {
  const Eigen::Index n = groups.front().estimate->theta.size();
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(n);
  for (const ComparedGroup& g : groups) {
    weights += g.information;
    sum += g.information * g.estimate->theta;
  }
  const Eigen::VectorXd mean = numerics::solve_symmetric(weights, sum);
  double q = 0.0;
  for (const ComparedGroup& g : groups) {
    const Eigen::VectorXd d = g.estimate->theta - mean;
    q += d.dot(g.information * d);
  }
  return std::max(0.0, q);
}

/// Mean of one parameter, its standard error and the scatter; see GroupScatter.
struct ParameterMean {
  double mean = 0.0, sigma = 0.0, between_sigma = 0.0;
};

ParameterMean mean_of(std::span<const ComparedGroup> groups, Eigen::Index parameter) {
  const auto value = [&](const ComparedGroup& g) { return g.estimate->theta(parameter); };
  const auto variance = [&](const ComparedGroup& g) { return g.estimate->covariance(parameter, parameter); };
  const double freedom = static_cast<double>(groups.size()) - 1.0;
  const auto weighted = [&](double between) {
    double weights = 0.0, squares = 0.0, sum = 0.0, q = 0.0;
    for (const ComparedGroup& g : groups) {
      const double w = 1.0 / (variance(g) + between);
      weights += w;
      squares += w * w;
      sum += w * value(g);
    }
    const double mean = sum / weights;
    for (const ComparedGroup& g : groups) q += std::pow(value(g) - mean, 2.0) / (variance(g) + between);
    return std::array{mean, q, weights, squares};
  };
  const auto [fixed, q, weights, squares] = weighted(0.0);
  const double between = std::max(0.0, (q - freedom) / (weights - squares / weights));
  const auto [mean, q_mean, all, unused] = weighted(between);
  static_cast<void>(fixed);
  static_cast<void>(unused);
  return {mean, std::sqrt(q_mean / (freedom * all)), std::sqrt(between)};
}

}  // namespace

GroupScatter group_scatter(std::span<const RegressionEstimate> groups) {
  GroupScatter scatter;
  scatter.groups = groups.size();
  const std::vector<ComparedGroup> compared = compared_groups(groups);
  scatter.compared = compared.size();
  if (compared.size() < 2) return scatter;
  const Eigen::Index n = compared.front().estimate->theta.size();
  scatter.q = cochrans_q(compared);
  scatter.freedom = scatter.degrees_of_freedom() * static_cast<double>(n);
  scatter.p = numerics::chi_square_upper_p(scatter.q, scatter.freedom);
  scatter.mean.resize(n);
  scatter.sigma.resize(n);
  scatter.between_sigma.resize(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const ParameterMean of_j = mean_of(compared, j);
    scatter.mean(j) = of_j.mean;
    scatter.sigma(j) = of_j.sigma;
    scatter.between_sigma(j) = of_j.between_sigma;
  }
  return scatter;
}

void take_mean(RegressionEstimate& estimate, const GroupScatter& scatter, double significance) {
  estimate.theta = scatter.mean;
  estimate.unexcited.clear();
  estimate.degrees_of_freedom = scatter.degrees_of_freedom();
  const Eigen::VectorXd scale =
      scatter.sigma.cwiseQuotient(estimate.covariance.diagonal().cwiseSqrt().cwiseMax(1e-300));
  estimate.covariance = scale.asDiagonal() * estimate.covariance * scale.asDiagonal();
  for (Eigen::Index j = 0; j < scatter.mean.size(); ++j) {
    Parameter& p = estimate.parameters[j];
    p.value = scatter.mean(j);
    p.sigma = scatter.sigma(j);
    set_interval(p, estimate.degrees_of_freedom);
    p.status = p.p_value < significance ? ParameterStatus::kIdentified : ParameterStatus::kInsignificant;
  }
}

}  // namespace veridyn::estimation
