#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <span>
#include <vector>

#include "veridyn/aircraft/reconstruction/reconstruct_run.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_solve.hpp"

/// Inside of reconstruct_solve: errors of vanes and pitot tube by maximum likelihood.
namespace veridyn::aircraft::internal {

/// Constant errors of the air data: which are estimated (AirDataErrorIndex), their values and covariance.
struct AirDataErrors {
  std::vector<int> index;
  Eigen::Matrix<double, 5, 1> value = Eigen::Matrix<double, 5, 1>::Zero();  ///< 0 where not estimated
  Eigen::MatrixXd covariance;                                               ///< in the order of `index`
  DrydenSettings spectrum;                                                  ///< with intensities as they fit best
  int iterations = 0;
  bool converged = true;
};

/// 1 sigma of each before the flight; see kVaneBiasPrior and its like.
[[nodiscard]] std::array<double, 5> air_data_error_priors();
[[nodiscard]] std::vector<int> wanted_air_data_errors(const ReconstructOptions& options);

/// The errors theta that maximise likelihood times prior, after the filter-error method (Maine & Iliff 1985;
/// Jategaonkar 2006, chapter 5): for a given theta the filter runs with the air data corrected, and
///
///     ln L(theta) = -1/2 sum [nu^2 / S + ln S] - 1/2 sum (theta / prior)^2
///
/// over all innovations nu with predicted variance S. Fisher scoring with
///
///     I = sum [nu_i nu_j / S + S_i S_j / (2 S^2)] + prior^-2
///
/// (nu_i, S_i: derivatives by theta_i, by differences of filters that run side by side); I^-1 is the covariance.
///
/// Why not as states of the filter: an extended filter multiplies uncertain scale factors with uncertain gusts, and its
/// linearisation points scatter with the estimates; what looks like information about a constant is in part that
/// scatter, and its sigmas come out three to eight times too small. For the same reason the most likely trajectory
/// (an iterated smoother) is no way out: gain and gust only appear as a product, and their joint mode runs away. With
/// theta fixed the filter's innovations are as they should be, and the gusts are integrated out, not maximised over.
///
/// The intensities of the gusts along the three axes are estimated along with theta, within a factor e^0.3 (1 sigma):
/// otherwise an angle's fluctuation, sigma_w / Va, would tell the airspeed to a percent to whoever believes that
/// sigma_w is known to a percent.
template <class Model>
[[nodiscard]] AirDataErrors estimate_air_data_errors(const RunSetting<Model>& base, const SolveTask& task) {
  AirDataErrors result;
  result.index = wanted_air_data_errors(*task.options);
  const auto errors = static_cast<Eigen::Index>(result.index.size());
  const Eigen::Index n = errors + 3;
  constexpr double kIntensityPrior = 0.3;
  const std::array<double, 5> priors = air_data_error_priors();
  const std::vector<double> no_output;
  const auto prior_of = [&](Eigen::Index i) {
    return priors[static_cast<std::size_t>(result.index[static_cast<std::size_t>(i)])];
  };

  const auto scaled = [&](const Eigen::VectorXd& theta) {
    DrydenSettings spectrum = base.model.spectrum;
    spectrum.sigma_u *= std::exp(kIntensityPrior * theta(errors));
    spectrum.sigma_v *= std::exp(kIntensityPrior * theta(errors + 1));
    spectrum.sigma_w *= std::exp(kIntensityPrior * theta(errors + 2));
    return spectrum;
  };

  struct Derivatives {
    double log_posterior = 0.0;
    Eigen::VectorXd gradient;
    Eigen::MatrixXd information;
  };
  // In units of the priors.
  const auto evaluate = [&](const Eigen::VectorXd& theta, double gate) {
    constexpr double kStep = 1e-3;
    ReconstructOptions options = *task.options;
    options.gate.threshold = gate;
    Derivatives d{.gradient = -theta, .information = Eigen::MatrixXd::Identity(n, n)};
    d.log_posterior = -0.5 * theta.squaredNorm();
    std::vector<RunSetting<Model>> settings(static_cast<std::size_t>(n) + 1, base);
    for (std::size_t k = 0; k < settings.size(); ++k) {
      settings[k].options = &options;
      settings[k].output_t = &no_output;
      settings[k].air_error.setZero();
      Eigen::VectorXd at = theta;
      if (k > 0) at(static_cast<Eigen::Index>(k) - 1) += kStep;
      for (Eigen::Index i = 0; i < errors; ++i) {
        settings[k].air_error(result.index[static_cast<std::size_t>(i)]) = at(i) * prior_of(i);
      }
      settings[k].model.spectrum = scaled(at);
    }
    Eigen::VectorXd nu(n), S(n);
    for (const Segment& segment : task.segments) {
      std::vector<FlightRun<Model>> runs;
      runs.reserve(settings.size());
      for (const auto& setting : settings) {
        runs.emplace_back(setting, segment, start_of(setting, segment), monitors_with(options.gate), 0);
        runs.back().keep_innovations();
      }
      while (runs[0].advance(nullptr)) {
        for (std::size_t k = 1; k < runs.size(); ++k) static_cast<void>(runs[k].advance(nullptr));
        for (std::size_t m = 0; m < runs[0].innovations().size(); ++m) {
          const estimation::Innovation& at = runs[0].innovations()[m];
          bool usable = at.accepted;
          for (std::size_t k = 1; k < runs.size() && usable; ++k) {
            const estimation::Innovation& moved = runs[k].innovations()[m];
            usable = moved.accepted;
            nu(static_cast<Eigen::Index>(k) - 1) = (moved.nu - at.nu) / kStep;
            S(static_cast<Eigen::Index>(k) - 1) = (moved.S - at.S) / kStep;
          }
          if (!usable) {
            // What the gate refuses counts as an innovation on the gate, so that refusing does not pay.
            d.log_posterior -= 0.5 * (gate * gate + std::log(at.S));
            continue;
          }
          d.log_posterior -= 0.5 * (at.nis() + std::log(at.S));
          d.gradient += nu * (-at.nu / at.S) + S * (0.5 * (at.nis() - 1.0) / at.S);
          d.information.noalias() += nu * nu.transpose() / at.S + S * S.transpose() * (0.5 / (at.S * at.S));
        }
      }
    }
    return d;
  };

  // A wide gate first: what an uncorrected sensor shows is not an outlier.
  constexpr double kWide = 20.0;
  constexpr int kMaxIterations = 15;
  double gate = std::max(kWide, task.options->gate.threshold);
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(n);
  Derivatives now = evaluate(theta, gate);
  result.converged = false;
  for (int i = 0; i < kMaxIterations; ++i) {
    ++result.iterations;
    const Eigen::VectorXd step = now.information.ldlt().solve(now.gradient);
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
    Derivatives there = evaluate(tried, gate);
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
    scale(i) = prior_of(i);
    result.value(result.index[static_cast<std::size_t>(i)]) = theta(i) * scale(i);
  }
  result.covariance = scale.asDiagonal() * now.information.inverse().topLeftCorner(errors, errors) * scale.asDiagonal();
  result.spectrum = scaled(theta);
  return result;
}

}  // namespace veridyn::aircraft::internal
