#include "veridyn/estimation/output_error/information.hpp"

#include "veridyn/estimation/output_error/output_error_problem.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"

namespace veridyn::estimation {

std::optional<RowMatrix> information_root(const ParametricModel& model, OutputErrorOptions options) {
  options.noise = OutputNoise::kGiven;
  options.validate(model);
  std::vector<RowMatrix> measured;
  for (std::size_t s = 0; s < model.segments(); ++s)
    measured.emplace_back(RowMatrix::Zero(model.samples(s), model.outputs().size()));
  internal::OutputErrorProblem problem(model, measured, options);
  problem.start_noise();
  problem.evaluate(true);
  if (!problem.valid()) return std::nullopt;
  return problem.shared_root();
}

Eigen::MatrixXd covariance_after(const Eigen::MatrixXd& P, const RowMatrix& information_root) {
  const Eigen::MatrixXd spread = information_root * P;
  Eigen::MatrixXd gain = spread * information_root.transpose();
  gain.diagonal().array() += 1.0;
  const Eigen::MatrixXd white = numerics::Cholesky(gain).solve_lower(spread);
  return P - white.transpose() * white;
}

}  // namespace veridyn::estimation
