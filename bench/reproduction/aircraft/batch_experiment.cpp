#include "bench/reproduction/aircraft/batch_experiment.hpp"

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::aircraft {

using estimation::RegressionEstimate;

double BatchStatistics::bias(Eigen::Index i, const Eigen::VectorXd& truth) const {
  return std::abs(mean(i) - truth(i)) / sd(i);
}

BatchExperiment run_batch_experiment(const ExperimentOptions& o, const std::vector<estimation::Method>& methods,
                                     Progress& progress) {
  BatchExperiment out;
  out.rows = exact_rows(o, progress);
  const auto n = out.rows.regressors.cols();
  const auto seeds = static_cast<std::size_t>(o.seeds);
  const estimation::RegressionOptions options;
  struct One {
    bool usable = false;
    Eigen::VectorXd theta, sigma, low, high;
  };
  std::vector<std::vector<One>> found(methods.size(), std::vector<One>(seeds));
  progress.stage("estimating");
  const auto estimate = [&](std::size_t seed) {
    const estimation::RegressionData data = noisy_rows(out.rows, o, seed);
    for (std::size_t m = 0; m < methods.size(); ++m) {
      const RegressionEstimate e = estimation::estimate(data, methods[m], options);
      One& one = found[m][seed];
      one.usable = e.usable();
      if (!one.usable) continue;
      one.theta = e.theta;
      one.sigma.resize(n), one.low.resize(n), one.high.resize(n);
      for (Eigen::Index i = 0; i < n; ++i) {
        const estimation::Parameter& p = e.parameters[i];
        one.sigma(i) = p.sigma, one.low(i) = p.low95, one.high(i) = p.high95;
      }
    }
  };
  out.interrupted = !numerics::parallel_for(seeds, progress.threads(), estimate, [&](std::size_t done) {
    return progress.update(static_cast<double>(done) / static_cast<double>(seeds));
  });
  if (out.interrupted) return out;

  const double largest = out.rows.regressand.cwiseAbs().maxCoeff();
  for (std::size_t m = 0; m < methods.size(); ++m) {
    BatchStatistics s;
    s.method = methods[m];
    s.mean = s.sd = s.mean_sigma = s.coverage = Eigen::VectorXd::Zero(n);
    s.output_error = Eigen::VectorXd::Constant(o.seeds, kNaN);
    for (std::size_t k = 0; k < seeds; ++k) {
      const One& one = found[m][k];
      if (!one.usable) continue;
      ++s.estimates;
      s.mean += one.theta;
      s.mean_sigma += one.sigma.cwiseAbs2();
      for (Eigen::Index i = 0; i < n; ++i)
        s.coverage(i) += out.rows.truth(i) >= one.low(i) && out.rows.truth(i) <= one.high(i) ? 1.0 : 0.0;
      const Eigen::VectorXd output = out.rows.regressors * one.theta;
      s.output_error(k) = (output - out.rows.regressand).cwiseAbs().maxCoeff() / largest;
      if (k == 0) s.example.assign(output.data(), output.data() + output.size());
    }
    const double count = std::max(1, s.estimates);
    s.mean /= count;
    s.mean_sigma = (s.mean_sigma / count).cwiseSqrt();
    s.coverage /= count;
    for (const One& one : found[m]) {
      if (one.usable) s.sd += (one.theta - s.mean).cwiseAbs2();
    }
    s.sd = (s.sd / std::max(1.0, count - 1.0)).cwiseSqrt();
    out.methods.push_back(std::move(s));
  }
  return out;
}

}  // namespace veridyn::aircraft
