#include "veridyn/estimation/recursive/regression_tracker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::estimation {
namespace {

/// Standard deviations of the regressors' noise by which a row moves along a held direction.
constexpr double kExcursion = 3.0;

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
  return o;
}

}  // namespace

void TrackerOptions::read_keys(const StudyTable& table) {
  TrackerOptions& o = *this;
  const std::vector<std::string> methods{"PCA-GTLS", "GTLS", "OLS"};
  const std::string chosen = table.choice_or("method", methods, to_string(method));
  o.method = chosen == "OLS" ? Method::kOls : chosen == "GTLS" ? Method::kGtls : Method::kPcaGtls;
  const std::vector<std::string> kinds{"variable", "constant"};
  o.forgetting.variable =
      table.choice_or("forgetting", kinds, o.forgetting.variable ? "variable" : "constant") == "variable";
  if (table.has("lambda")) {
    if (table.has("memory")) table.fail("memory", "and lambda say the same thing; give one of them");
    o.forgetting.lambda = table.number("lambda", "1");
    o.memory_s = 0.0;
  } else {
    o.memory_s = table.positive_or("memory", "s", o.memory_s);
  }
  o.forgetting.lambda_min = table.number_or("lambda_min", "1", o.forgetting.lambda_min);
  o.forgetting.K_a = table.number_or("K_a", "1", o.forgetting.K_a);
  o.forgetting.K_b = table.number_or("K_b", "1", o.forgetting.K_b);
  o.forgetting.gamma = table.number_or("gamma", "1", o.forgetting.gamma);
  o.forgetting.row_weight = table.flag_or("row_weight", o.forgetting.row_weight);
  o.forgetting.validate();
  o.signal_to_noise = table.number_or("signal_to_noise", "1", o.signal_to_noise);
  if (!(o.signal_to_noise >= 1.0 && o.signal_to_noise <= 10.0)) {
    table.fail("signal_to_noise", fmt::format("= {} must be from 1 to 10", o.signal_to_noise));
  }
  o.detect_changes = table.flag_or("detect_changes", o.detect_changes);
  o.detection.false_alarm_interval_s =
      table.positive_or("false_alarm_interval", "s", o.detection.false_alarm_interval_s);
  o.detection.block_s = table.positive_or("detection_block", "s", o.detection.block_s);
  o.detection.learn_s = table.positive_or("detection_learning", "s", o.detection.learn_s);
  o.detection.memory_s = table.positive_or("detection_memory", "s", o.detection.memory_s);
  o.detection.settle_s = table.number_or("detection_settling", "s", o.detection.settle_s);
  o.detection.validate();
  o.history_Hz = table.positive_or("history_rate", "Hz", o.history_Hz);
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
      regression_(std::move(names), regression_options(error_covariance, options, rate_Hz)),
      detector_(detection_options(options, rate_Hz)) {
  const auto n = static_cast<std::size_t>(regression_.parameters());
  history_.value.resize(n);
  history_.sigma.resize(n);
  history_.unexcited_share.resize(n);
}

void RegressionTracker::start(const Eigen::VectorXd& theta_0, const Eigen::MatrixXd& P_0, double rows,
                              double residual_sd) {
  regression_.start(theta_0, P_0, rows, residual_sd);
}

void RegressionTracker::restart(const Eigen::VectorXd& sigma) {
  const Eigen::VectorXd theta = regression_.theta();
  regression_ = RecursiveRegression(regression_.names(), regression_.options());
  regression_.start(theta, sigma.cwiseAbs2().asDiagonal());
}

bool RegressionTracker::moves_held_direction(std::span<const double> x) const {
  const SmallMatrix& held = regression_.unexcited();
  const auto n = static_cast<Eigen::Index>(x.size());
  const Eigen::Map<const Eigen::VectorXd> row(x.data(), n);
  for (Eigen::Index j = 0; j < held.cols(); ++j) {
    const double along = row.dot(held.col(j));
    const double noise = held.col(j).dot(W_.topLeftCorner(n, n) * held.col(j));
    if (along * along > kExcursion * kExcursion * noise) return true;
  }
  return false;
}

/// Variance of the row's residual over that which W gives.
double RegressionTracker::noise_ratio(const Eigen::MatrixXd& row_W) const {
  const Eigen::Index n = row_W.rows();
  SmallVector h(n);
  h.head(n - 1) = regression_.theta();
  h(n - 1) = -1.0;
  const double usual = h.dot(W_ * h);
  return usual > 0.0 ? h.dot(row_W * h) / usual : 1.0;
}

double RegressionTracker::against_W(double innovation, const Eigen::MatrixXd* row_W) const {
  const Eigen::Index n = W_.rows();
  SmallVector h(n);
  h.head(n - 1) = regression_.theta();
  h(n - 1) = -1.0;
  return innovation / std::sqrt(row_W != nullptr ? h.dot(*row_W * h) : h.dot(W_ * h));
}

std::optional<Change> RegressionTracker::update(double t, std::span<const double> x, double z,
                                                const Eigen::MatrixXd* row_W) {
  // Before the update: it may turn the direction into an excited one.
  const bool moves_held = options_.detect_changes && moves_held_direction(x);
  const RecursiveUpdate u = regression_.update(x, z);
  std::optional<Change> change;
  if (u.accepted) {
    least_lambda_ = std::min(least_lambda_, u.lambda);
    double normalised = u.innovation / u.innovation_sigma;
    if (row_W != nullptr) normalised /= std::sqrt(noise_ratio(*row_W));
    if (std::isfinite(normalised)) {
      innovation_power_ += normalised * normalised;
      ++innovations_;
      // Innovations are informative once everything was excited: what was not is held at a prior, and later at its last
      // value. They are not where the row moves along a combination of parameters that is not known now.
      if (options_.detect_changes && watching_ && !moves_held) {
        change = detector_.update(t, options_.watch_against_W ? against_W(u.innovation, row_W) : normalised);
      }
    }
  }
  if (change) changes_.push_back(*change);
  watching_ = watching_ || (regression_.usable() && regression_.excited_directions() >= regression_.parameters() &&
                            static_cast<double>(regression_.rows()) >= options_.watch_after_s * rate_Hz_);
  if (first_) next_s_ = t;
  first_ = false;
  if (t >= next_s_ - 1e-9) remember(t);
  return change;
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
    history_.singular_value.resize(static_cast<std::size_t>(s.size()),
                                   std::vector<double>(history_.time.size() - 1, 0.0));
  }
  for (std::size_t i = 0; i < history_.singular_value.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    history_.singular_value[i].push_back(k < s.size() ? s(k) : kNaN);
  }
  history_.threshold.push_back(regression_.threshold());
  history_.excited.push_back(static_cast<int>(regression_.excited_directions()));
  history_.lambda.push_back(least_lambda_);
  history_.suspicion.push_back(detector_.suspicion());
  history_.innovation.push_back(innovations_ > 0 ? std::sqrt(innovation_power_ / static_cast<double>(innovations_))
                                                 : kNaN);
  least_lambda_ = 1.0;
  innovation_power_ = 0.0;
  innovations_ = 0;
}

}  // namespace veridyn::estimation
