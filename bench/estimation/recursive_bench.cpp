// One row into six regressions at once (the coefficients of an aircraft), against singular value decompositions by
// Eigen of the accumulated matrix and of the update matrix. bench/estimation/recursive_svd.m is the same in GNU Octave.
#include <benchmark/benchmark.h>

#include <Eigen/SVD>
#include <array>
#include <random>
#include <vector>

#include "veridyn/estimation/recursive/recursive_regression.hpp"

namespace {
using namespace veridyn::estimation;

constexpr Eigen::Index kRows = 20000;

// Regressors that swing slowly (as a flight's do), a constant first; errors of a tenth.
struct Stream {
  explicit Stream(Eigen::Index n) : rows(kRows, n), z(kRows) {
    std::mt19937_64 generator(static_cast<unsigned>(n));
    std::normal_distribution<double> normal;
    Eigen::VectorXd state = Eigen::VectorXd::Zero(n);
    const Eigen::VectorXd theta = Eigen::VectorXd::LinSpaced(n, -1.0, 1.0);
    for (Eigen::Index k = 0; k < kRows; ++k) {
      for (Eigen::Index j = 1; j < n; ++j)
        state(j) = 0.98 * state(j) + 0.2 * normal(generator) + (j > 1 ? 0.1 * state(j - 1) : 0.0);
      state(0) = 1.0;
      z(k) = state.dot(theta) + 0.1 * normal(generator);
      for (Eigen::Index j = 0; j < n; ++j) rows(k, j) = state(j) + (j > 0 ? 0.1 * normal(generator) : 0.0);
    }
  }
  RowMatrix rows;
  Eigen::VectorXd z;
};

RecursiveRegression make(Eigen::Index n, Method method, bool variable) {
  RecursiveOptions options{.method = method};
  options.forgetting.variable = variable;
  options.error_covariance = 0.01 * Eigen::MatrixXd::Identity(n + 1, n + 1);
  options.error_covariance(0, 0) = 0.0;
  std::vector<std::string> names;
  for (Eigen::Index j = 0; j < n; ++j) names.push_back("p" + std::to_string(j));
  return {names, options};
}

void run_six(benchmark::State& state, Method method, const std::array<Eigen::Index, 6>& parameters, bool error_bars) {
  std::vector<Stream> streams;
  std::vector<RecursiveRegression> six;
  for (const Eigen::Index n : parameters) {
    streams.emplace_back(n);
    six.push_back(make(n, method, true));
  }
  Eigen::Index k = 0;
  const auto step = [&] {
    for (std::size_t c = 0; c < 6; ++c) {
      const auto n = static_cast<std::size_t>(parameters[c]);
      six[c].update(std::span(streams[c].rows.row(k).data(), n), streams[c].z(k));
      benchmark::DoNotOptimize(six[c].theta().data());
      if (error_bars) benchmark::DoNotOptimize(six[c].sigma().data());
    }
    k = (k + 1) % kRows;
  };
  for (int i = 0; i < 10000; ++i) step();
  for (auto _ : state) step();
}

// CL, CD, CY, Cl, Cm, Cn with the terms of the default model; then the most of the range.
constexpr std::array<Eigen::Index, 6> kUsual{4, 5, 6, 6, 4, 6};
constexpr std::array<Eigen::Index, 6> kLargest{7, 7, 7, 7, 7, 7};

void six_coefficients(benchmark::State& state, Method method, std::array<Eigen::Index, 6> parameters, bool bars) {
  run_six(state, method, parameters, bars);
}
BENCHMARK_CAPTURE(six_coefficients, pca_gtls_4_to_6, Method::kPcaGtls, kUsual, false);
BENCHMARK_CAPTURE(six_coefficients, pca_gtls_4_to_6_with_error_bars, Method::kPcaGtls, kUsual, true);
BENCHMARK_CAPTURE(six_coefficients, gtls_4_to_6, Method::kGtls, kUsual, false);
BENCHMARK_CAPTURE(six_coefficients, gtls_4_to_6_with_error_bars, Method::kGtls, kUsual, true);
BENCHMARK_CAPTURE(six_coefficients, ols_4_to_6, Method::kOls, kUsual, false);
BENCHMARK_CAPTURE(six_coefficients, ols_4_to_6_with_error_bars, Method::kOls, kUsual, true);
BENCHMARK_CAPTURE(six_coefficients, pca_gtls_all_7, Method::kPcaGtls, kLargest, false);
BENCHMARK_CAPTURE(six_coefficients, pca_gtls_all_7_with_error_bars, Method::kPcaGtls, kLargest, true);

// One coefficient of n parameters.
void one_coefficient(benchmark::State& state) {
  const Eigen::Index n = state.range(0);
  const Stream stream(n);
  RecursiveRegression recursive = make(n, Method::kPcaGtls, true);
  Eigen::Index k = 0;
  for (auto _ : state) {
    recursive.update(std::span(stream.rows.row(k).data(), static_cast<std::size_t>(n)), stream.z(k));
    benchmark::DoNotOptimize(recursive.theta().data());
    k = (k + 1) % kRows;
  }
}
BENCHMARK(one_coefficient)->DenseRange(4, 8);

// What it replaces: thin SVD of [sqrt(lambda) S; d V], (n + 2) x (n + 1), and V <- V V'.
void eigen_svd_of_the_update(benchmark::State& state) {
  const Eigen::Index n = state.range(0);
  const Stream stream(n);
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n + 2, n + 1), V = Eigen::MatrixXd::Identity(n + 1, n + 1);
  Eigen::VectorXd S = Eigen::VectorXd::Zero(n + 1);
  Eigen::RowVectorXd d(n + 1);
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(n + 2, n + 1, Eigen::ComputeThinV);
  Eigen::Index k = 0;
  for (auto _ : state) {
    d << stream.rows.row(k), stream.z(k);
    M.topRows(n + 1) = (std::sqrt(0.9997) * S).asDiagonal();
    M.row(n + 1) = d * V;
    svd.compute(M);
    S = svd.singularValues();
    V = (V * svd.matrixV()).eval();
    benchmark::DoNotOptimize(V.data());
    k = (k + 1) % kRows;
  }
}
BENCHMARK(eigen_svd_of_the_update)->DenseRange(4, 8);

// And of all rows of the last 30 s at 100 Hz.
template <typename Svd>
void eigen_svd_of_3000_rows(benchmark::State& state) {
  const Eigen::Index n = state.range(0);
  const Stream stream(n);
  Eigen::MatrixXd D(3000, n + 1);
  D << stream.rows.topRows(3000), stream.z.head(3000);
  for (auto _ : state) {
    const Svd svd(D, Eigen::ComputeThinV);
    benchmark::DoNotOptimize(svd.matrixV().data());
  }
}
BENCHMARK_TEMPLATE(eigen_svd_of_3000_rows, Eigen::JacobiSVD<Eigen::MatrixXd>)->DenseRange(4, 7);
BENCHMARK_TEMPLATE(eigen_svd_of_3000_rows, Eigen::BDCSVD<Eigen::MatrixXd>)->DenseRange(4, 7);

}  // namespace
