#include "veridyn/estimation/recursive/regression_tracker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/estimation/judgement/agreement.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::estimation {
namespace {

/// Standard deviations of the regressors' noise by which a row moves along a held direction.
constexpr double kExcursion = 3.0;
/// Standard deviations of a residual's variance that are no chance any more.
constexpr double kChance = 3.0;
/// Variance of z that is left where the residual is less than W says: this share of what W gives it, and more than what
/// it shares with the regressors.
double least_noise(const Eigen::MatrixXd& W) {
  const Eigen::Index n = W.rows() - 1;
  const Eigen::VectorXd shared = W.topRightCorner(n, 1);
  const double with_regressors = shared.dot(numerics::shortest_least_squares(W.topLeftCorner(n, n), shared));
  return std::max(0.1 * W(n, n), 1.01 * with_regressors);
}

RecursiveOptions regression_options(const Eigen::MatrixXd& W, const TrackerOptions& options, double rate_Hz) {
  RecursiveOptions o;
  o.method = options.method;
  o.forgetting = options.forgetting_at(rate_Hz);
  o.error_covariance = W;
  o.signal_to_noise = options.signal_to_noise;
  o.block = std::max<Eigen::Index>(1, static_cast<Eigen::Index>(std::lround(rate_Hz)));
  return o;
}

ChangeDetectionOptions detection_options(const TrackerOptions& options, double rate_Hz) {
  ChangeDetectionOptions o = options.detection;
  o.rate_Hz = rate_Hz;
  if (options.watch.share > 0.0) o.false_alarm_interval_s *= 2.0;
  return o;
}

}  // namespace

const KeyTable<TrackerOptions>& TrackerOptions::keys() {
  using O = TrackerOptions;
  const auto forgetting = [](auto member) {
    return [member](O & o) -> auto& { return o.forgetting.*member; };
  };
  const auto detection = [](auto member) {
    return [member](O & o) -> auto& { return o.detection.*member; };
  };
  using F = ForgettingOptions;
  using D = ChangeDetectionOptions;
  static const auto table =
      KeyTable<O>("track", "How parameters are followed on line.")
          .choice("method", &O::method,
                  {{"PCA-GTLS", Method::kPcaGtls}, {"GTLS", Method::kGtls}, {"OLS", Method::kOls}},
                  "`PCA-GTLS` holds what is not excited")
          .number("memory", &O::memory_s, "s", kPositive, "time after which a sample's weight has fallen to 5 %")
          .choice("forgetting", forgetting(&F::variable), {{"variable", true}, {"constant", false}},
                  "`variable`: a shorter memory while innovations are large")
          .number("lambda", forgetting(&F::lambda), "1", kAnyNumber, "weight of squares per row, in place of `memory`")
          .otherwise("by `memory`")
          .number("lambda_min", forgetting(&F::lambda_min), "1", kAnyNumber, "least weight of squares per row")
          .number("K_a", forgetting(&F::K_a), "1", kAnyNumber,
                  "window of the innovations' power, in multiples of the number of parameters")
          .number("K_b", forgetting(&F::K_b), "1", kAnyNumber, "window of the noise's power, likewise; more than `K_a`")
          .number("gamma", forgetting(&F::gamma), "1", kAnyNumber,
                  "innovations are large when their standard deviation exceeds the noise's by this factor")
          .flag("row_weight", forgetting(&F::row_weight),
                "weights rows, not their squares, by the forgetting factor, which halves the memory: only to reproduce "
                "published results")
          .number("signal_to_noise", &O::signal_to_noise, "1", from_to(1.0, 10.0), "S/n of the excitation threshold")
          .flag("detect_changes", &O::detect_changes, "innovations and the first parameter are watched for changes")
          .number("false_alarm_interval", detection(&D::false_alarm_interval_s), "s", kPositive,
                  "mean time between false alarms where nothing changes: of one coefficient of a flight, of both axles "
                  "of a drive")
          .number("detection_block", detection(&D::block_s), "s", kPositive, "innovations are averaged over this long")
          .number("detection_learning", detection(&D::learn_s), "s", kPositive,
                  "unchanged innovations are learned this long before they are watched")
          .number("detection_memory", detection(&D::memory_s), "s", kPositive, "and followed with this memory")
          .number("detection_settling", detection(&D::settle_s), "s", kAnyNumber,
                  "not watched for this long after an alarm")
          .number("history_rate", &O::history_Hz, "Hz", kPositive, "of what is kept for the report and track.csv")
          .check([](const StudyTable& t, O& o) {
            if (t.has("lambda")) {
              if (t.has("memory")) t.fail("memory", "and lambda say the same thing; give one of them");
              o.memory_s = 0.0;
            }
            o.forgetting.validate();
            o.detection.validate();
          });
  return table;
}

ForgettingOptions TrackerOptions::forgetting_at(double rate_Hz) const {
  ForgettingOptions o = forgetting;
  // lambda^(memory rate) = 0.05
  if (memory_s > 0.0) o.lambda = std::pow(0.05, 1.0 / (memory_s * rate_Hz));
  o.lambda_min = std::min(o.lambda_min, o.lambda);
  return o;
}

RegressionTracker::RegressionTracker(std::vector<std::string> names, const Eigen::MatrixXd& error_covariance,
                                     const TrackerOptions& options, double rate_Hz)
    : options_(options),
      rate_Hz_(rate_Hz),
      W_(error_covariance),
      least_noise_(least_noise(error_covariance)),
      regression_(std::move(names), regression_options(error_covariance, options, rate_Hz)),
      detector_(detection_options(options, rate_Hz)) {
  const auto n = static_cast<std::size_t>(regression_.parameters());
  if (options.watch.share > 0.0) {
    ParameterWatchOptions watch = options.watch;
    watch.false_alarm_interval_s = options.detection.false_alarm_interval_s * (options.watch_innovations ? 2.0 : 1.0);
    watch.learn_s = std::max(options.detection.learn_s, 10.0 * watch.block_s);
    watch.memory_s = std::max(options.detection.memory_s, watch.learn_s);
    watch.settle_s = options.detection.settle_s;
    watch_.emplace(watch, rate_Hz);
  }
  history_.value.resize(n);
  history_.sigma.resize(n);
  history_.unexcited_share.resize(n);
}

void RegressionTracker::start(const Eigen::VectorXd& theta_0, const Eigen::MatrixXd& P_0, double rows,
                              double residual_sd) {
  // What the residual of the estimate showed beyond W is error of the equation, for the rows behind it too.
  if (residual_sd > 0.0 && options_.method != Method::kOls) {
    const Eigen::Index n = theta_0.size();
    SmallVector h(n + 1);
    h << theta_0, -1.0;
    const double beyond = std::max(0.0, residual_sd * residual_sd - h.dot(W_ * h));
    regression_.set_equation_error(beyond);
    W_(n, n) += beyond;
  }
  regression_.start(theta_0, P_0, rows, residual_sd);
}

void RegressionTracker::restart(const Eigen::VectorXd& sigma) {
  const Eigen::VectorXd theta = regression_.theta();
  // Of what is forgotten the equation error too.
  W_(W_.rows() - 1, W_.rows() - 1) -= regression_.equation_error();
  regression_.set_equation_error(0.0);
  regression_ = RecursiveRegression(regression_.names(), regression_.options());
  regression_.start(theta, sigma.cwiseAbs2().asDiagonal());
  detector_.pause();
  if (watch_) watch_->pause();
  forget_parts();
}

void TrackedPower::add(double z, double lambda) {
  weight = lambda * weight + 1.0;
  const double before = z - mean;
  mean += before / weight;
  deviation = lambda * deviation + before * (z - mean);
}

void TrackedPower::add_innovation(double value, double previous, double lambda) {
  innovation = lambda * innovation + value * value;
  lagged = lambda * lagged + value * previous;
}

double RegressionTracker::error_ratio() const {
  const double residual = regression_.residual_sd();
  if (options_.method == Method::kOls || !regression_.usable()) return kNaN;
  const double by_W = variance_of(W_) - regression_.equation_error();
  return by_W > 0.0 ? residual * residual / by_W : kNaN;
}

std::optional<RegressionTracker::Part> RegressionTracker::part_of(const RecursiveRegression& r) {
  const SmallMatrix& covariance = r.covariance();
  if (!r.usable() || r.unexcited().cols() > 0 || !covariance.allFinite()) return std::nullopt;
  return Part{r.theta(), covariance, r.degrees_of_freedom()};
}

void RegressionTracker::forget_parts() {
  parts_.clear();
  next_part_s_ = kNaN;
}

void RegressionTracker::keep_part(double t) {
  const double memory = cut_off_time(options_.forgetting_at(rate_Hz_).square_weight(), rate_Hz_);
  if (std::isnan(next_part_s_)) next_part_s_ = t + memory;
  if (t < next_part_s_) return;
  next_part_s_ = t + memory;
  if (std::optional<Part> part = part_of(regression_)) parts_.push_back(std::move(*part));
}

TrackedScatter RegressionTracker::scatter() const {
  TrackedScatter result;
  const std::vector<Part>& parts = parts_;
  if (parts.size() < 2) return result;
  double chi_square = 0.0, freedom = 0.0;
  Eigen::VectorXd sum = parts[0].theta;
  Eigen::MatrixXd covariance = parts[0].covariance;
  double least_freedom = parts[0].degrees_of_freedom;
  for (std::size_t k = 1; k < parts.size(); ++k) {
    // Against the mean of those before, which shares nothing with it.
    const auto before = static_cast<double>(k);
    const Agreement a = agreement(parts[k].theta - sum / before, parts[k].covariance + covariance / (before * before));
    least_freedom = std::min(least_freedom, parts[k].degrees_of_freedom);
    // Error bars from few blocks are uncertain themselves, by which chi-square comes out too large: Student's variance.
    const double excess = least_freedom > 3.0 ? least_freedom / (least_freedom - 2.0) : 3.0;
    const auto n = static_cast<double>(sum.size());
    chi_square += a.ratio * n / excess;
    freedom += n;
    sum += parts[k].theta;
    covariance += parts[k].covariance;
  }
  result.parts = static_cast<int>(parts.size());
  result.ratio = chi_square / freedom;
  result.p = numerics::chi_square_upper_p(chi_square, freedom);
  return result;
}

RegressionEstimate RegressionTracker::estimate() const {
  constexpr double kSignificance = 0.05;
  RegressionEstimate result = regression_.estimate(kSignificance);
  widen(result, scatter().ratio, kSignificance);
  return result;
}

void RegressionTracker::fit_equation_error() {
  const double residual = regression_.residual_sd();
  if (!regression_.usable() || !std::isfinite(residual)) return;
  // A variance from N rows, two of which tell as much as one, is uncertain by a share of sqrt(4/N): what lies within
  // that is no reason to leave a W that is known.
  const double chance = kChance * std::sqrt(4.0 / std::max(1.0, regression_.effective_samples()));
  const double by_W = variance_of(W_);
  if (std::abs(residual * residual - by_W) <= chance * by_W) return;
  const Eigen::Index z = W_.rows() - 1;
  W_(z, z) -= regression_.equation_error();
  regression_.set_equation_error(std::max(residual * residual - variance_of(W_), least_noise_ - W_(z, z)));
  W_(z, z) += regression_.equation_error();
}

bool RegressionTracker::moves_held_direction(std::span<const double> x) const {
  const SmallMatrix& held = regression_.unexcited();
  const auto n = signed_index(x.size());
  const Eigen::Map<const Eigen::VectorXd> row(x.data(), n);
  for (Eigen::Index j = 0; j < held.cols(); ++j) {
    const double along = row.dot(held.col(j));
    const double noise = held.col(j).dot(W_.topLeftCorner(n, n) * held.col(j));
    if (along * along > kExcursion * kExcursion * noise) return true;
  }
  return false;
}

/// h' W h, h = [theta; -1]: the variance of z - x theta that W gives.
double RegressionTracker::variance_of(const SmallMatrix& W) const {
  const Eigen::Index n = W.rows();
  SmallVector h(n);
  h.head(n - 1) = regression_.theta();
  h(n - 1) = -1.0;
  return h.dot(W * h);
}

/// Of the first regressor, and with the innovation z - x theta: cov(x_0, z) - cov(x_0, x) theta.
RowNoise RegressionTracker::row_noise(const Eigen::MatrixXd* row_W) const {
  const SmallMatrix W = row_W != nullptr ? SmallMatrix(*row_W) : W_;
  const Eigen::Index n = W.rows() - 1;
  return {.regressor = W(0, 0), .shared = W(0, n) - W.row(0).head(n).dot(regression_.theta())};
}

/// Variance of the row's residual over that which W gives.
double RegressionTracker::noise_ratio(const Eigen::MatrixXd& row_W) const {
  const double usual = variance_of(W_);
  return usual > 0.0 ? variance_of(row_W) / usual : 1.0;
}

std::optional<Change> RegressionTracker::update(double t, std::span<const double> x, double z,
                                                const Eigen::MatrixXd* row_W) {
  // Before the update: it may turn the direction into an excited one.
  const bool moves_held = options_.detect_changes && moves_held_direction(x);
  const RecursiveUpdate u = regression_.update(x, z);
  std::optional<Change> change;
  if (u.accepted) {
    least_lambda_ = std::min(least_lambda_, u.lambda);
    power_.add(z, u.lambda);
    const bool known = std::isfinite(u.innovation_sigma);
    power_.add_innovation(known ? u.innovation : 0.0, last_innovation_, u.lambda);
    last_innovation_ = known ? u.innovation : 0.0;
    double normalised = u.innovation / u.innovation_sigma;
    if (row_W != nullptr) normalised /= std::sqrt(noise_ratio(*row_W));
    if (std::isfinite(normalised)) {
      innovation_power_ += normalised * normalised;
      ++innovations_;
      // Innovations are informative once everything was excited: what was not is held at a prior, and later at its last
      // value. They are not where the row moves along a combination of parameters that is not known now.
      if (options_.detect_changes && watching_ && !moves_held) {
        if (options_.watch_innovations) change = detector_.update(t, normalised);
        if (watch_) {
          const std::optional<Change> moved =
              watch_->update(t, x[0], u.innovation, regression_.theta()(0), row_noise(row_W));
          if (!change) change = moved;
        }
      }
    }
  }
  if (change) {
    changes_.push_back(*change);
    forget_parts();
  }
  keep_part(t);
  watching_ = watching_ || (regression_.usable() && regression_.excited_directions() >= regression_.parameters() &&
                            static_cast<double>(regression_.rows()) >= options_.watch_after_s * rate_Hz_);
  if (first_) next_s_ = t;
  first_ = false;
  if (t >= next_s_ - 1e-9) remember(t);
  return change;
}

double RegressionTracker::suspicion() const {
  return std::max(detector_.suspicion(), watch_ ? watch_->suspicion() : 0.0);
}

void RegressionTracker::remember(double t) {
  next_s_ = std::max(next_s_ + 1.0 / options_.history_Hz, t);
  history_.time.push_back(t);
  const SmallVector& sigma = regression_.sigma();
  const SmallVector& share = regression_.unexcited_share();
  for (std::size_t i = 0; i < history_.value.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    history_.value[i].push_back(regression_.theta()(k));
    history_.sigma[i].push_back(sigma(k));
    history_.unexcited_share[i].push_back(share.size() > k ? share(k) : 0.0);
  }
  const SmallVector& s = regression_.singular_values();
  if (history_.singular_value.size() < static_cast<std::size_t>(s.size())) {
    history_.singular_value.resize(s.size(), std::vector<double>(history_.time.size() - 1, 0.0));
  }
  for (std::size_t i = 0; i < history_.singular_value.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    history_.singular_value[i].push_back(k < s.size() ? s(k) : kNaN);
  }
  history_.threshold.push_back(regression_.threshold());
  history_.excited.push_back(static_cast<int>(regression_.excited_directions()));
  history_.lambda.push_back(least_lambda_);
  history_.suspicion.push_back(suspicion());
  history_.innovation.push_back(innovations_ > 0 ? std::sqrt(innovation_power_ / static_cast<double>(innovations_))
                                                 : kNaN);
  least_lambda_ = 1.0;
  innovation_power_ = 0.0;
  innovations_ = 0;
}

}  // namespace veridyn::estimation
