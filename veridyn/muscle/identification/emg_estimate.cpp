#include "veridyn/muscle/identification/emg_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/muscle/identification/task_segments.hpp"

namespace veridyn::muscle {
namespace {

using estimation::RowMatrix;

/// Covariances are computed this often at most, and until no parameter moves by this share of its error.
constexpr int kMostRounds = 4;
constexpr double kAtRest = 0.1;

/// View of one estimation.
class EmgEstimation {
 public:
  EmgEstimation(const EmgDrivenModel& model, const estimation::ParametricModel& responses,
                const std::vector<RowMatrix>& measured, const Eigen::VectorXd& noise, const EmgError& error,
                TaskEstimateOptions options, Progress& progress)
      : model_(model),
        responses_(responses),
        measured_(measured),
        given_(noise),
        error_(error),
        options_(std::move(options)),
        progress_(progress) {
    // That of the residual is the EMG's error's, which the covariance holds already.
    options_.correlated_noise = false;
    // The noise is found on the way.
    options_.search_further = false;
  }

  EmgEstimate run() {
    const auto parameters = model_.parameters();
    Eigen::VectorXd theta(parameters.size());
    for (std::size_t i = 0; i < parameters.size(); ++i) theta(i) = parameters[i].start;
    TaskEstimate first;
    double seconds = 0.0;
    for (int round = 0; round < kMostRounds && !progress_.interrupted(); ++round) {
      if (!set_units(theta)) break;
      const Eigen::VectorXd one = Eigen::VectorXd::Ones(model_.outputs().size());
      result_.estimate = estimate_from_tasks(*result_.model, result_.measured, one, options_, progress_);
      seconds += result_.estimate.seconds;
      if (!result_.estimate.usable()) break;
      if (round == 0) first = result_.estimate;
      const bool rests = round > 0 && moved(theta) < kAtRest;
      theta = result_.estimate.best.theta;
      // Where other searches end has been seen; further rounds go on from the best.
      options_.starts = 1;
      options_.first = theta;
      if (rests) break;
    }
    if (result_.estimate.usable()) {
      result_.estimate.searches = std::move(first.searches);
      result_.estimate.chosen = first.chosen;
      result_.estimate.ambiguous = first.ambiguous;
    }
    result_.estimate.seconds = seconds;
    return std::move(result_);
  }

 private:
  /// The whitened model with the covariance that the residuals have at `theta`.
  bool set_units(const Eigen::VectorXd& theta) {
    std::vector<RowMatrix> response(measured_.size()), residual(measured_.size());
    std::vector<char> good(measured_.size(), 0);
    estimation::for_each_segment(responses_, progress_.threads(), [&](std::size_t s) {
      estimation::ModelResponse now;
      good[s] = model_.error_response(s, theta, error_, response[s]) && responses_.respond(s, theta, {}, now) ? 1 : 0;
      if (good[s] != 0) residual[s] = measured_[s] - now.output;
    });
    if (std::count(good.begin(), good.end(), 0) > 0) return false;
    result_.noise =
        given_.size() > 0 ? given_ : estimation::noise_beside_input_errors(residual, response, rms(residual));
    std::vector<estimation::ErrorWhitening> whitening;
    result_.input_share.clear();
    for (std::size_t s = 0; s < measured_.size(); ++s) {
      whitening.emplace_back(response[s], result_.noise, measured_[s]);
      result_.input_share.push_back(whitening.back().input_share());
    }
    result_.model = std::make_unique<estimation::InputErrorModel>(responses_, std::move(whitening));
    result_.measured.clear();
    for (std::size_t s = 0; s < measured_.size(); ++s)
      result_.measured.push_back(result_.model->whitened(s, measured_[s]));
    return true;
  }

  /// Of each output's residuals; the start of the search for their noise.
  static Eigen::VectorXd rms(const std::vector<RowMatrix>& residual) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(residual.front().cols()), count = sum;
    for (const RowMatrix& r : residual) {
      for (Eigen::Index k = 0; k < r.rows(); ++k) {
        for (Eigen::Index j = 0; j < r.cols(); ++j) {
          if (std::isnan(r(k, j))) continue;
          sum(j) += r(k, j) * r(k, j);
          count(j) += 1.0;
        }
      }
    }
    for (Eigen::Index j = 0; j < sum.size(); ++j)
      sum(j) = count(j) > 0.0 && sum(j) > 0.0 ? std::sqrt(sum(j) / count(j)) : 1.0;
    return sum;
  }

  [[nodiscard]] double moved(const Eigen::VectorXd& before) const {
    double largest = 0.0;
    for (std::size_t i = 0; i < model_.parameters().size(); ++i) {
      const double sigma = result_.estimate.best.parameters[i].sigma;
      const double change = std::abs(result_.estimate.best.theta(i) - before(i));
      if (sigma > 0.0 && std::isfinite(sigma)) largest = std::max(largest, change / sigma);
    }
    return largest;
  }

  const EmgDrivenModel& model_;
  const estimation::ParametricModel& responses_;
  const std::vector<RowMatrix>& measured_;
  const Eigen::VectorXd& given_;
  const EmgError& error_;
  TaskEstimateOptions options_;
  Progress& progress_;
  EmgEstimate result_;
};

}  // namespace

EmgEstimate estimate_from_emg(const EmgDrivenModel& model, const estimation::ParametricModel& responses,
                              const std::vector<RowMatrix>& measured, const Eigen::VectorXd& noise,
                              const EmgError& error, const TaskEstimateOptions& options, Progress& progress) {
  return EmgEstimation(model, responses, measured, noise, error, options, progress).run();
}

}  // namespace veridyn::muscle
