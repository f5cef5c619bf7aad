#include "veridyn/aircraft/tracking/flight_tracker.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/identification/rows/coefficient_rows.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::aircraft {

using estimation::Parameter;
using estimation::RegressionEstimate;

namespace {

/// Mean of x x' over the rows so far, and after `memory` of them with a weight that falls off over as many.
void add_to_moment(std::span<const double> x, double memory, double& rows, Eigen::MatrixXd& moment) {
  const Eigen::Map<const Eigen::VectorXd> row(x.data(), static_cast<Eigen::Index>(x.size()));
  if (moment.size() == 0) moment = Eigen::MatrixXd::Zero(row.size(), row.size());
  rows = std::min(rows + 1.0, memory);
  moment += (row * row.transpose() - moment) / rows;
}

}  // namespace

double filter_margin(const FlightSignals& signals) {
  const auto width = static_cast<double>(numerics::low_pass_differentiator(signals.filter).half_width());
  return (width + 1.0) * signals.grid.step;
}

FlightTracker::FlightTracker(Subject subject, TrackOptions options, double min_airspeed_mps,
                             const estimation::Estimate* start)
    : subject_(std::move(subject)),
      options_(std::move(options)),
      min_airspeed_(min_airspeed_mps),
      last_(-kInfinity),
      window_(-kInfinity) {
  if (start != nullptr) start_ = *start;
  for (const auto& model : subject_.model.coefficients) {
    const auto& some = options_.coefficients;
    if (!model) continue;
    if (!some.empty() && std::find(some.begin(), some.end(), model->coefficient) == some.end()) continue;
    coefficients_.push_back({.model = *model});
    if (model->size() > static_cast<std::size_t>(estimation::kMaxRecursiveParameters)) {
      coefficients_.back().obstacle =
          fmt::format("{} has {} parameters; at most {} can be followed", name_of(model->coefficient), model->size(),
                      estimation::kMaxRecursiveParameters);
    }
  }
  if (coefficients_.empty()) throw InputError(subject_.name, "its model has none of the coefficients to track");
  learning_.resize(coefficients_.size());
  moment_rows_.resize(coefficients_.size());
}

std::vector<FlightChange> FlightTracker::feed(const FlightSignals& signals, double from, double until) {
  std::vector<FlightChange> found;
  if (!obstacles_known_) {
    for (TrackedCoefficient& c : coefficients_) {
      if (c.obstacle.empty()) c.obstacle = identification_obstacle(c.model, signals, subject_);
    }
    obstacles_known_ = true;
  }
  rate_ = 1.0 / (signals.grid.step * static_cast<double>(signals.stride));
  // Rows lie on multiples of the stride since the clock's zero, so that pieces of a flight give the rows of the whole.
  const auto first = static_cast<long long>(std::llround(signals.grid.begin / signals.grid.step));
  const auto stride = static_cast<long long>(signals.stride);
  const auto offset = static_cast<std::size_t>(((-first) % stride + stride) % stride);
  std::vector<std::size_t> window;
  for (std::size_t k = offset; k < signals.size(); k += signals.stride) {
    const double t = signals.grid.at(k);
    if (t <= last_ || t < from || t > until) continue;
    if (!window.empty() && std::floor(t / kWindowSeconds) > std::floor(last_ / kWindowSeconds)) {
      take_window(signals, window, found);
      window.clear();
    }
    last_ = t;
    if (signals[FlightSignal::kAirspeed].value[k] >= min_airspeed_) window.push_back(k);
  }
  take_window(signals, window, found);
  changes_.insert(changes_.end(), found.begin(), found.end());
  return found;
}

void FlightTracker::take_window(const FlightSignals& signals, const std::vector<std::size_t>& rows,
                                std::vector<FlightChange>& found) {
  if (rows.empty()) return;
  rows_ += rows.size();
  // By the clock, so that a flight in pieces gives what the whole gives.
  const double number = std::floor(signals.grid.at(rows.front()) / kWindowSeconds);
  if (number != window_) {
    window_ = number;
    for (TrackedCoefficient& c : coefficients_)
      if (c.tracker) c.tracker->fit_equation_error();
  }
  const auto before = static_cast<std::ptrdiff_t>(found.size());
  for (std::size_t i = 0; i < coefficients_.size(); ++i) {
    if (coefficients_[i].obstacle.empty()) take(i, signals, rows, found);
  }
  std::stable_sort(found.begin() + before, found.end(), [](const FlightChange& a, const FlightChange& b) {
    return a.change.detected_s < b.change.detected_s;
  });
}

void FlightTracker::take(std::size_t index, const FlightSignals& signals, const std::vector<std::size_t>& grid_points,
                         std::vector<FlightChange>& found) {
  TrackedCoefficient& c = coefficients_[index];
  const auto n = static_cast<Eigen::Index>(c.model.size());
  std::vector<std::size_t> rows;
  estimation::RegressionData data;
  data.parameter_names.resize(c.model.size());
  data.regressors.resize(grid_points.size(), n);
  data.regressand.resize(data.regressors.rows());
  for (const std::size_t k : grid_points) {
    const FlightSample<double> sample = signals.sample(k);
    const double rho = signals.air_density[k];
    const double torque = signals.torque.empty() ? 0.0 : signals.torque[k];
    const auto row = static_cast<Eigen::Index>(rows.size());
    data.regressors.row(row) = c.model.regressors(aero_variables(sample, subject_, rho)).transpose();
    data.regressand(row) = select(regressed_coefficients(sample, subject_, rho, torque), c.model.coefficient);
    if (data.regressors.row(row).allFinite() && std::isfinite(data.regressand(row))) rows.push_back(k);
  }
  const auto count = static_cast<Eigen::Index>(rows.size());
  data.regressors.conservativeResize(count, n);
  data.regressand.conservativeResize(count);
  internal::take_out_jumps(c.model, signals, rows, data);
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::size_t k = rows[i];
    take_row(index, signals.grid.at(k), {data.regressors.row(i).data(), c.model.size()}, data.regressand(i),
             row_error_covariance(c.model, signals, k, subject_), found);
  }
}

void FlightTracker::take_row(std::size_t index, double time, std::span<const double> x, double z, Eigen::MatrixXd W,
                             std::vector<FlightChange>& found) {
  TrackedCoefficient& c = coefficients_[index];
  add_to_moment(x, std::max(1.0, rate_ * options_.memory_s), moment_rows_[index], c.regressor_moment);
  if (c.tracker) {
    W(W.rows() - 1, W.cols() - 1) += c.tracker->equation_error();
    if (const auto change = c.tracker->update(time, x, z, &W)) found.push_back({c.model.coefficient, *change});
    return;
  }
  Learning& learning = learning_[index];
  learning.time.push_back(time);
  learning.rows.insert(learning.rows.end(), x.begin(), x.end());
  learning.rows.push_back(z);
  learning.W = learning.count == 0 ? W : Eigen::MatrixXd(learning.W + W);
  ++learning.count;
  if (static_cast<double>(learning.count) >= kLearnSeconds * rate_) begin(index, found);
}

void FlightTracker::begin(std::size_t index, std::vector<FlightChange>& found) {
  TrackedCoefficient& c = coefficients_[index];
  Learning& learning = learning_[index];
  Eigen::MatrixXd W = learning.W / static_cast<double>(learning.count);
  const auto n = static_cast<Eigen::Index>(c.model.size());
  std::vector<std::string> names;
  for (const Term& term : c.model.terms) names.push_back(regressed_parameter_name(c.model.coefficient, term, subject_));
  Eigen::VectorXd theta(n);
  Eigen::MatrixXd P(n, n);
  bool complete = start_.has_value();
  if (start_) {
    std::vector<Eigen::Index> at;
    for (const std::string& name : names) {
      const Parameter* p = start_->find(name);
      const bool usable = p != nullptr && std::isfinite(p->value) && p->sigma > 0.0 && std::isfinite(p->sigma) &&
                          p->status != estimation::ParameterStatus::kRejected;
      complete = complete && usable;
      at.push_back(p != nullptr ? p - start_->parameters.data() : 0);
    }
    if (complete) {
      for (Eigen::Index i = 0; i < n; ++i) {
        theta(i) = start_->parameters[at[i]].value;
        for (Eigen::Index j = 0; j < n; ++j) P(i, j) = start_->covariance(at[i], at[j]);
      }
    }
  }
  const std::string name = regressed_name(c.model.coefficient, subject_);
  const auto fit = [&](const char* key) {
    const auto found_fit = start_ ? start_->fit.find(name + "." + key) : decltype(start_->fit.end()){};
    return start_ && found_fit != start_->fit.end() ? found_fit->second : 0.0;
  };
  c.tracker.emplace(c.model, W, options_, rate_, names);
  if (complete) {
    c.tracker->start(theta, P, fit("samples"), fit("residual_sd"));
    // What the batch residual showed beyond the sensors is error of the equation.
    c.tracker->fit_equation_error();
  }
  c.start = complete ? "batch estimate" : "no estimate";
  const auto width = static_cast<std::size_t>(n) + 1;
  for (std::size_t i = 0; i < learning.time.size(); ++i) {
    const double* row = learning.rows.data() + i * width;
    if (const auto change = c.tracker->update(learning.time[i], {row, width - 1}, row[width - 1]))
      found.push_back({c.model.coefficient, *change});
  }
  learning = {};
}

estimation::Estimate FlightTracker::estimate() const {
  estimation::Estimate out;
  out.subject = subject_.name;
  out.method = fmt::format("{} on line", estimation::to_string(options_.method));
  Eigen::Index total = 0;
  for (const TrackedCoefficient& c : coefficients_) {
    if (c.tracker) total += static_cast<Eigen::Index>(c.model.size());
  }
  out.covariance = Eigen::MatrixXd::Zero(total, total);
  Eigen::Index at = 0;
  std::vector<std::string> followed, skipped;
  for (const TrackedCoefficient& c : coefficients_) {
    const std::string name = regressed_name(c.model.coefficient, subject_);
    if (!c.tracker) {
      skipped.push_back(name);
      out.warnings.push_back(
          !c.obstacle.empty() ? c.obstacle : fmt::format("{}: less than {:.0f} s in the air", name, kLearnSeconds));
      continue;
    }
    followed.push_back(name);
    const RegressionEstimate e = c.tracker->estimate();
    const auto n = static_cast<Eigen::Index>(c.model.size());
    for (std::size_t i = 0; i < c.model.size(); ++i) {
      out.parameters.push_back(e.parameters[i]);
      out.parameters.back().unit = regressed_parameter_unit(c.model.coefficient, c.model.terms[i], subject_);
    }
    out.covariance.block(at, at, n, n) = e.covariance;
    at += n;
    out.fit[name + ".residual_sd"] = c.tracker->regression().residual_sd();
    out.fit[name + ".samples"] = c.tracker->regression().effective_samples();
    out.fit[name + ".error_scale"] = c.tracker->regression().error_scale();
    const std::string held = c.tracker->regression().unexcited_text();
    if (!held.empty()) out.warnings.push_back(fmt::format("{}: held, because not excited: {}", name, held));
  }
  out.verdict =
      fmt::format("followed: {}", followed.empty() ? "nothing" : fmt::format("{}", fmt::join(followed, ", ")));
  if (!skipped.empty()) out.verdict += fmt::format("; not followed: {}", fmt::join(skipped, ", "));
  return out;
}

}  // namespace veridyn::aircraft
