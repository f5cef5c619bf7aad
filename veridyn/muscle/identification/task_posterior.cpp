#include "veridyn/muscle/identification/task_posterior.hpp"

#include <algorithm>
#include <cmath>

namespace veridyn::muscle {

estimation::PosteriorSample sample_tasks(const estimation::ParametricModel& model,
                                         const std::vector<estimation::RowMatrix>& measured,
                                         const TaskEstimate& estimate, const estimation::EnsembleOptions& options,
                                         Progress& progress, numerics::ValueLog* log) {
  const double dispersion = std::isfinite(estimate.chi_square) ? std::max(1.0, estimate.chi_square) : 1.0;
  return estimation::sample_posterior(model, measured, estimate.best, {.ensemble = options, .dispersion = dispersion},
                                      progress, log);
}

}  // namespace veridyn::muscle
