#include "veridyn/muscle/identification/task_residuals.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::muscle {

using estimation::RowMatrix;

double lag1_of(const std::vector<RowMatrix>& residuals) {
  double largest = 0.0;
  for (Eigen::Index j = 0; j < residuals.front().cols(); ++j) {
    double cross = 0.0, squares = 0.0;
    for (const RowMatrix& r : residuals) {
      for (Eigen::Index k = 0; k < r.rows(); ++k) {
        if (std::isnan(r(k, j))) continue;
        squares += r(k, j) * r(k, j);
        const double before = k > 0 ? r(k - 1, j) : kNaN;
        if (!std::isnan(before)) cross += r(k, j) * before;
      }
    }
    if (squares > 0.0) largest = std::max(largest, cross / squares);
  }
  return largest;
}

double share_of_motion(const std::vector<RowMatrix>& residuals, const std::vector<RowMatrix>& measured) {
  double largest = 0.0;
  for (Eigen::Index j = 0; j < residuals.front().cols(); ++j) {
    double squares = 0.0, count = 0.0, range = 0.0;
    for (std::size_t s = 0; s < residuals.size(); ++s) {
      double low = kInfinity, high = -kInfinity;
      for (Eigen::Index k = 0; k < residuals[s].rows(); ++k) {
        if (std::isnan(residuals[s](k, j))) continue;
        squares += residuals[s](k, j) * residuals[s](k, j);
        count += 1.0;
        low = std::min(low, measured[s](k, j));
        high = std::max(high, measured[s](k, j));
      }
      range = std::max(range, high - low);
    }
    if (range > 0.0) largest = std::max(largest, std::sqrt(squares / count) / range);
  }
  return largest;
}

double squares_of(const std::vector<RowMatrix>& residuals, const Eigen::VectorXd& unit) {
  double sum = 0.0;
  for (const RowMatrix& r : residuals) {
    for (Eigen::Index k = 0; k < r.rows(); ++k)
      for (Eigen::Index j = 0; j < r.cols(); ++j)
        if (!std::isnan(r(k, j))) sum += std::pow(r(k, j) / unit(j), 2);
  }
  return sum;
}

}  // namespace veridyn::muscle
