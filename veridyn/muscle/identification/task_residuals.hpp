#pragma once

#include <vector>

#include "veridyn/estimation/regression/regression_data.hpp"

namespace veridyn::muscle {

/// Autocorrelation of residuals at one sample, samples x outputs by task (NaN: not measured), the largest of any
/// output; at least 0.
[[nodiscard]] double lag1_of(const std::vector<estimation::RowMatrix>& residuals);

/// Root mean square of residuals over the largest range that the output has in any task, the largest of any output.
[[nodiscard]] double share_of_motion(const std::vector<estimation::RowMatrix>& residuals,
                                     const std::vector<estimation::RowMatrix>& measured);

/// Sum of squares, each output in its `unit`.
[[nodiscard]] double squares_of(const std::vector<estimation::RowMatrix>& residuals, const Eigen::VectorXd& unit);

}  // namespace veridyn::muscle
