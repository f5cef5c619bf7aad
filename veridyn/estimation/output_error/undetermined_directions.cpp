#include "veridyn/estimation/output_error/undetermined_directions.hpp"

#include <ceres/cost_function.h>

#include <algorithm>
#include <cmath>

#include "veridyn/numerics/linear_algebra/singular_values.hpp"

namespace veridyn::estimation::internal {
namespace {

/// weight rows (x - start), which holds x at its start along the rows.
class HoldCost : public ceres::CostFunction {
 public:
  HoldCost(RowMatrix weighted_rows, Eigen::VectorXd start) : rows_(std::move(weighted_rows)), start_(std::move(start)) {
    set_num_residuals(static_cast<int>(rows_.rows()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(start_.size()));
  }
  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    const Eigen::Map<const Eigen::VectorXd> now(x[0], start_.size());
    Eigen::Map<Eigen::VectorXd>(residuals, rows_.rows()) = rows_ * (now - start_);
    if (jacobians != nullptr && jacobians[0] != nullptr)
      Eigen::Map<RowMatrix>(jacobians[0], rows_.rows(), rows_.cols()) = rows_;
    return true;
  }

 private:
  RowMatrix rows_;
  Eigen::VectorXd start_;
};

}  // namespace

Eigen::VectorXd bound_sigmas(const std::vector<const ModelParameter*>& unknowns) {
  Eigen::VectorXd sigma(unknowns.size());
  for (Eigen::Index i = 0; i < sigma.size(); ++i) {
    const ModelParameter& p = *unknowns[i];
    sigma(i) = (p.high - p.low) / std::sqrt(12.0);
  }
  return sigma;
}

RowMatrix undetermined_rows(const std::vector<const ModelParameter*>& unknowns, const RowMatrix& information_root) {
  const Eigen::VectorXd unit = bound_sigmas(unknowns);
  const numerics::SingularValues svd =
      numerics::singular_values(information_root * unit.asDiagonal(), numerics::SingularVectors::kThinUAndFullV);
  const Eigen::Index n = unit.size();
  const double weight = std::max(1.0, svd.values.size() > 0 ? svd.values(0) : 0.0);
  RowMatrix rows(n, n);
  Eigen::Index count = 0;
  for (Eigen::Index j = 0; j < n; ++j) {
    if (j < svd.values.size() && svd.values(j) > 1.0) continue;
    rows.row(count++) = weight * svd.V.col(j).cwiseQuotient(unit).transpose();
  }
  return rows.topRows(count);
}

void hold_undetermined(ceres::Problem& problem, double* x, const std::vector<const ModelParameter*>& unknowns,
                       const RowMatrix& information_root) {
  RowMatrix rows = undetermined_rows(unknowns, information_root);
  if (rows.rows() == 0) return;
  Eigen::VectorXd start(unknowns.size());
  for (std::size_t i = 0; i < unknowns.size(); ++i) start(i) = unknowns[i]->start;
  problem.AddResidualBlock(new HoldCost(std::move(rows), std::move(start)), nullptr, x);
}

}  // namespace veridyn::estimation::internal
