#include "veridyn/estimation/uncertainty/posterior_sampling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/batches/fingerprint.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::estimation {
namespace {

using Eigen::Index;

/// View of a model and its measurements: the density of its unknowns, in one vector.
class Posterior {
 public:
  Posterior(const ParametricModel& model, const std::vector<RowMatrix>& measured, const OutputErrorEstimate& estimate,
            double dispersion)
      : model_(model), measured_(measured), shared_(estimate.theta), local_(model.segments()) {
    weight_ = (dispersion * estimate.noise_covariance.diagonal()).cwiseInverse();
    for (std::size_t i = 0; i < model.parameters().size(); ++i)
      if (!model.parameters()[i].fixed) add(model.parameters()[i], estimate.theta(i), i);
    shared_count_ = unknowns_.size();
    for (std::size_t s = 0; s < model.segments(); ++s) {
      const auto conditions = model.initial_conditions(s);
      local_[s] = Eigen::VectorXd(conditions.size());
      for (std::size_t i = 0; i < conditions.size(); ++i) local_[s](signed_index(i)) = conditions[i].start;
    }
    for (const SegmentParameter& p : estimate.segment_parameters) {
      const auto conditions = model.initial_conditions(p.segment);
      const auto found =
          std::find_if(conditions.begin(), conditions.end(), [&](const ModelParameter& c) { return c.name == p.name; });
      if (found == conditions.end())
        throw InputError(p.name, "is no initial condition: an estimate with biases of outputs cannot be sampled");
      add(*found, p.value, at(found - conditions.begin()), p.segment);
    }
  }

  [[nodiscard]] std::size_t shared_count() const { return shared_count_; }
  [[nodiscard]] std::size_t parameter(std::size_t i) const { return unknowns_[i].index; }
  [[nodiscard]] Index size() const { return signed_index(unknowns_.size()); }

  [[nodiscard]] double log_density(const Eigen::VectorXd& x) const {
    double sum = 0.0;
    for (Index i = 0; i < x.size(); ++i) {
      const Unknown& u = unknowns_[i];
      if (!(x(i) >= u.what->low && x(i) <= u.what->high)) return -kInfinity;
      if (std::isfinite(u.what->prior_sigma)) sum -= 0.5 * std::pow((x(i) - u.what->start) / u.what->prior_sigma, 2);
    }
    ModelResponse response;
    for (std::size_t s = 0; s < model_.segments(); ++s) {
      if (!model_.respond(s, theta_of(s, x), {}, response)) return -kInfinity;
      for (Index k = 0; k < measured_[s].rows(); ++k) {
        for (Index j = 0; j < measured_[s].cols(); ++j) {
          const double e = measured_[s](k, j) - response.output(k, j);
          if (!std::isnan(measured_[s](k, j))) sum -= 0.5 * weight_(j) * e * e;
        }
      }
    }
    return sum;
  }

  /// The inverse information about the estimate. Unknowns without a prior that the data say nothing of have none.
  [[nodiscard]] NormalApproximation linearised() const {
    NormalApproximation near{.mean = Eigen::VectorXd(size()), .covariance = {}};
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size(), size());
    for (Index i = 0; i < size(); ++i) {
      near.mean(i) = unknowns_[i].value;
      information(i, i) = std::pow(unknowns_[i].what->prior_sigma, -2);
    }
    for (std::size_t s = 0; s < model_.segments(); ++s) add_information(s, near.mean, information);
    const numerics::Cholesky cholesky(information);
    if (!cholesky.positive_definite())
      throw InputError("posterior", "the measurements do not determine all unknowns, and these have no prior");
    near.covariance = cholesky.solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(size(), size())));
    return near;
  }

 private:
  /// View of a parameter of the model that is sampled.
  struct Unknown {
    const ModelParameter* what;
    double value;
    std::size_t index;  // of the model's parameters, or of the segment's initial conditions
    Index segment;      // -1: shared
  };

  void add(const ModelParameter& what, double value, std::size_t index, Index segment = -1) {
    unknowns_.push_back({&what, value, index, segment});
  }

  [[nodiscard]] bool acts_on(const Unknown& u, std::size_t s) const {
    return u.segment < 0 || u.segment == signed_index(s);
  }

  [[nodiscard]] Index place_in(const Unknown& u) const {
    return signed_index(u.index) + (u.segment < 0 ? 0 : shared_.size());
  }

  [[nodiscard]] Eigen::VectorXd theta_of(std::size_t s, const Eigen::VectorXd& x) const {
    Eigen::VectorXd theta(shared_.size() + local_[s].size());
    theta << shared_, local_[s];
    for (Index i = 0; i < x.size(); ++i)
      if (acts_on(unknowns_[i], s)) theta(place_in(unknowns_[i])) = x(i);
    return theta;
  }

  void add_information(std::size_t s, const Eigen::VectorXd& x, Eigen::MatrixXd& information) const {
    std::vector<Index> active, which;
    for (Index i = 0; i < size(); ++i) {
      if (!acts_on(unknowns_[i], s)) continue;
      active.push_back(place_in(unknowns_[i]));
      which.push_back(i);
    }
    ModelResponse response;
    if (!model_.respond(s, theta_of(s, x), active, response))
      throw InputError("posterior", model_.segment_name(s) + " cannot be simulated where the search ended");
    const Index outputs = measured_[s].cols();
    for (Index k = 0; k < measured_[s].rows(); ++k) {
      for (Index j = 0; j < outputs; ++j) {
        if (std::isnan(measured_[s](k, j))) continue;
        const Eigen::VectorXd row = response.sensitivity.row(k * outputs + j).transpose();
        for (Index a = 0; a < row.size(); ++a)
          for (Index b = 0; b < row.size(); ++b) information(which[a], which[b]) += weight_(j) * row(a) * row(b);
      }
    }
  }

  const ParametricModel& model_;
  const std::vector<RowMatrix>& measured_;
  Eigen::VectorXd shared_;              // all shared parameters at the estimate
  std::vector<Eigen::VectorXd> local_;  // by segment
  Eigen::VectorXd weight_;              // by output
  std::vector<Unknown> unknowns_;
  std::size_t shared_count_ = 0;
};

/// Answered from the log where it is there; a density takes a simulation of every segment.
double kept_density(const Posterior& posterior, const Eigen::VectorXd& x, numerics::ValueLog* log) {
  numerics::Fingerprint key;
  key.add("posterior");
  for (const double value : x) key.add(value);
  const auto fits = [](std::size_t count) { return count == 1; };
  const auto compute = [&] { return std::vector<double>{posterior.log_density(x)}; };
  return numerics::kept_or_computed(log, key.value(), fits, compute).front();
}

void kept_densities(const Posterior& posterior, std::span<const Eigen::VectorXd> points, std::span<double> densities,
                    numerics::ValueLog* log, int threads) {
  numerics::parallel_for(points.size(), threads,
                         [&](std::size_t k) { densities[k] = kept_density(posterior, points[k], log); });
}

}  // namespace

PosteriorSample sample_posterior(const ParametricModel& model, const std::vector<RowMatrix>& measured,
                                 const OutputErrorEstimate& estimate, const PosteriorOptions& options,
                                 Progress& progress, numerics::ValueLog* log) {
  if (!(options.dispersion >= 1.0))
    throw InputError("dispersion", fmt::format("= {:g} must be at least 1", options.dispersion));
  const Posterior posterior(model, measured, estimate, options.dispersion);
  const LogDensity density = [&](const Eigen::VectorXd& x) { return kept_density(posterior, x, log); };
  const LogDensities densities = [&](std::span<const Eigen::VectorXd> points, std::span<double> values) {
    kept_densities(posterior, points, values, log, progress.threads());
  };
  const NormalApproximation near = posterior.linearised();
  PosteriorSample sample;
  sample.ensemble =
      sample_ensemble(densities, ensemble_start(density, near, options.ensemble), near, options.ensemble, progress);
  for (std::size_t i = 0; i < posterior.shared_count() && sample.ensemble.draws.rows() > 0; ++i) {
    const auto column = sample.ensemble.draws.col(i);
    std::vector<double> sorted(column.begin(), column.end());
    std::sort(sorted.begin(), sorted.end());
    const ModelParameter& p = model.parameters()[posterior.parameter(i)];
    const double mean = column.mean();
    sample.parameters.push_back({.parameter = posterior.parameter(i),
                                 .name = p.name,
                                 .unit = p.unit,
                                 .mean = mean,
                                 .sd = std::sqrt((column.array() - mean).square().mean()),
                                 .low = numerics::quantile_of_sorted(sorted, 0.025),
                                 .median = numerics::quantile_of_sorted(sorted, 0.5),
                                 .high = numerics::quantile_of_sorted(sorted, 0.975)});
  }
  return sample;
}

}  // namespace veridyn::estimation
