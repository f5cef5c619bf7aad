#include "veridyn/estimation/uncertainty/monte_carlo.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/gaussian_copula.hpp"
#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"
#include "veridyn/numerics/moments.hpp"
#include "veridyn/numerics/random.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::estimation {
namespace {

constexpr std::size_t kBlock = 512;

/// Root of a positive semidefinite matrix: an LDL' would do, but errors may be exactly zero or fully correlated.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& covariance) {
  const numerics::SymmetricEigen eigen = numerics::symmetric_eigen(covariance);
  return eigen.vectors * eigen.values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

void fill_normal(Eigen::MatrixXd& m, numerics::RandomStream& random) {
  for (Eigen::Index j = 0; j < m.cols(); ++j) {
    for (Eigen::Index i = 0; i < m.rows(); ++i) m(i, j) = random.normal();
  }
}

/// View of the inputs that draws them; a block has the same draws on any thread.
class InputSampler {
 public:
  explicit InputSampler(const UncertainInputs& inputs)
      : inputs_(inputs), copula_(inputs.correlation), error_root_(root_of(inputs.error_covariance)) {}

  void truth(numerics::RandomStream& random, Eigen::MatrixXd& x) const {
    fill_normal(x, random);
    copula_.couple(x);
    const Eigen::VectorXd width = inputs_.high - inputs_.low;
    x = ((width.asDiagonal() * x).colwise() + inputs_.low).eval();
  }

  void error(numerics::RandomStream& random, Eigen::MatrixXd& noise, Eigen::MatrixXd& e) const {
    fill_normal(noise, random);
    e.noalias() = error_root_ * noise;
  }

  [[nodiscard]] double correlation_change() const { return copula_.repair().largest_change; }

 private:
  const UncertainInputs& inputs_;
  numerics::GaussianCopula copula_;
  Eigen::MatrixXd error_root_;
};

/// Value below which a share p of the sorted draws lies: rank p M, JCGM 101 7.7.2.
std::size_t rank_of(double p, std::size_t count) {
  const double rank = std::round(p * static_cast<double>(count) + 0.5) - 1.0;
  return static_cast<std::size_t>(std::clamp(rank, 0.0, static_cast<double>(count - 1)));
}

ErrorDistribution describe(std::vector<double>& error, double coverage) {
  ErrorDistribution d;
  const std::size_t all = error.size();
  std::erase_if(error, [](double e) { return !std::isfinite(e); });
  d.not_finite = all - error.size();
  if (error.empty()) return d;
  std::sort(error.begin(), error.end());
  const std::size_t count = error.size();
  const double p = 0.5 * (1.0 - coverage);
  d.low = error[rank_of(p, count)];
  d.high = error[rank_of(1.0 - p, count)];
  d.sigma = std::max(std::abs(d.low), std::abs(d.high)) / numerics::normal_quantile(1.0 - p);
  d.mean = numerics::mean(error);
  double squares = 0.0;
  for (const double e : error) squares += (e - d.mean) * (e - d.mean);
  d.sd = std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, count - 1)));
  // The number of draws below a quantile is binomial.
  const double spread = numerics::kNormal95 * std::sqrt(p * (1.0 - p) / static_cast<double>(count));
  d.endpoint_error = 0.5 * std::max(error[rank_of(p + spread, count)] - error[rank_of(p - spread, count)],
                                    error[rank_of(1.0 - p + spread, count)] - error[rank_of(1.0 - p - spread, count)]);
  return d;
}

}  // namespace

void UncertainInputs::validate() const {
  const auto n = signed_index(names.size());
  if (low.size() != n || high.size() != n || correlation.rows() != n || correlation.cols() != n ||
      error_covariance.rows() != n || error_covariance.cols() != n) {
    throw InputError("uncertain inputs", fmt::format("sizes differ: {} names", n));
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::string& name = names[i];
    if (!(std::isfinite(low(i)) && std::isfinite(high(i)) && low(i) <= high(i))) {
      throw InputError("uncertain inputs", fmt::format("range [{}, {}] of {} is not one", low(i), high(i), name));
    }
    if (!(error_covariance(i, i) >= 0.0) || !error_covariance.row(i).allFinite()) {
      throw InputError("uncertain inputs",
                       fmt::format("error variance {} of {} must be finite and >= 0", error_covariance(i, i), name));
    }
    if (!(correlation.row(i).array().abs() <= 1.0 + 1e-12).all()) {
      throw InputError("uncertain inputs", fmt::format("correlations of {} must lie between -1 and 1", name));
    }
  }
}

void MonteCarloOptions::validate() const {
  if (draws < 100) throw InputError("draws", fmt::format("= {} must be at least 100", draws));
  if (draws > 100'000'000) throw InputError("draws", fmt::format("= {} must be at most 1e8", draws));
  if (!(coverage > 0.0 && coverage < 1.0))
    throw InputError("coverage", fmt::format("= {} must be between 0 and 1", coverage));
}

MonteCarloResult propagate_errors(const UncertainInputs& inputs, std::size_t outputs, const InputsToOutputs& f,
                                  const MonteCarloOptions& options) {
  inputs.validate();
  options.validate();
  const auto start = std::chrono::steady_clock::now();
  const InputSampler sampler(inputs);
  const auto n = signed_index(inputs.names.size());
  std::vector<std::vector<double>> error(outputs, std::vector<double>(options.draws));
  const std::size_t blocks = (options.draws + kBlock - 1) / kBlock;
  const auto draw = [&](std::size_t block) {
    Eigen::MatrixXd x(n, kBlock), noise = x, e = x;
    std::vector<double> true_output(outputs), measured_output(outputs);
    numerics::RandomStream random(options.seed, static_cast<std::uint64_t>(block));
    sampler.truth(random, x);
    sampler.error(random, noise, e);
    e += x;
    const std::size_t begin = block * kBlock;
    const std::size_t count = std::min(kBlock, options.draws - begin);
    for (std::size_t k = 0; k < count; ++k) {
      f(x.col(k).data(), true_output.data());
      f(e.col(k).data(), measured_output.data());
      for (std::size_t o = 0; o < outputs; ++o) error[o][begin + k] = measured_output[o] - true_output[o];
    }
  };
  numerics::parallel_for(blocks, options.threads, draw);

  MonteCarloResult result;
  result.draws = options.draws;
  result.correlation_change = sampler.correlation_change();
  result.outputs.resize(outputs);
  numerics::parallel_for(outputs, options.threads,
                         [&](std::size_t o) { result.outputs[o] = describe(error[o], options.coverage); });
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

Eigen::VectorXd linear_error_propagation(const UncertainInputs& inputs, std::size_t outputs,
                                         const InputsToJacobian& jacobian, std::size_t points, std::uint64_t seed) {
  inputs.validate();
  const auto n = signed_index(inputs.names.size());
  Eigen::MatrixXd x(n, std::max<std::size_t>(1, points));
  if (points == 0) {
    x.col(0) = 0.5 * (inputs.low + inputs.high);
  } else {
    numerics::RandomStream random(seed, "linear error propagation");
    InputSampler(inputs).truth(random, x);
  }
  Eigen::VectorXd variance = Eigen::VectorXd::Zero(outputs);
  for (Eigen::Index k = 0; k < x.cols(); ++k) {
    const Eigen::MatrixXd J = jacobian(x.col(k));
    variance += (J * inputs.error_covariance).cwiseProduct(J).rowwise().sum();
  }
  return (variance / static_cast<double>(x.cols())).cwiseMax(0.0).cwiseSqrt();
}

}  // namespace veridyn::estimation
