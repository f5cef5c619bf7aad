#pragma once

#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/uncertainty/posterior_sampling.hpp"
#include "veridyn/muscle/identification/task_estimate.hpp"

namespace veridyn::muscle {

/// The posterior of an estimate from tasks by an ensemble of walkers, with the noise, priors and bounds of the
/// estimate; where the residual is larger than the stated noise it is widened as the error bars are.
/// @param log  as `estimation::sample_posterior`
[[nodiscard]] estimation::PosteriorSample sample_tasks(const estimation::ParametricModel& model,
                                                       const std::vector<estimation::RowMatrix>& measured,
                                                       const TaskEstimate& estimate,
                                                       const estimation::EnsembleOptions& options, Progress& progress,
                                                       numerics::ValueLog* log = nullptr);

}  // namespace veridyn::muscle
