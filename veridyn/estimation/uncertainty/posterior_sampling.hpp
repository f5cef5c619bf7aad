#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"
#include "veridyn/estimation/uncertainty/ensemble_sampler.hpp"
#include "veridyn/numerics/batches/value_log.hpp"

namespace veridyn::estimation {

/// How the posterior of an output-error estimate is sampled.
struct PosteriorOptions {
  EnsembleOptions ensemble = {};
  /// The exponent of the likelihood is divided by it: the normalised chi-square of a residual that is larger than the
  /// stated noise (Birge 1932); at least 1.
  double dispersion = 1.0;
};

/// What the draws say of one shared parameter.
struct PosteriorParameter {
  std::size_t parameter = 0;  ///< of the model
  std::string name = {}, unit = {};
  double mean = 0.0, sd = 0.0;
  double low = 0.0, median = 0.0, high = 0.0;  ///< quantiles of 2.5, 50 and 97.5 %
};

/// Draws of the posterior of a model's unknowns.
struct PosteriorSample {
  /// Free shared parameters in the model's order, then the segments' own unknowns.
  std::vector<PosteriorParameter> parameters;
  EnsembleSample ensemble;  ///< its first columns are `parameters`, in their order

  [[nodiscard]] bool usable() const { return !parameters.empty() && !ensemble.interrupted; }
};

/// The posterior of the unknowns of an output-error estimate by an ensemble of walkers: likelihood of white noise with
/// the estimate's noise (outputs taken for independent of each other), priors, bounds; the segments' free initial
/// conditions are sampled with them. Where error bars (a parabola about the estimate) and these quantiles differ, the
/// quantiles are right, as far as the noise is white.
/// @param estimate usable; where the walkers begin
/// @param log  densities by walkers' places, of this model and recording alone: those of an earlier run are taken from
/// it, so that one which was cut off goes on to the same bits. nullptr: nothing is kept
/// @throws InputError when an option is out of order, or the estimate has biases of outputs.
[[nodiscard]] PosteriorSample sample_posterior(const ParametricModel& model, const std::vector<RowMatrix>& measured,
                                               const OutputErrorEstimate& estimate, const PosteriorOptions& options,
                                               Progress& progress, numerics::ValueLog* log = nullptr);

}  // namespace veridyn::estimation
