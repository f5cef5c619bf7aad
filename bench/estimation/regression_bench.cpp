// Batch regression of 500 000 x 7 (constant included) from one triangle, against Eigen's own least squares and SVD of
// the same matrix.
#include <benchmark/benchmark.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <random>

#include "veridyn/estimation/regression/augmented_qr.hpp"
#include "veridyn/estimation/regression/ordinary_least_squares.hpp"
#include "veridyn/estimation/regression/pca_total_least_squares.hpp"
#include "veridyn/estimation/regression/regression.hpp"

namespace {
using namespace veridyn::estimation;

const RegressionData& data() {
  static const RegressionData kData = [] {
    constexpr Eigen::Index kRows = 500000, kColumns = 7;
    std::mt19937_64 generator(1);
    std::normal_distribution<double> normal;
    RegressionData d;
    d.regressors = RowMatrix::NullaryExpr(kRows, kColumns, [&]() { return normal(generator); });
    d.regressors.col(0).setOnes();
    d.regressand = d.regressors * Eigen::VectorXd::LinSpaced(kColumns, -1.0, 1.0);
    d.regressors.rightCols(kColumns - 1) +=
        0.1 * RowMatrix::NullaryExpr(kRows, kColumns - 1, [&]() { return normal(generator); });
    d.regressand += 0.1 * Eigen::VectorXd::NullaryExpr(kRows, [&]() { return normal(generator); });
    d.error_covariance = 0.01 * Eigen::MatrixXd::Identity(kColumns + 1, kColumns + 1);
    d.error_covariance(0, 0) = 0.0;
    for (Eigen::Index i = 0; i < kColumns; ++i) d.parameter_names.push_back("p" + std::to_string(i));
    return d;
  }();
  return kData;
}

// OLS, GTLS and PCA-GTLS with white covariances: one read of the data.
void one_pass_ols_gtls_pca(benchmark::State& state) {
  const RegressionData& d = data();
  const auto rows = static_cast<double>(d.rows());
  const Eigen::VectorXd prior = Eigen::VectorXd::Zero(7), weight = Eigen::VectorXd::Ones(7);
  for (auto _ : state) {
    const Eigen::MatrixXd R = triangle_of(d);
    benchmark::DoNotOptimize(ordinary_least_squares(R).theta.data());
    benchmark::DoNotOptimize(total_least_squares(R, d.error_covariance, rows).theta.data());
    benchmark::DoNotOptimize(
        pca_total_least_squares(R, d.error_covariance, rows, 1.0, true, prior, weight).theta.data());
  }
}
BENCHMARK(one_pass_ols_gtls_pca)->Unit(benchmark::kMillisecond);

// What a user calls: four methods with covariances of autocorrelated residuals, residual analysis and checks.
void compare_everything(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(compare(data()).recommends);
}
BENCHMARK(compare_everything)->Unit(benchmark::kMillisecond);

void eigen_least_squares(benchmark::State& state) {
  const Eigen::MatrixXd X = data().regressors;
  for (auto _ : state) {
    const Eigen::VectorXd theta = X.colPivHouseholderQr().solve(data().regressand);
    benchmark::DoNotOptimize(theta.data());
  }
}
BENCHMARK(eigen_least_squares)->Unit(benchmark::kMillisecond);

void eigen_total_least_squares_bdcsvd(benchmark::State& state) {
  Eigen::MatrixXd D(data().rows(), 8);
  D << data().regressors, data().regressand;
  for (auto _ : state) {
    const Eigen::BDCSVD<Eigen::MatrixXd> svd(D, Eigen::ComputeThinV);
    benchmark::DoNotOptimize(svd.matrixV().data());
  }
}
BENCHMARK(eigen_total_least_squares_bdcsvd)->Unit(benchmark::kMillisecond);

void eigen_total_least_squares_jacobi(benchmark::State& state) {
  Eigen::MatrixXd D(data().rows(), 8);
  D << data().regressors, data().regressand;
  for (auto _ : state) {
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(D, Eigen::ComputeThinV);
    benchmark::DoNotOptimize(svd.matrixV().data());
  }
}
BENCHMARK(eigen_total_least_squares_jacobi)->Unit(benchmark::kMillisecond);

}  // namespace
