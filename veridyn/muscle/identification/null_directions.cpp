#include "veridyn/muscle/identification/null_directions.hpp"

#include <fmt/format.h>

#include <cmath>

#include "veridyn/core/index.hpp"
#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"

namespace veridyn::muscle {
namespace {

/// Parameters with a third of the largest part.
std::string words_of(std::span<const estimation::ModelParameter> parameters, const Eigen::VectorXd& v) {
  Eigen::Index largest = 0;
  v.cwiseAbs().maxCoeff(&largest);
  const double sign = v(largest) < 0.0 ? -1.0 : 1.0;
  std::string raised, lowered;
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    if (std::abs(v(i)) < std::abs(v(largest)) / 3.0) continue;
    std::string& side = sign * v(i) > 0.0 ? raised : lowered;
    side += (side.empty() ? "" : ", ") + parameters[i].name;
  }
  return lowered.empty() ? raised : fmt::format("{} against {}", raised, lowered);
}

}  // namespace

NullDirections null_directions(std::span<const estimation::ModelParameter> parameters,
                               const Eigen::MatrixXd& covariance, double share) {
  NullDirections out;
  const auto all = signed_index(parameters.size());
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < all; ++i)
    if (!parameters[i].fixed) free.push_back(i);
  const auto n = signed_index(free.size());
  Eigen::MatrixXd scaled = covariance(free, free);
  for (Eigen::Index i = 0; i < n; ++i) {
    scaled.row(i) /= parameters[free[i]].prior_sigma;
    scaled.col(i) /= parameters[free[i]].prior_sigma;
  }
  if (!scaled.allFinite()) return out;
  const auto eigen = numerics::symmetric_eigen(scaled);
  std::vector<Eigen::VectorXd> found;
  for (Eigen::Index j = n - 1; j >= 0; --j) {
    if (!(eigen.values(j) > share)) continue;
    Eigen::VectorXd direction = Eigen::VectorXd::Zero(all);
    direction(free) = eigen.vectors.col(j);
    out.texts.push_back(words_of(parameters, direction));
    found.push_back(direction);
  }
  out.vectors.resize(all, found.size());
  for (std::size_t j = 0; j < found.size(); ++j) out.vectors.col(j) = found[j];
  return out;
}

}  // namespace veridyn::muscle
