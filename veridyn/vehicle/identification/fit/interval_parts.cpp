#include "veridyn/vehicle/identification/fit/interval_parts.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "veridyn/numerics/linear_algebra/cholesky.hpp"
#include "veridyn/vehicle/identification/options/drive_budget.hpp"

namespace veridyn::vehicle {

IntervalParts interval_parts(const estimation::OutputErrorEstimate& estimate, DriveUnknown unknown) {
  const Eigen::MatrixXd& P = estimate.covariance;
  const auto i = static_cast<Eigen::Index>(unknown);
  std::vector<Eigen::Index> open;
  for (const DrivePrior& prior : kDriveBudget) {
    const auto j = static_cast<Eigen::Index>(prior.unknown);
    if (j != i && P(j, j) > 0.0 && std::isfinite(P(j, j))) open.push_back(j);
  }
  // What the budget explains of the unknown: their covariance, given by that of the budget alone.
  double explained = 0.0;
  if (!open.empty()) {
    const Eigen::VectorXd with = P(open, i);
    explained = with.dot(numerics::Cholesky(P(open, open)).solve(Eigen::MatrixXd(with)).col(0));
  }
  explained = std::clamp(explained, 0.0, P(i, i));
  return {std::sqrt(P(i, i) - explained), std::sqrt(explained), std::sqrt(estimate.covariance_by_model(i, i))};
}

}  // namespace veridyn::vehicle
