#include "veridyn/numerics/gaussian_copula.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"
#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"

namespace veridyn::numerics {
namespace {

constexpr int kRounds = 1000;
constexpr double kSettled = 1e-12;

Eigen::VectorXd mean_ranks(const Eigen::VectorXd& x) {
  const auto n = static_cast<std::size_t>(x.size());
  std::vector<Eigen::Index> order(n);
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) { return x(a) < x(b); });
  Eigen::VectorXd rank(x.size());
  for (std::size_t i = 0; i < n;) {
    std::size_t j = i;
    while (j + 1 < n && x(order[j + 1]) == x(order[i])) ++j;
    for (std::size_t k = i; k <= j; ++k) rank(order[k]) = 0.5 * static_cast<double>(i + j);
    i = j + 1;
  }
  return rank;
}

}  // namespace

double normal_correlation_for_uniform(double rho) { return 2.0 * std::sin(kPi * rho / 6.0); }

NearestCorrelation nearest_correlation(const Eigen::MatrixXd& symmetric, double floor) {
  VERIDYN_ASSERT(symmetric.rows() == symmetric.cols() && floor >= 0.0);
  NearestCorrelation result;
  result.matrix = symmetric;
  result.matrix.diagonal().setOnes();
  if (symmetric.rows() == 0) return result;
  const auto least = [](const Eigen::MatrixXd& m) { return symmetric_eigenvalues(m)(0); };
  if (least(result.matrix) >= floor) return result;
  result.converged = false;
  Eigen::MatrixXd correction = Eigen::MatrixXd::Zero(symmetric.rows(), symmetric.cols());
  for (int round = 0; round < kRounds && !result.converged; ++round) {
    const Eigen::MatrixXd shifted = result.matrix - correction;
    const SymmetricEigen eigen = symmetric_eigen(shifted);
    const Eigen::MatrixXd projected = from_eigen(eigen.vectors, eigen.values.cwiseMax(floor));
    correction = projected - shifted;
    Eigen::MatrixXd next = 0.5 * (projected + projected.transpose());
    next.diagonal().setOnes();
    result.converged = (next - result.matrix).cwiseAbs().maxCoeff() < kSettled;
    result.matrix = std::move(next);
  }
  // The last projection was onto the unit diagonal: what is left below the floor is lifted and scaled back.
  if (const double low = least(result.matrix); low < floor) {
    result.matrix.diagonal().array() += floor - low;
    const double scale = 1.0 / result.matrix(0, 0);
    result.matrix *= scale;
    result.matrix.diagonal().setOnes();
  }
  Eigen::MatrixXd given = symmetric;
  given.diagonal().setOnes();
  result.largest_change = (result.matrix - given).cwiseAbs().maxCoeff();
  return result;
}

GaussianCopula::GaussianCopula(const Eigen::MatrixXd& correlation) {
  VERIDYN_ASSERT(correlation.rows() == correlation.cols());
  VERIDYN_ASSERT(correlation.size() == 0 || correlation.cwiseAbs().maxCoeff() <= 1.0 + 1e-12);
  repair_ = nearest_correlation(correlation.unaryExpr([](double rho) { return normal_correlation_for_uniform(rho); }));
  const Cholesky cholesky(repair_.matrix);
  VERIDYN_ASSERT(repair_.matrix.size() == 0 || cholesky.positive_definite());
  factor_ = cholesky.L();
}

void GaussianCopula::couple(Eigen::Ref<Eigen::MatrixXd> normal) const {
  VERIDYN_ASSERT(normal.rows() == factor_.rows());
  normal = (factor_.triangularView<Eigen::Lower>() * normal).eval();
  normal = normal.unaryExpr([](double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); });
}

Eigen::MatrixXd rank_correlation(const Eigen::MatrixXd& samples) {
  const Eigen::Index n = samples.cols();
  Eigen::MatrixXd ranks(samples.rows(), n);
  for (Eigen::Index j = 0; j < n; ++j) {
    ranks.col(j) = mean_ranks(samples.col(j));
    ranks.col(j).array() -= ranks.col(j).mean();
    const double norm = ranks.col(j).norm();
    if (norm > 0.0) ranks.col(j) /= norm;
  }
  Eigen::MatrixXd rho = ranks.transpose() * ranks;
  rho = rho.cwiseMax(-1.0).cwiseMin(1.0).eval();
  rho.diagonal().setOnes();
  return rho;
}

}  // namespace veridyn::numerics
