#include "veridyn/estimation/uncertainty/ensemble_sampler.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"
#include "veridyn/numerics/random.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::estimation {
namespace {

using Eigen::Index;

constexpr double kTailDegrees = 10.0;  // of the t distribution
constexpr double kStretch = 2.0;
constexpr std::size_t kFirstLook = 50;  // steps; then whenever the chain is a fifth longer
constexpr double kLongEnough = 20.0;    // chain length in autocorrelation times
constexpr double kWindow = 5.0;         // Sokal's: lags up to five autocorrelation times

/// A move of one walker: where to, and the logarithm of what the acceptance owes to the proposal.
struct Move {
  Eigen::VectorXd to;
  double log_ratio = 0.0;
};

/// Proposals.
class Moves {
 public:
  Moves(const std::optional<NormalApproximation>& near, Index dimensions) : dimensions_(dimensions) {
    if (!near) return;
    mean_ = near->mean;
    cholesky_.emplace(near->covariance);
    if (!cholesky_->positive_definite()) throw InputError("near", "its covariance is not positive definite");
  }

  /// Of a walker, by the half that rests: rows first to first + count.
  [[nodiscard]] Move propose(const Eigen::MatrixXd& walkers, Index walker, Index first, Index count,
                             numerics::RandomStream& random) const {
    // Half as many stretches as differences where there is nothing to draw independently from.
    const double independent_below = cholesky_ ? 0.4 : 0.0, difference_below = cholesky_ ? 0.85 : 0.67;
    const double kind = random.uniform();
    const Eigen::VectorXd x = walkers.row(walker).transpose();
    if (kind < independent_below) return independent(x, random);
    if (kind < difference_below) return difference(x, walkers, first, count, random);
    return stretched(x, walkers, first, count, random);
  }

 private:
  [[nodiscard]] double distance(const Eigen::VectorXd& x) const {
    return Eigen::VectorXd(cholesky_->solve_lower(Eigen::MatrixXd(x - mean_))).squaredNorm();
  }

  [[nodiscard]] Move independent(const Eigen::VectorXd& x, numerics::RandomStream& random) const {
    Eigen::VectorXd z(dimensions_);
    for (Index i = 0; i < dimensions_; ++i) z(i) = random.normal();
    double chi = 0.0;
    for (int i = 0; i < static_cast<int>(kTailDegrees); ++i) chi += std::pow(random.normal(), 2);
    const double scale = std::sqrt(kTailDegrees / chi);
    Move move{.to = mean_ + scale * (cholesky_->L() * z)};
    const double power = 0.5 * (kTailDegrees + static_cast<double>(dimensions_));
    const auto log_proposal = [&](double squared) { return -power * std::log1p(squared / kTailDegrees); };
    move.log_ratio = log_proposal(distance(x)) - log_proposal(scale * scale * z.squaredNorm());
    return move;
  }

  [[nodiscard]] Move difference(const Eigen::VectorXd& x, const Eigen::MatrixXd& walkers, Index first, Index count,
                                numerics::RandomStream& random) const {
    const auto a = static_cast<Index>(random.index(static_cast<std::uint64_t>(count)));
    auto b = static_cast<Index>(random.index(static_cast<std::uint64_t>(count - 1)));
    if (b >= a) ++b;
    const double usual = 2.38 / std::sqrt(2.0 * static_cast<double>(dimensions_));
    // Now and then a whole difference: from one mode to another.
    const double gamma = random.uniform() < 0.1 ? 1.0 : usual * (1.0 + 0.1 * random.normal());
    return {.to = x + gamma * (walkers.row(first + a) - walkers.row(first + b)).transpose()};
  }

  [[nodiscard]] Move stretched(const Eigen::VectorXd& x, const Eigen::MatrixXd& walkers, Index first, Index count,
                               numerics::RandomStream& random) const {
    const Eigen::VectorXd pivot =
        walkers.row(first + static_cast<Index>(random.index(static_cast<std::uint64_t>(count)))).transpose();
    const double z = std::pow((kStretch - 1.0) * random.uniform() + 1.0, 2) / kStretch;
    return {.to = pivot + z * (x - pivot), .log_ratio = static_cast<double>(dimensions_ - 1) * std::log(z)};
  }

  Index dimensions_;
  Eigen::VectorXd mean_;
  std::optional<numerics::Cholesky> cholesky_;
};

/// Integrated autocorrelation time of one coordinate [steps]: autocorrelations of each walker, averaged over walkers.
double autocorrelation_time(const Eigen::MatrixXd& draws, Index walkers, Index coordinate) {
  const Index steps = draws.rows() / walkers;
  const double mean = draws.col(coordinate).mean();
  const auto lagged = [&](Index lag) {
    double sum = 0.0;
    for (Index k = lag; k < steps; ++k)
      for (Index w = 0; w < walkers; ++w)
        sum += (draws(k * walkers + w, coordinate) - mean) * (draws((k - lag) * walkers + w, coordinate) - mean);
    return sum / static_cast<double>((steps - lag) * walkers);
  };
  const double variance = lagged(0);
  if (!(variance > 0.0)) return kNaN;
  double time = 1.0;
  for (Index lag = 1; lag < steps / 2; ++lag) {
    time += 2.0 * lagged(lag) / variance;
    if (static_cast<double>(lag) >= kWindow * time) break;
  }
  return std::max(1.0, time);
}

/// View of one sampling.
class Ensemble {
 public:
  Ensemble(const LogDensities& densities, const Eigen::MatrixXd& start, const std::optional<NormalApproximation>& near,
           const EnsembleOptions& options, Progress& progress)
      : densities_(densities),
        options_(options),
        progress_(progress),
        moves_(near, start.cols()),
        walkers_(start),
        log_density_(start.rows()) {}

  EnsembleSample run() {
    std::vector<Eigen::VectorXd> points;
    for (Index w = 0; w < walkers_.rows(); ++w) points.emplace_back(walkers_.row(w).transpose());
    densities_(points, std::span(log_density_.data(), points.size()));
    for (Index w = 0; w < walkers_.rows(); ++w)
      if (!std::isfinite(log_density_(w)))
        throw InputError("start", fmt::format("walker {} starts where the density is zero", w + 1));
    std::size_t step = 0;
    while (step < options_.steps && !sample_.converged) {
      advance(step, 0);
      advance(step, walkers_.rows() / 2);
      keep(step++);
      if (step >= next_look_) {
        look(step);
        next_look_ = step + std::max(kFirstLook, step / 5);
      }
      if (!progress_.update(progress_made(step))) {
        sample_.interrupted = true;
        break;
      }
    }
    if (sample_.steps != step) look(step);
    sample_.acceptance = static_cast<double>(accepted_) / static_cast<double>(std::max<std::size_t>(1, tried_));
    sample_.walkers = at(walkers_.rows());
    sample_.message = fmt::format(
        "{} walkers, {} steps, the first {} of them left out: {:.0f} independent draws ({:.0f} % of the moves "
        "accepted)",
        sample_.walkers, sample_.steps, sample_.warm_up, sample_.effective, 100.0 * sample_.acceptance);
    if (!sample_.converged)
      sample_.message += fmt::format("; that is too few: {} were wanted, of a chain of {:g} autocorrelation times",
                                     options_.effective, kLongEnough);
    return std::move(sample_);
  }

 private:
  /// Moves the half that begins with walker `first`.
  void advance(std::size_t step, Index first) {
    const Index half = walkers_.rows() / 2, other = first == 0 ? half : 0;
    std::vector<numerics::RandomStream> random;
    std::vector<Eigen::VectorXd> to;
    std::vector<double> log_ratio, reached(at(half));
    for (Index w = first; w < first + half; ++w) {
      random.emplace_back(options_.seed, static_cast<std::uint64_t>(step) * 1000003u + static_cast<std::uint64_t>(w));
      Move move = moves_.propose(walkers_, w, other, half, random.back());
      to.push_back(std::move(move.to));
      log_ratio.push_back(move.log_ratio);
    }
    densities_(to, reached);
    for (std::size_t i = 0; i < at(half); ++i) {
      const Index w = first + signed_index(i);
      ++tried_;
      const double gain = reached[i] - log_density_(w) + log_ratio[i];
      if (!(std::log(1.0 - random[i].uniform()) < gain) || !std::isfinite(reached[i])) continue;
      ++accepted_;
      walkers_.row(w) = to[i].transpose();
      log_density_(w) = reached[i];
    }
  }

  void keep(std::size_t step) {
    const Index row = signed_index(step) * walkers_.rows();
    if (row + walkers_.rows() > all_.rows()) {
      const Index rows = std::max<Index>(2 * all_.rows(), signed_index(kFirstLook) * walkers_.rows());
      all_.conservativeResize(rows, walkers_.cols());
      all_log_density_.conservativeResize(rows);
    }
    all_.middleRows(row, walkers_.rows()) = walkers_;
    all_log_density_.segment(row, walkers_.rows()) = log_density_;
  }

  /// Takes what follows the warm-up and says how many independent draws that is.
  void look(std::size_t step) {
    const Index walkers = walkers_.rows();
    sample_.steps = step;
    sample_.warm_up = step / 4;
    const Index from = signed_index(sample_.warm_up) * walkers, rows = signed_index(step) * walkers - from;
    sample_.draws = all_.middleRows(from, rows);
    sample_.log_density = all_log_density_.segment(from, rows);
    sample_.autocorrelation_steps = Eigen::VectorXd::Constant(walkers_.cols(), kNaN);
    sample_.effective = 0.0;
    if (rows < 4 * walkers) return;
    for (Index i = 0; i < walkers_.cols(); ++i)
      sample_.autocorrelation_steps(i) = autocorrelation_time(sample_.draws, walkers, i);
    if (!sample_.autocorrelation_steps.allFinite()) return;
    const double slowest = sample_.autocorrelation_steps.maxCoeff();
    sample_.effective = static_cast<double>(rows) / slowest;
    sample_.converged = sample_.effective >= static_cast<double>(options_.effective) &&
                        static_cast<double>(step - sample_.warm_up) >= kLongEnough * slowest;
  }

  [[nodiscard]] double progress_made(std::size_t step) const {
    const double by_steps = static_cast<double>(step) / static_cast<double>(options_.steps);
    return std::min(1.0, std::max(by_steps, sample_.effective / static_cast<double>(options_.effective)));
  }

  const LogDensities& densities_;
  const EnsembleOptions& options_;
  Progress& progress_;
  Moves moves_;
  Eigen::MatrixXd walkers_;
  Eigen::VectorXd log_density_;
  Eigen::MatrixXd all_;
  Eigen::VectorXd all_log_density_;
  std::size_t tried_ = 0, accepted_ = 0, next_look_ = kFirstLook;
  EnsembleSample sample_;
};

std::size_t walkers_of(const EnsembleOptions& options, std::size_t dimensions) {
  return options.walkers > 0 ? options.walkers : std::max<std::size_t>(32, 2 * dimensions + 2);
}

}  // namespace

void EnsembleOptions::validate(std::size_t dimensions) const {
  const std::size_t count = walkers_of(*this, dimensions);
  if (count % 2 != 0 || count < 2 * dimensions || count < 6)
    throw InputError("walkers",
                     fmt::format("= {} must be even, and at least 6 and twice the {} unknowns", count, dimensions));
  if (steps < 20 || steps > 10'000'000)
    throw InputError("steps", fmt::format("= {} must be from 20 to 10000000", steps));
  if (effective < 1) throw InputError("effective", "= 0 must be at least 1");
}

EnsembleSample sample_ensemble(const LogDensities& densities, const Eigen::MatrixXd& start,
                               const std::optional<NormalApproximation>& near, const EnsembleOptions& options,
                               Progress& progress) {
  options.validate(at(start.cols()));
  if (at(start.rows()) != walkers_of(options, at(start.cols())))
    throw InputError("start", fmt::format("has {} walkers; the options say {}", start.rows(),
                                          walkers_of(options, at(start.cols()))));
  return Ensemble(densities, start, near, options, progress).run();
}

Eigen::MatrixXd ensemble_start(const LogDensity& density, const NormalApproximation& near,
                               const EnsembleOptions& options) {
  const auto n = near.mean.size();
  options.validate(at(n));
  if (!std::isfinite(density(near.mean))) throw InputError("start", "the density is zero where the search ended");
  const numerics::Cholesky cholesky(near.covariance);
  if (!cholesky.positive_definite()) throw InputError("near", "its covariance is not positive definite");
  Eigen::MatrixXd walkers(walkers_of(options, at(n)), n);
  for (Index w = 0; w < walkers.rows(); ++w) {
    numerics::RandomStream random(options.seed, fmt::format("walker {}", w));
    Eigen::VectorXd z(n);
    for (Index i = 0; i < n; ++i) z(i) = random.normal();
    Eigen::VectorXd step = cholesky.L() * z;
    while (!std::isfinite(density(near.mean + step))) step *= 0.7;
    walkers.row(w) = (near.mean + step).transpose();
  }
  return walkers;
}

}  // namespace veridyn::estimation
