#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/estimation/uncertainty/profile_likelihood.hpp"
#include "veridyn/muscle/identification/task_estimate.hpp"

namespace veridyn::muscle {

/// Profile likelihood of parameters of an estimate from tasks, by name: its priors, its noise, and its widening where
/// the residual is larger than the noise. Arguments as of `estimate_from_tasks`.
[[nodiscard]] estimation::ProfileResult profile_tasks(const estimation::ParametricModel& model,
                                                      const std::vector<estimation::RowMatrix>& measured,
                                                      const Eigen::VectorXd& noise, const TaskEstimate& estimate,
                                                      std::span<const std::string> parameters, Progress& progress);

}  // namespace veridyn::muscle
