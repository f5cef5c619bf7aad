#include "veridyn/muscle/tasks/task_error.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "veridyn/core/constants.hpp"

namespace veridyn::muscle {

TaskError task_error(const estimation::RowMatrix& target, const estimation::RowMatrix& predicted, double least_range) {
  const bool finished = predicted.size() > 0;
  if (finished && (predicted.rows() != target.rows() || predicted.cols() != target.cols()))
    throw std::invalid_argument("task_error: the prediction has other sizes than the target");
  TaskError error;
  double all = 0.0, sum = 0.0;
  Eigen::Index values = 0, moving = 0;
  for (Eigen::Index j = 0; j < target.cols(); ++j) {
    double low = kInfinity, high = -kInfinity, squares = 0.0;
    Eigen::Index count = 0;
    for (Eigen::Index k = 0; k < target.rows(); ++k) {
      if (std::isnan(target(k, j))) continue;
      low = std::min(low, target(k, j));
      high = std::max(high, target(k, j));
      if (!finished || std::isnan(predicted(k, j))) continue;
      squares += (predicted(k, j) - target(k, j)) * (predicted(k, j) - target(k, j));
      ++count;
    }
    all += squares;
    values += count;
    if (!(high > low)) continue;
    error.range = std::max(error.range, high - low);
    if (high - low < least_range) continue;
    ++moving;
    sum += std::sqrt(squares / static_cast<double>(count)) / (high - low);
  }
  error.moves = moving > 0;
  error.rmse = finished && values > 0 ? std::sqrt(all / static_cast<double>(values)) : kNaN;
  error.nrmse = finished && moving > 0 ? sum / static_cast<double>(moving) : kNaN;
  return error;
}

}  // namespace veridyn::muscle
