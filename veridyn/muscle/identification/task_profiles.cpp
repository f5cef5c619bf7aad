#include "veridyn/muscle/identification/task_profiles.hpp"

#include <algorithm>

#include "veridyn/estimation/output_error/correlated_noise_model.hpp"

namespace veridyn::muscle {

estimation::ProfileResult profile_tasks(const estimation::ParametricModel& model,
                                        const std::vector<estimation::RowMatrix>& measured,
                                        const Eigen::VectorXd& noise, const TaskEstimate& estimate,
                                        std::span<const std::string> parameters, Progress& progress) {
  estimation::ProfileOptions options;
  estimation::OutputErrorOptions& fit = options.output_error;
  fit.free_initial_conditions = !model.initial_conditions(0).empty() && !model.initial_conditions(0).front().fixed;
  // Statistics to about 1e-3: steps in a valley that gain less are not worth their simulations.
  fit.tolerance = 0.05;
  if (noise.size() > 0) {
    fit.noise = estimation::OutputNoise::kGiven;
    fit.noise_start = noise;
    fit.max_relaxations = 1;
    options.dispersion = std::max(1.0, estimate.chi_square);
  }
  std::vector<std::size_t> which;
  for (const std::string& name : parameters) {
    for (std::size_t i = 0; i < model.parameters().size(); ++i)
      if (model.parameters()[i].name == name) which.push_back(i);
  }
  if (estimate.noise_correlation.size() == 0)
    return estimation::profile_likelihood(model, measured, estimate.best, which, options, progress);
  const estimation::CorrelatedNoiseModel white(model, measured, estimate.noise_correlation);
  return estimation::profile_likelihood(white, white.whitened(measured), estimate.best, which, options, progress);
}

}  // namespace veridyn::muscle
