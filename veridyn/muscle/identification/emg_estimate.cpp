#include "veridyn/muscle/identification/emg_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/estimation/output_error/input_error_sizes.hpp"
#include "veridyn/muscle/identification/task_segments.hpp"

namespace veridyn::muscle {
namespace {

using estimation::RowMatrix;

/// Linearised this often at most, and until no parameter moves by this share of its error nor an error of the EMG by
/// this share of its standard deviation.
constexpr int kMostRounds = 12;
constexpr double kAtRest = 0.1;
/// What is stated of the size of the EMG's error counts as this many errors that were measured: little against the
/// thirty slow ones of half a minute of three electrodes, so that a model that does not fit shows.
constexpr double kStatedAsErrors = 4.0;
/// Of the search for sizes, which goes on from round to round.
constexpr int kSizeIterations = 6;
/// Errors are looked for within so many standard deviations.
constexpr double kMostError = 5.0;

/// View of one estimation.
class EmgEstimation {
 public:
  EmgEstimation(const EmgDrivenModel& model, const estimation::ParametricModel& responses,
                const std::vector<RowMatrix>& measured, const Eigen::VectorXd& noise, TaskEstimateOptions options,
                Progress& progress)
      : model_(model),
        responses_(responses),
        measured_(measured),
        given_(noise),
        options_(std::move(options)),
        progress_(progress) {
    // That of the residual is the EMG's error's, which the covariance holds already.
    options_.correlated_noise = false;
    // The noise is found on the way.
    options_.search_further = false;
    for (std::size_t s = 0; s < model.segments(); ++s) errors_.push_back(Eigen::VectorXd::Zero(model.errors(s)));
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
      const double parameters_moved = moved(theta);
      // Errors and delays go together, and full steps swing about where both rest.
      const double share = round == 0 ? 1.0 : 0.8;
      theta += share * (result_.estimate.best.theta - theta);
      // Where other searches end has been seen; further rounds go on from the best.
      options_.starts = 1;
      options_.first = theta;
      const double errors_moved = round == 0 ? kMostError : update_errors(share);
      if (round > 0 && parameters_moved < kAtRest && errors_moved < kAtRest) break;
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
  [[nodiscard]] Eigen::VectorXd with_errors(const Eigen::VectorXd& theta, std::size_t s) const {
    Eigen::VectorXd all(theta.size() + errors_[s].size());
    all << theta, errors_[s];
    return all;
  }

  /// The whitened model with the covariance that the residuals have at `theta` and the errors so far.
  bool set_units(const Eigen::VectorXd& theta) {
    const std::size_t segments = measured_.size();
    response_.assign(segments, {});
    std::vector<RowMatrix> residual(segments), shift(segments);
    std::vector<char> good(segments, 0);
    estimation::for_each_segment(responses_, progress_.threads(), [&](std::size_t s) {
      estimation::ModelResponse now;
      const Eigen::VectorXd all = with_errors(theta, s);
      good[s] = model_.error_response(s, all, response_[s]) && responses_.respond(s, all, {}, now) ? 1 : 0;
      if (good[s] == 0) return;
      shift[s] = RowMatrix::Zero(now.output.rows(), now.output.cols());
      if (errors_[s].size() > 0)
        Eigen::Map<Eigen::VectorXd>(shift[s].data(), shift[s].size()) = response_[s] * errors_[s];
      residual[s] = measured_[s] - now.output + shift[s];
    });
    if (std::count(good.begin(), good.end(), 0) > 0) return false;
    find_sizes(residual, rms(residual));
    // In standard deviations of what was found.
    for (std::size_t s = 0; s < segments; ++s) response_[s] *= factors_of(s).asDiagonal();
    std::vector<estimation::ErrorWhitening> whitening;
    result_.input_share.clear();
    for (std::size_t s = 0; s < segments; ++s) {
      whitening.emplace_back(response_[s], result_.noise, measured_[s]);
      result_.input_share.push_back(whitening.back().input_share());
    }
    result_.about = std::make_unique<AboutEmgErrors>(responses_, errors_, std::move(shift));
    result_.model = std::make_unique<estimation::InputErrorModel>(*result_.about, whitening);
    result_.measured.clear();
    for (std::size_t s = 0; s < segments; ++s) result_.measured.push_back(result_.model->whitened(s, measured_[s]));
    // Rows that were not measured say nothing of the errors.
    for (std::size_t s = 0; s < segments; ++s) {
      for (Eigen::Index i = 0; i < response_[s].rows(); ++i)
        if (std::isnan(measured_[s].data()[i])) response_[s].row(i).setZero();
      if (response_[s].cols() > 0) whitening[s].apply(response_[s]);
    }
    return true;
  }

  /// By error of a segment's EMG what was found of its size over the one stated.
  [[nodiscard]] Eigen::VectorXd factors_of(std::size_t s) const {
    const std::vector<int> parts = model_.error_parts(s);
    Eigen::VectorXd factors(parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i) factors(i) = result_.error_factors(parts[i]);
    return factors;
  }

  /// How large noise and errors are that leave such residuals. Before the first search they are of other causes.
  void find_sizes(const std::vector<RowMatrix>& residual, const Eigen::VectorXd& start) {
    const bool first = result_.noise.size() == 0;
    if (first) {
      result_.noise = given_.size() > 0 ? given_ : start;
      result_.error_factors = Eigen::VectorXd::Ones(kEmgErrorParts);
    }
    const bool exact = std::ranges::all_of(response_, [](const RowMatrix& H) { return H.cols() == 0; });
    const estimation::InputErrorSizesOptions options{.noise = given_.size() == 0,
                                                     .factors = !first && !exact,
                                                     .prior_errors = kStatedAsErrors,
                                                     .iterations = kSizeIterations};
    if (!options.noise && !options.factors) return;
    std::vector<estimation::ErrorResponse> all;
    for (std::size_t s = 0; s < residual.size(); ++s) all.push_back({residual[s], response_[s], model_.error_parts(s)});
    const auto found = estimation::find_input_error_sizes(all, {result_.noise, result_.error_factors}, options);
    result_.noise = found.noise;
    result_.error_factors = found.factors;
  }

  /// The errors of the EMG that are likeliest with the residual of the last search, H'R^-1 of it; they go a share of
  /// the way there. How far the largest is to go.
  double update_errors(double share) {
    double largest = 0.0;
    for (std::size_t s = 0; s < measured_.size(); ++s) {
      const RowMatrix left = (result_.measured[s] - result_.estimate.best.predicted[s]).unaryExpr([](double e) {
        return std::isnan(e) ? 0.0 : e;
      });
      const Eigen::VectorXd now = factors_of(s).cwiseProduct(
          (response_[s].transpose() * Eigen::Map<const Eigen::VectorXd>(left.data(), left.size()))
              .cwiseMax(-kMostError)
              .cwiseMin(kMostError));
      if (now.size() > 0) largest = std::max(largest, (now - errors_[s]).cwiseAbs().maxCoeff());
      errors_[s] += share * (now - errors_[s]);
    }
    return largest;
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
  TaskEstimateOptions options_;
  Progress& progress_;
  std::vector<Eigen::VectorXd> errors_;  ///< of the EMG, by segment, in standard deviations
  std::vector<RowMatrix> response_;      ///< to these, whitened
  EmgEstimate result_;
};

}  // namespace

AboutEmgErrors::AboutEmgErrors(const estimation::ParametricModel& model, std::vector<Eigen::VectorXd> errors,
                               std::vector<RowMatrix> shift)
    : ModelView(model), errors_(std::move(errors)), shift_(std::move(shift)) {}

bool AboutEmgErrors::respond(std::size_t segment, const Eigen::VectorXd& theta, std::span<const Eigen::Index> active,
                             estimation::ModelResponse& response) const {
  Eigen::VectorXd all(theta.size() + errors_[segment].size());
  all << theta, errors_[segment];
  if (!viewed().respond(segment, all, active, response)) return false;
  response.output -= shift_[segment];
  return true;
}

EmgEstimate estimate_from_emg(const EmgDrivenModel& model, const estimation::ParametricModel& responses,
                              const std::vector<RowMatrix>& measured, const Eigen::VectorXd& noise,
                              const TaskEstimateOptions& options, Progress& progress) {
  return EmgEstimation(model, responses, measured, noise, options, progress).run();
}

}  // namespace veridyn::muscle
