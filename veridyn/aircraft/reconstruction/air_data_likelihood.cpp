#include "veridyn/aircraft/reconstruction/air_data_likelihood.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/numerics/linear_algebra/cholesky.hpp"

namespace veridyn::aircraft::internal {
namespace {

constexpr double kIntensityPrior = 0.3;

/// ln L plus ln prior with its derivatives; the unknowns theta (errors of the air data, then the logarithms of the
/// gusts' intensities) in units of their priors.
struct Posterior {
  double log_posterior = 0.0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd information;
};

/// View of a task whose likelihood it evaluates.
class AirDataLikelihood {
 public:
  AirDataLikelihood(const FilterEngine& engine, const RunSetting& base, const SolveTask& task, std::vector<int> index)
      : engine_(&engine), base_(&base), task_(&task), index_(std::move(index)) {}

  [[nodiscard]] Eigen::Index errors() const { return static_cast<Eigen::Index>(index_.size()); }
  [[nodiscard]] Eigen::Index size() const { return errors() + 3; }
  [[nodiscard]] const std::vector<int>& index() const { return index_; }
  [[nodiscard]] double prior(Eigen::Index i) const { return air_data_error_priors()[index_[i]]; }

  [[nodiscard]] DrydenSettings spectrum(const Eigen::VectorXd& theta) const {
    DrydenSettings spectrum = base_->motion.spectrum;
    spectrum.sigma_u *= std::exp(kIntensityPrior * theta(errors()));
    spectrum.sigma_v *= std::exp(kIntensityPrior * theta(errors() + 1));
    spectrum.sigma_w *= std::exp(kIntensityPrior * theta(errors() + 2));
    return spectrum;
  }

  [[nodiscard]] Posterior operator()(const Eigen::VectorXd& theta, double gate) const {
    ReconstructOptions options = *task_->options;
    options.gate.threshold = gate;
    const std::vector<double> no_output;
    const std::vector<RunSetting> settings = settings_at(theta, options, no_output);
    Posterior d{.gradient = -theta, .information = Eigen::MatrixXd::Identity(size(), size())};
    d.log_posterior = -0.5 * theta.squaredNorm();
    for (const Segment& segment : task_->segments) add(segment, settings, d);
    return d;
  }

 private:
  static constexpr double kStep = 1e-3;

  /// At theta, then with each component moved by a step.
  [[nodiscard]] std::vector<RunSetting> settings_at(const Eigen::VectorXd& theta, const ReconstructOptions& options,
                                                    const std::vector<double>& no_output) const {
    std::vector<RunSetting> settings(static_cast<std::size_t>(size()) + 1, *base_);
    for (std::size_t k = 0; k < settings.size(); ++k) {
      settings[k].options = &options;
      settings[k].output_t = &no_output;
      settings[k].air_error.setZero();
      Eigen::VectorXd at = theta;
      if (k > 0) at(static_cast<Eigen::Index>(k) - 1) += kStep;
      for (Eigen::Index i = 0; i < errors(); ++i) settings[k].air_error(index_[i]) = at(i) * prior(i);
      settings[k].motion.spectrum = spectrum(at);
    }
    return settings;
  }

  void add(const Segment& segment, const std::vector<RunSetting>& settings, Posterior& d) const {
    const estimation::InnovationGate& gate = settings[0].options->gate;
    Eigen::VectorXd nu(size()), S(size());
    std::vector<std::unique_ptr<InnovationRun>> runs;
    for (const RunSetting& setting : settings)
      runs.push_back(engine_->innovation_run(setting, segment, monitors_with(gate)));
    while (runs[0]->advance()) {
      for (std::size_t k = 1; k < runs.size(); ++k) static_cast<void>(runs[k]->advance());
      for (std::size_t m = 0; m < runs[0]->innovations().size(); ++m) {
        const SensorInnovation& at = runs[0]->innovations()[m];
        bool usable = at.accepted;
        for (std::size_t k = 1; k < runs.size() && usable; ++k) {
          const SensorInnovation& moved = runs[k]->innovations()[m];
          usable = moved.accepted;
          nu(static_cast<Eigen::Index>(k) - 1) = (moved.nu - at.nu) / kStep;
          S(static_cast<Eigen::Index>(k) - 1) = (moved.S - at.S) / kStep;
        }
        if (!usable) {
          // What the gate refuses counts as an innovation on the gate, so that refusing does not pay.
          d.log_posterior -= 0.5 * (gate.threshold * gate.threshold + std::log(at.S));
          continue;
        }
        d.log_posterior -= 0.5 * (at.nis() + std::log(at.S));
        d.gradient += nu * (-at.nu / at.S) + S * (0.5 * (at.nis() - 1.0) / at.S);
        d.information.noalias() += nu * nu.transpose() / at.S + S * S.transpose() * (0.5 / (at.S * at.S));
      }
    }
  }

  const FilterEngine* engine_;
  const RunSetting* base_;
  const SolveTask* task_;
  std::vector<int> index_;
};

}  // namespace

AirDataErrors estimate_air_data_errors(const FilterEngine& engine, const RunSetting& base, const SolveTask& task) {
  const AirDataLikelihood evaluate(engine, base, task, estimated_air_data_errors(*task.options));
  AirDataErrors result;
  result.index = evaluate.index();
  const Eigen::Index errors = evaluate.errors();
  // A wide gate first: what an uncorrected sensor shows is not an outlier.
  constexpr double kWide = 20.0;
  constexpr int kMaxIterations = 15;
  double gate = std::max(kWide, task.options->gate.threshold);
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(evaluate.size());
  Posterior now = evaluate(theta, gate);
  result.converged = false;
  for (int i = 0; i < kMaxIterations; ++i) {
    ++result.iterations;
    const Eigen::VectorXd step = numerics::solve_symmetric(now.information, now.gradient);
    const double length = std::sqrt(std::max(0.0, step.dot(now.gradient)));  // in sigmas
    if (length < 0.05) {
      if (gate <= task.options->gate.threshold) {
        result.converged = true;
        break;
      }
      gate = task.options->gate.threshold;
      now = evaluate(theta, gate);
      continue;
    }
    double share = 1.0;
    Eigen::VectorXd tried = theta + step;
    Posterior there = evaluate(tried, gate);
    while (!(there.log_posterior > now.log_posterior - 1e-6) && share > 0.05) {
      share *= 0.4;
      tried = theta + share * step;
      there = evaluate(tried, gate);
    }
    if (!(there.log_posterior > now.log_posterior - 1e-6)) break;
    theta = tried;
    now = std::move(there);
  }
  Eigen::VectorXd scale(errors);
  for (Eigen::Index i = 0; i < errors; ++i) {
    scale(i) = evaluate.prior(i);
    result.value(result.index[i]) = theta(i) * scale(i);
  }
  result.covariance = scale.asDiagonal() * now.information.inverse().topLeftCorner(errors, errors) * scale.asDiagonal();
  result.spectrum = evaluate.spectrum(theta);
  for (Eigen::Index i = 0; i < errors; ++i) result.applied.push_back(i);
  return result;
}

}  // namespace veridyn::aircraft::internal
