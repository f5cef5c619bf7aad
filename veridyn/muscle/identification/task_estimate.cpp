#include "veridyn/muscle/identification/task_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/quiet_progress.hpp"
#include "veridyn/estimation/judgement/limits.hpp"
#include "veridyn/estimation/output_error/correlated_noise_model.hpp"
#include "veridyn/muscle/identification/null_directions.hpp"
#include "veridyn/muscle/identification/task_residuals.hpp"
#include "veridyn/muscle/identification/task_segments.hpp"
#include "veridyn/numerics/sensitivity_indices.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::muscle {
namespace {

using estimation::OutputErrorEstimate;
using estimation::OutputErrorOptions;
using estimation::ParameterStatus;
using estimation::RowMatrix;

/// Of a coarse fit: rounds at most, steps of each, by how much the noise that is assumed falls from one to the next at
/// least, and the share of the residual's size that a round has to leave to be the last where the noise is not known.
constexpr int kCoarseSteps = 8, kCoarseRounds = 12;
constexpr double kCoarseFall = 0.3, kCoarseRests = 0.7;
/// Change of the parameters in standard deviations from which a search goes on.
constexpr double kFineTolerance = 0.2;
/// Difference of two negative log posteriors up to which fits are as good: at least this, and that of the region that
/// holds all parameters together with 95 %.
constexpr double kAsGood = 6.0;
/// Correlation of neighbouring residuals from which error bars are corrected for it.
constexpr double kCorrelated = 0.15;
/// Mean square of the residual in units of the noise from which it is not the noise's, whatever its correlation; and
/// twice the gain of the log likelihood by which noise of first order has to be likelier than white (5 % by chance).
constexpr double kOfStatedSize = 1.5, kLikelierByChance = 3.84;

/// Where the first searches leave what is not noise: searches and points of the screening in all, in units of theirs,
/// and by how many standard deviations of chance chi-square has to exceed its mean (a search in vain costs time only).
constexpr int kFurtherStarts = 3, kFurtherScreened = 8;
constexpr double kWorthASearch_sigma = 2.0;

/// View of one estimation.
class TaskEstimation {
 public:
  TaskEstimation(const estimation::ParametricModel& model, const std::vector<RowMatrix>& measured,
                 const Eigen::VectorXd& noise, const TaskEstimateOptions& options, Progress& progress)
      : model_(model), measured_(measured), noise_(noise), options_(options), progress_(progress) {
    for (const RowMatrix& z : measured) values_ += (z.array() == z.array()).count();
  }

  TaskEstimate run() {
    const auto begun = std::chrono::steady_clock::now();
    search();
    if (result_.usable() && options_.correlated_noise && noise_.size() > 0) allow_for_correlated_noise();
    if (result_.usable()) describe();
    result_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    return std::move(result_);
  }

  TaskEstimate describe_at(const Eigen::VectorXd& theta, TaskSearch search) {
    search.rms_start = residual(standard_values());
    search.agrees = true;
    OutputErrorOptions o = options_of(theta);
    if (noise_.size() > 0) {
      o.noise = estimation::OutputNoise::kGiven;
      o.noise_start = noise_;
    }
    o.max_relaxations = 1;
    o.max_steps = 0;
    result_.best = estimation::output_error(model_, measured_, o, quiet_);
    search.cost = result_.usable() ? cost(result_.best) : kNaN;
    if (result_.usable()) describe();
    result_.searches = {std::move(search)};
    return std::move(result_);
  }

 private:
  /// Root mean square of the residual, each output in units of its noise (or of its own size); NaN: diverged.
  [[nodiscard]] double residual(const Eigen::VectorXd& theta) {
    result_.simulations.values += model_.segments();
    const std::vector<RowMatrix> y = simulate_tasks(model_, theta, progress_.threads());
    double sum = 0.0;
    for (std::size_t s = 0; s < y.size(); ++s) {
      if (y[s].size() == 0) return kNaN;
      for (Eigen::Index k = 0; k < y[s].rows(); ++k) {
        for (Eigen::Index j = 0; j < y[s].cols(); ++j) {
          const double e = (y[s](k, j) - measured_[s](k, j)) / scale()(j);
          if (!std::isnan(e)) sum += e * e;
        }
      }
    }
    return std::sqrt(sum / static_cast<double>(values_));
  }

  [[nodiscard]] OutputErrorEstimate fitted(const OutputErrorOptions& options, Progress& progress) {
    OutputErrorEstimate e = estimation::output_error(model_, measured_, options, progress);
    result_.simulations += e.simulations;
    return e;
  }

  [[nodiscard]] Eigen::VectorXd scale() const {
    return noise_.size() > 0 ? noise_ : Eigen::VectorXd::Constant(model_.outputs().size(), 1.0);
  }

  [[nodiscard]] Eigen::VectorXd standard_values() const {
    Eigen::VectorXd start(model_.parameters().size());
    for (Eigen::Index i = 0; i < start.size(); ++i) start(i) = model_.parameters()[i].start;
    return start;
  }

  using StartingPoints = std::vector<std::pair<double, Eigen::VectorXd>>;

  /// The best fits, `wanted` of them, of the points `from` to `to` of the screening; all that can be simulated.
  StartingPoints screened_points(int from, int to, int wanted) {
    StartingPoints points;
    const Eigen::VectorXd start = standard_values();
    const Eigen::MatrixXd sobol = numerics::sobol_points(static_cast<std::size_t>(to), at(start.size()), options_.seed);
    for (Eigen::Index k = from; k < sobol.rows() && !progress_.interrupted(); ++k) {
      Eigen::VectorXd theta = start;
      for (Eigen::Index i = 0; i < start.size(); ++i) {
        const estimation::ModelParameter& p = model_.parameters()[i];
        if (!p.fixed) theta(i) = p.low + sobol(k, i) * (p.high - p.low);
      }
      const double fit = residual(theta);
      if (std::isfinite(fit)) points.emplace_back(fit, theta);
    }
    std::stable_sort(points.begin(), points.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
    if (points.size() > at(wanted)) points.resize(at(wanted));
    return points;
  }

  [[nodiscard]] OutputErrorOptions options_of(const Eigen::VectorXd& from) const {
    OutputErrorOptions o;
    o.free_initial_conditions = !model_.initial_conditions(0).empty() && !model_.initial_conditions(0).front().fixed;
    o.search_start = from;
    return o;
  }

  /// A coarse fit from there; where it ends. The noise is first taken to be as large as the residual and then smaller
  /// and smaller: priors hold what the tasks hardly determine until the rest is settled. With small noise at once the
  /// search runs along its valleys to the bounds and ends in minima there, or in none: in 9 of 40 fits of 18 unknowns
  /// that began at the model's values, against one.
  Eigen::VectorXd coarse(Eigen::VectorXd from, double rms, TaskSearch& search) {
    double level = kInfinity;
    for (int round = 0; round < kCoarseRounds && !progress_.interrupted(); ++round) {
      level = std::min(rms, kCoarseFall * level);
      if (!(level > 1.0) && noise_.size() > 0) break;
      OutputErrorOptions o = options_of(from);
      o.noise = estimation::OutputNoise::kGiven;
      o.noise_start = level * scale();
      o.max_steps = kCoarseSteps;
      o.max_relaxations = 1;
      o.tolerance = kFineTolerance;
      const OutputErrorEstimate e = fitted(o, quiet_);
      search.steps += e.steps;
      if (!e.usable()) break;
      from = e.theta;
      const double now = residual(from);
      if (!(now < kCoarseRests * rms) && noise_.size() == 0) break;
      rms = now;
    }
    return from;
  }

  /// The fit with the noise as it is; `once`: without a second round, enough to see where a search ends.
  OutputErrorEstimate fine(const Eigen::VectorXd& from, bool once) {
    OutputErrorOptions o = options_of(from);
    o.tolerance = kFineTolerance;
    if (noise_.size() > 0) {
      o.noise = estimation::OutputNoise::kGiven;
      o.noise_start = noise_;
      o.max_relaxations = once ? 1 : 3;
    }
    return fitted(o, quiet_);
  }

  /// Negative logarithm of likelihood and prior.
  [[nodiscard]] double cost(const OutputErrorEstimate& e) const {
    double sum = e.negative_log_likelihood;
    for (std::size_t i = 0; i < model_.parameters().size(); ++i) {
      const estimation::ModelParameter& p = model_.parameters()[i];
      if (!p.fixed && std::isfinite(p.prior_sigma)) sum += 0.5 * std::pow((e.theta(i) - p.start) / p.prior_sigma, 2);
    }
    return sum;
  }

  void search() {
    const Eigen::VectorXd start = options_.first.size() > 0 ? options_.first : standard_values();
    StartingPoints points{{residual(start), start}};
    if (options_.starts > 1) {
      for (auto& point : screened_points(0, options_.screened, options_.starts - 1)) points.push_back(std::move(point));
    }
    search_from(points);
    // A minimum that leaves motion unexplained may be one of several.
    if (options_.starts > 1 && options_.search_further && result_.usable() && !explained()) {
      search_from(
          screened_points(options_.screened, kFurtherScreened * options_.screened, kFurtherStarts * options_.starts));
    }
    if (!result_.usable()) return;
    const double best = result_.searches[result_.chosen].cost;
    for (std::size_t i = 0; i < finished_.size(); ++i) {
      TaskSearch& s = result_.searches[i];
      if (!finished_[i] || !finished_[i]->usable()) {
        if (s.message.empty()) s.message = "left after the coarse fit: others were better";
        continue;
      }
      s.agrees = same_place(*finished_[i]);
      if (s.agrees || !(s.cost - best < as_good())) continue;
      result_.ambiguous = true;
      rivals_.push_back(finished_[i]->theta);
    }
  }

  /// Parameters that are not fixed.
  [[nodiscard]] double unknowns() const {
    double n = 0.0;
    for (const estimation::ModelParameter& p : model_.parameters()) n += p.fixed ? 0.0 : 1.0;
    return n;
  }

  /// Half the 95 % quantile of chi-square with as many degrees of freedom as parameters.
  [[nodiscard]] double as_good() const {
    const double n = unknowns();
    return n > 0.0 ? std::max(kAsGood, 0.5 * numerics::chi_square_quantile(0.95, n)) : kAsGood;
  }

  /// Whether the best fit leaves no more than the noise; where that is not known, nothing that looks like motion.
  [[nodiscard]] bool explained() const {
    const std::vector<RowMatrix> e = residuals();
    if (noise_.size() == 0)
      return lag1_of(e) < estimation::kAutocorrelatedFrom || share_of_motion(e, measured_) < kIntegrationShare;
    const double freedom = std::max(1.0, static_cast<double>(values_) - unknowns());
    return squares_of(e, scale()) / freedom < 1.0 + kWorthASearch_sigma * std::sqrt(2.0 / freedom);
  }

  /// Searches from some points coarsely, finishes the best two, and keeps the best of all searches so far.
  void search_from(const StartingPoints& points) {
    const std::size_t first = result_.searches.size();
    std::vector<Eigen::VectorXd> ends(points.size());
    std::vector<double> rms(points.size(), kInfinity);
    result_.searches.resize(first + points.size());
    finished_.resize(result_.searches.size());
    const double steps = static_cast<double>(points.size() + 2);
    for (std::size_t i = 0; i < points.size(); ++i) {
      TaskSearch& s = result_.searches[first + i];
      s.rms_start = points[i].first;
      s.cost = kNaN;
      if (!std::isfinite(s.rms_start)) {
        s.message = "the simulation diverges where it begins";
        continue;
      }
      ends[i] = coarse(points[i].second, points[i].first, s);
      const double end = residual(ends[i]);
      if (std::isfinite(end)) rms[i] = end;
      if (!progress_.update(static_cast<double>(i + 1) / steps)) break;
    }
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return rms[a] < rms[b]; });
    for (std::size_t k = 0; k < std::min<std::size_t>(2, order.size()); ++k) {
      const std::size_t i = order[k];
      if (!std::isfinite(rms[i]) || progress_.interrupted()) continue;
      std::optional<OutputErrorEstimate>& fit = finished_[first + i];
      fit = fine(ends[i], k > 0);
      TaskSearch& s = result_.searches[first + i];
      s.steps += fit->steps;
      s.message = fit->message;
      if (!fit->usable()) continue;
      s.cost = cost(*fit);
      if (!result_.usable() || s.cost < result_.searches[result_.chosen].cost) {
        result_.best = *fit;
        result_.chosen = first + i;
      }
      if (!progress_.update(static_cast<double>(points.size() + k + 1) / steps)) break;
    }
    if (!result_.usable()) result_.best = why_nothing(first + (order.empty() ? 0 : order.front()));
  }

  /// Fits again with noise of first order until its correlation rests.
  void allow_for_correlated_noise() {
    constexpr int kCorrelatedRounds = 3;
    constexpr double kCorrelationRests = 0.02;
    const double rms = residual(result_.best.theta);
    if (!(rms * rms < kOfStatedSize)) return;
    for (int round = 0; round < kCorrelatedRounds && !progress_.interrupted(); ++round) {
      const auto found = estimation::noise_correlation(model_, measured_, result_.best, noise_, progress_.threads());
      result_.simulations.with_derivatives += model_.segments();
      if (!found || (round == 0 && !(found->gain > kLikelierByChance))) return;
      const Eigen::VectorXd& before = result_.noise_correlation;
      if (round > 0 && (found->correlation - before).cwiseAbs().maxCoeff() < kCorrelationRests) return;
      const estimation::CorrelatedNoiseModel white(model_, measured_, found->correlation);
      OutputErrorOptions o = options_of(result_.best.theta);
      // Each round goes on where the one before stopped.
      o.tolerance = 0.5;
      o.noise = estimation::OutputNoise::kGiven;
      o.noise_start = noise_;
      o.max_relaxations = 1;
      OutputErrorEstimate e = estimation::output_error(white, white.whitened(measured_), o, quiet_);
      result_.simulations += e.simulations;
      if (!e.usable()) return;
      for (std::size_t s = 0; s < e.predicted.size(); ++s) e.predicted[s] = white.restored(s, e.predicted[s]);
      result_.searches[result_.chosen].steps += e.steps;
      result_.best = std::move(e);
      result_.noise_correlation = found->correlation;
    }
  }

  [[nodiscard]] OutputErrorEstimate why_nothing(std::size_t first) {
    if (first < finished_.size() && finished_[first]) return *finished_[first];
    OutputErrorOptions o = options_of(standard_values());
    if (noise_.size() > 0) o.noise_start = noise_;
    o.max_relaxations = 1;
    o.max_steps = 1;
    Progress silent;
    return fitted(o, silent);
  }

  [[nodiscard]] bool same_place(const OutputErrorEstimate& e) const {
    for (std::size_t i = 0; i < model_.parameters().size(); ++i) {
      const double sigma = result_.best.parameters[i].sigma;
      if (std::abs(e.theta(i) - result_.best.theta(i)) > std::max(sigma, 1e-12)) return false;
    }
    return true;
  }

  /// Predicted less measured.
  [[nodiscard]] std::vector<RowMatrix> residuals() const {
    std::vector<RowMatrix> e;
    for (std::size_t s = 0; s < measured_.size(); ++s) e.push_back(result_.best.predicted[s] - measured_[s]);
    return e;
  }

  /// Sets what the residual is; returns the correlation of neighbours that is left in it.
  double residual_statistics() {
    std::vector<RowMatrix> e = residuals();
    double left = result_.lag1 = lag1_of(e);
    if (result_.noise_correlation.size() > 0) {
      const estimation::CorrelatedNoiseModel white(model_, measured_, result_.noise_correlation);
      e = white.whitened(e);
      left = lag1_of(e);
    }
    result_.freedom = std::max(1.0, static_cast<double>(values_) - std::max(0.0, result_.learned.sum()));
    result_.chi_square = noise_.size() > 0 ? squares_of(e, scale()) / result_.freedom : kNaN;
    return left;
  }

  void describe() {
    OutputErrorEstimate& e = result_.best;
    const std::size_t n = model_.parameters().size();
    result_.learned = Eigen::VectorXd::Zero(n);
    double squares = 0.0, count = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const estimation::ModelParameter& p = model_.parameters()[i];
      if (p.fixed) continue;
      if (p.start != 0.0) {
        squares += std::pow(e.theta(i) / p.start - 1.0, 2);
        count += 1.0;
      }
      result_.learned(i) = std::clamp(1.0 - std::pow(e.parameters[i].sigma_white / p.prior_sigma, 2), 0.0, 1.0);
    }
    result_.distance = count > 0.0 ? std::sqrt(squares / count) : 0.0;
    const double left = residual_statistics();
    // Correcting white residuals for chance correlations would only add the correction's own error.
    const bool white = left < kCorrelated;
    if (white) e.covariance = e.covariance_white;
    for (std::size_t i = 0; i < n; ++i) {
      estimation::Parameter& p = e.parameters[i];
      if (model_.parameters()[i].fixed) {
        p.status = ParameterStatus::kFixed;
        continue;
      }
      if (white || p.sigma < p.sigma_white) p.sigma = p.sigma_white;
      set_interval(p, std::max(1.0, e.degrees_of_freedom));
      p.status = status_of(i);
    }
    const NullDirections null = null_directions(model_.parameters(), e.covariance_white, 1.0 - kWeakShareOfPrior);
    result_.null_directions = null.texts;
    result_.null_vectors = null.vectors;
  }

  [[nodiscard]] ParameterStatus status_of(std::size_t i) const {
    const estimation::Parameter& p = result_.best.parameters[i];
    if (p.status == ParameterStatus::kAtBound) return p.status;
    const double learned = result_.learned(i);
    if (learned < kWeakShareOfPrior) return ParameterStatus::kNotExcited;
    // What explains the motion as well with a value outside the interval does not leave the interval known.
    const bool rivalled = std::ranges::any_of(
        rivals_, [&](const Eigen::VectorXd& rival) { return !(rival(i) >= p.low95 && rival(i) <= p.high95); });
    if (rivalled) return ParameterStatus::kNotExcited;
    return learned >= kIdentifiedShare ? ParameterStatus::kIdentified : ParameterStatus::kWeak;
  }

  const estimation::ParametricModel& model_;
  const std::vector<RowMatrix>& measured_;
  const Eigen::VectorXd& noise_;
  const TaskEstimateOptions& options_;
  Progress& progress_;
  QuietProgress quiet_{progress_, progress_.threads()};  ///< of searches within a stage
  Eigen::Index values_ = 0;
  std::vector<std::optional<OutputErrorEstimate>> finished_;  ///< by search
  std::vector<Eigen::VectorXd> rivals_;                       ///< where other searches ended with as good a fit
  TaskEstimate result_;
};

}  // namespace

void TaskEstimateOptions::validate() const {
  if (starts < 1 || starts > 1000)
    throw InputError("identify.starts", fmt::format("is {}; must be from 1 to 1000", starts));
  if (screened < starts || screened > 100000)
    throw InputError("identify.screened", fmt::format("is {}; must be from starts = {} to 100000", screened, starts));
}

std::vector<MuscleUnknown> with_bound_priors(std::vector<MuscleUnknown> unknowns) {
  for (MuscleUnknown& u : unknowns)
    if (!std::isfinite(u.prior_sigma)) u.prior_sigma = (u.high - u.low) / std::sqrt(12.0);
  return unknowns;
}

TaskEstimate estimate_from_tasks(const estimation::ParametricModel& model, const std::vector<RowMatrix>& measured,
                                 const Eigen::VectorXd& noise, const TaskEstimateOptions& options, Progress& progress) {
  options.validate();
  return TaskEstimation(model, measured, noise, options, progress).run();
}

TaskEstimate describe_estimate(const estimation::ParametricModel& model, const std::vector<RowMatrix>& measured,
                               const Eigen::VectorXd& noise, const Eigen::VectorXd& theta, TaskSearch search,
                               Progress& progress) {
  const TaskEstimateOptions options;
  return TaskEstimation(model, measured, noise, options, progress).describe_at(theta, std::move(search));
}

}  // namespace veridyn::muscle
