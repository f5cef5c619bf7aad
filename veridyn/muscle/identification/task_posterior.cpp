#include "veridyn/muscle/identification/task_posterior.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/estimation/output_error/correlated_noise_model.hpp"

namespace veridyn::muscle {

estimation::PosteriorSample sample_tasks(const estimation::ParametricModel& model,
                                         const std::vector<estimation::RowMatrix>& measured,
                                         const TaskEstimate& estimate, const estimation::EnsembleOptions& options,
                                         Progress& progress, numerics::ValueLog* log) {
  const double dispersion = std::isfinite(estimate.chi_square) ? std::max(1.0, estimate.chi_square) : 1.0;
  const estimation::PosteriorOptions drawn{.ensemble = options, .dispersion = dispersion};
  if (estimate.noise_correlation.size() == 0)
    return estimation::sample_posterior(model, measured, estimate.best, drawn, progress, log);
  const estimation::CorrelatedNoiseModel white(model, measured, estimate.noise_correlation);
  return estimation::sample_posterior(white, white.whitened(measured), estimate.best, drawn, progress, log);
}

}  // namespace veridyn::muscle
