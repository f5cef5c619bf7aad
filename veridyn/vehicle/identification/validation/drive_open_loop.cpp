#include "veridyn/vehicle/identification/validation/drive_open_loop.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/open_loop/open_loop_evidence.hpp"
#include "veridyn/estimation/open_loop/open_loop_forecast.hpp"
#include "veridyn/estimation/open_loop/open_loop_scores.hpp"
#include "veridyn/estimation/open_loop/open_loop_windows.hpp"
#include "veridyn/vehicle/identification/fit/drive_parametric_model.hpp"
#include "veridyn/vehicle/identification/fit/estimated_drive_model.hpp"
#include "veridyn/vehicle/model/bicycle_analysis.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::OpenLoopError;
using estimation::OpenLoopForecast;

/// How many times finer the integration steps than output error needs, whose Runge-Kutta steps are right to 3e-4 of a
/// step's decay: their errors fall with the fourth power.
constexpr double kFinerSteps = 5.0;
/// Where a signal has no error, rounding is one.
constexpr double kRounding = 1e-8;
/// Of an output that was not measured, so that it says nothing [m/s].
constexpr double kUnmeasured = 1e6;

/// Where windows may begin, and what they may be driven over.
struct Spans {
  std::vector<TimeSpan> excited, free;
};

Spans spans_of(const DriveSegments& segments, OpenLoopUse use) {
  Spans spans{.excited = segments.holdout, .free = segments.usable};
  if (use == OpenLoopUse::kHoldout) spans.free = estimation::unseen(segments.usable, segments.identification);
  if (use == OpenLoopUse::kOtherDrive) {
    spans.excited.insert(spans.excited.end(), segments.identification.begin(), segments.identification.end());
    std::ranges::sort(spans.excited, {}, &TimeSpan::begin);
  }
  return spans;
}

/// Whether the path needs a lateral velocity that was not recorded.
bool needs_lateral_velocity(const DriveSignals& signals) {
  return signals[DriveSignal::kX].available() && signals[DriveSignal::kY].available() &&
         !signals[DriveSignal::kLateralVelocity].available();
}

/// With a lateral velocity of which nothing was measured, so that it is an output of the model.
DriveSignals with_lateral_velocity(DriveSignals signals) {
  signals[DriveSignal::kLateralVelocity].value.assign(signals.size(), kNaN);
  return signals;
}

/// Whether a bias changes anything that is compared.
bool acts_on(DriveUnknown bias, DriveStructure structure, const DriveSignals& signals) {
  switch (bias) {
    case DriveUnknown::kAccelYBias:
      return signals[DriveSignal::kAccelY].available();
    case DriveUnknown::kRollBias:
      return has_roll(structure) && signals[DriveSignal::kRoll].available();
    case DriveUnknown::kRollRateBias:
      return has_roll(structure) && signals[DriveSignal::kRollRate].available();
    case DriveUnknown::kSideslipBias:
      return signals.lateral_by_course;
    default:
      return true;
  }
}

/// The model with every parameter fixed, and the biases that each window has of its own.
EstimatedDriveModel fixed_model(const DriveOpenLoopProblem& problem, const DriveOpenLoopOptions& options) {
  EstimatedDriveModel out = estimated_drive_model(problem.estimate, problem.vehicle, problem.model);
  // What identification of this drive did not estimate it has kept as the study gives it.
  if (problem.use == OpenLoopUse::kHoldout && !problem.estimate.parameters.empty()) out.missing.clear();
  DriveModelOptions& model = out.options;
  model.free.fill(false);
  model.finer_steps = kFinerSteps;
  for (const DriveUnknown u : {DriveUnknown::kCf, DriveUnknown::kCr, DriveUnknown::kIz, DriveUnknown::kA})
    model.start[u] = kNaN;
  model.offsets = options.offsets.value_or(std::vector<DriveUnknown>());
  for (const DriveUnknown bias : kDriveBiases) {
    const bool acts = acts_on(bias, model.structure, problem.signals);
    const estimation::Parameter* known = problem.estimate.find(std::string(kDriveUnknownNames[bias]));
    if (acts && problem.use == OpenLoopUse::kHoldout && known != nullptr && std::isfinite(known->value)) {
      model.start[bias] = known->value;
      continue;
    }
    // That of another day says nothing.
    const auto place = static_cast<Eigen::Index>(bias);
    out.covariance.row(place).setZero();
    out.covariance.col(place).setZero();
    model.start[bias] = 0.0;
    if (!options.offsets && acts) model.offsets.push_back(bias);
  }
  return out;
}

/// NaN where the estimate does not say.
double fit_of(const estimation::Estimate& estimate, const std::string& name) {
  const auto found = estimate.fit.find(name);
  return found == estimate.fit.end() ? kNaN : found->second;
}

/// The errors of what is compared: the sensor's, and what lasts: what noise of the steering gives it, or what the
/// residual had beyond the sensor where the model was identified.
std::vector<OpenLoopError> errors_of(const DriveParametricModel& model, const DriveSignals& signals,
                                     const estimation::Estimate& estimate) {
  Eigen::VectorXd theta(signed_index(model.parameters().size()));
  for (Eigen::Index i = 0; i < theta.size(); ++i) theta(i) = model.parameters()[at(i)].start;
  const estimation::InputNoise by_steering = model.steering_noise(theta);
  std::vector<OpenLoopError> errors;
  for (const estimation::ModelOutput& output : model.outputs()) {
    const auto signal =
        static_cast<DriveSignal>(std::ranges::find(kDriveSignalNames, output.name) - kDriveSignalNames.begin());
    if (!signals[signal].available()) {
      errors.push_back({.white = kUnmeasured});
      continue;
    }
    const auto j = signed_index(errors.size());
    OpenLoopError error{.white = std::max(kRounding, signals[signal].sigma),
                        .lasting = std::sqrt(by_steering.variance(j)),
                        .memory = by_steering.memory(j)};
    const double rmse = fit_of(estimate, output.name + ".rmse"), white = error.white * error.white;
    const double lasting = rmse * rmse - white;
    if (lasting > error.lasting * error.lasting) {
      // The variance of a mean is that of white noise and what lasts together.
      error.memory = (fit_of(estimate, output.name + ".long_run") * rmse * rmse - white) / lasting;
      if (!(error.memory >= 1.0)) error.memory = std::isnan(error.memory) ? kInfinity : 1.0;
      error.lasting = std::sqrt(lasting);
    }
    errors.push_back(error);
  }
  return errors;
}

/// Of the undamped yaw oscillation at the mean speed of what was driven.
std::optional<double> yaw_period(const VehicleParameters<double>& p, const DriveSignals& signals,
                                 std::span<const OpenLoopForecast> driven) {
  double sum = 0.0, count = 0.0;
  for (const OpenLoopForecast& f : driven) {
    const auto [begin, end] = signals.indices(f.window.span);
    for (std::size_t k = begin; k < end; ++k) {
      sum += signals[DriveSignal::kSpeed].value[k];
      count += 1.0;
    }
  }
  if (!(count > 0.0)) return std::nullopt;
  const LinearBicycle<double> bicycle{p.mass, p.I_z, p.a, p.b, p.C_f, p.C_r, sum / count};
  const double squared = std::abs(bicycle.A().determinant());
  if (!(squared > 0.0)) return std::nullopt;
  return 2.0 * M_PI / std::sqrt(squared);
}

/// What the yaw rate's sensor reads too much, by the recorded heading; nothing where that is not recorded.
std::optional<double> bias_by_heading(const DriveSignals& signals, const TimeSpan& span) {
  const std::vector<double>&yaw = signals[DriveSignal::kYaw].value, &rate = signals[DriveSignal::kYawRate].value;
  if (yaw.empty()) return std::nullopt;
  double excess = 0.0, duration = 0.0;
  const auto [begin, end] = signals.indices(span);
  for (std::size_t k = begin + 1; k < end; ++k) {
    const double step = signals.grid.step, turned = yaw[k] - yaw[k - 1], read = 0.5 * step * (rate[k] + rate[k - 1]);
    if (!std::isfinite(turned) || !std::isfinite(read)) continue;
    excess += read - turned;
    duration += step;
  }
  return duration > 0.0 ? std::optional(excess / duration) : std::nullopt;
}

/// The same by the course of the recorded positions, second by second, whose sideslip at both ends is as small.
std::optional<double> bias_by_positions(const DriveSignals& signals, const TimeSpan& span) {
  constexpr double kLeastWay_m = 1.0, kLeastTime_s = 4.0;
  const std::vector<double>&x = signals[DriveSignal::kX].value, &y = signals[DriveSignal::kY].value;
  const std::vector<double>& rate = signals[DriveSignal::kYawRate].value;
  if (x.empty() || y.empty()) return std::nullopt;
  const double step = signals.grid.step;
  const auto second = static_cast<std::size_t>(std::max(2.0, std::round(1.0 / step)));
  double turned = 0.0, read = 0.0, last = kNaN, duration = 0.0;
  const auto [begin, end] = signals.indices(span);
  for (std::size_t k = begin; k + second < end; k += second) {
    const double dx = x[k + second] - x[k], dy = y[k + second] - y[k];
    const double course = std::hypot(dx, dy) > kLeastWay_m ? std::atan2(dy, dx) : kNaN;
    // From the middle of the second before to that of this one.
    double over = 0.0;
    for (std::size_t i = k - std::min(k, second / 2); i < k + second / 2; ++i) over += step * rate[i];
    const double turn = std::remainder(course - last, 2.0 * kPi);
    last = course;
    if (k == begin || !std::isfinite(turn) || !std::isfinite(over)) continue;
    turned += turn;
    read += over;
    duration += step * static_cast<double>(second);
  }
  return duration >= kLeastTime_s ? std::optional((read - turned) / duration) : std::nullopt;
}

/// The simulated turning of the windows, whose yaw rate is without its sensor's bias: that by the heading, since what
/// passes for a bias in the first seconds may be the model's error, else the window's own or the known one.
std::vector<SimulatedTurning> turning_of(const DriveSignals& signals, std::span<const OpenLoopForecast> driven,
                                         std::span<const estimation::ModelOutput> outputs, double known_bias) {
  const auto column = [&](DriveSignal signal) {
    return std::ranges::find(outputs, kDriveSignalNames[signal], &estimation::ModelOutput::name) - outputs.begin();
  };
  const auto yaw_rate = column(DriveSignal::kYawRate), lateral = column(DriveSignal::kLateralVelocity);
  std::vector<SimulatedTurning> windows;
  for (const OpenLoopForecast& f : driven) {
    double bias = known_bias;
    for (const estimation::SegmentParameter& p : f.window.start)
      if (p.name == kDriveUnknownNames[DriveUnknown::kYawRateBias]) bias = p.value;
    const std::optional<double> by_heading = bias_by_heading(signals, f.window.span);
    bias = by_heading ? *by_heading : bias_by_positions(signals, f.window.span).value_or(bias);
    SimulatedTurning motion{.first = signals.indices(f.window.span).first};
    motion.forecast_from = static_cast<std::size_t>(
        std::ranges::lower_bound(f.time, f.window.forecast_from - 0.5 * signals.grid.step) - f.time.begin());
    for (Eigen::Index k = 0; k < f.predicted.rows(); ++k) {
      motion.yaw_rate.push_back(f.predicted(k, yaw_rate) - bias);
      motion.lateral_velocity.push_back(lateral < std::ssize(outputs) ? f.predicted(k, lateral) : 0.0);
    }
    windows.push_back(std::move(motion));
  }
  return windows;
}

std::string text_of(const DriveOpenLoop& o, OpenLoopUse use, const EstimatedDriveModel& model) {
  if (!model.missing.empty())
    return fmt::format("nothing was driven open loop: the estimate has no {}", fmt::join(model.missing, ", "));
  if (!o.available())
    return fmt::format("nothing was driven open loop: no unseen stretch lasts {:g} s with all signals",
                       o.times.start_s + estimation::kLeastForecast_s);
  const std::size_t diverged = estimation::diverged_windows(o);
  return fmt::format(
      "{} window{} of {:.0f} s at most ({:.0f} s forecast in all) integrated from {} alone on {}; the first {:g} s of "
      "each give its initial state{}{}",
      o.windows.size(), o.windows.size() == 1 ? "" : "s", o.times.duration_s, o.forecast_s, o.inputs,
      use == OpenLoopUse::kHoldout ? "data that identification did not see" : "another drive than identification's",
      o.times.start_s, o.offsets.empty() ? "" : fmt::format(" and its own {}", fmt::join(o.offsets, ", ")),
      diverged > 0 ? fmt::format("; {} diverged and were cut", diverged) : "");
}

}  // namespace

DriveOpenLoop drive_open_loop(const DriveOpenLoopProblem& problem, const DriveOpenLoopOptions& options,
                              Progress& progress) {
  DriveOpenLoop out;
  out.times = options.times;
  out.inputs = "steering and speed";
  if (!options.asked()) return out;
  const EstimatedDriveModel given = fixed_model(problem, options);
  if (given.missing.empty()) {
    for (const DriveUnknown bias : given.options.offsets) out.offsets.emplace_back(kDriveUnknownNames[bias]);
    const Spans spans = spans_of(problem.segments, problem.use);
    const std::vector<TimeSpan> windows = estimation::open_loop_windows(spans.excited, spans.free, options.times);
    const bool hidden = needs_lateral_velocity(problem.signals);
    DriveParametricModel model(hidden ? with_lateral_velocity(problem.signals) : problem.signals, windows,
                               given.vehicle, given.options);
    DriveParametricModel first = model;
    const std::vector<OpenLoopError> errors = errors_of(model, problem.signals, problem.estimate);
    std::vector<bool> judged;
    for (const OpenLoopError& error : errors) judged.push_back(error.white != kUnmeasured);
    const std::vector<OpenLoopForecast> driven =
        estimation::open_loop_forecasts(model, first,
                                        {.covariance = given.covariance,
                                         .errors = errors,
                                         .judged = std::move(judged),
                                         .start_s = options.times.start_s,
                                         .drifting = {std::string(kSegmentBank)}},
                                        progress);
    estimation::add_windows(driven, out);
    const std::array<std::string, 1> one_group{};
    out.states = estimation::open_loop_scores(model.outputs(), driven, one_group,
                                              [](std::string_view) { return std::string(); });
    out.yaw_period_s = yaw_period(given.vehicle, problem.signals, driven);
    out.path = drive_path(problem.signals, turning_of(problem.signals, driven, model.outputs(),
                                                      given.options.start[DriveUnknown::kYawRateBias]));
  }
  out.text = text_of(out, problem.use, given);
  return out;
}

std::vector<estimation::Evidence> open_loop_evidence(const DriveOpenLoop& driven) {
  std::vector<estimation::Evidence> rows;
  if (driven.yaw_period_s) {
    const bool faster_than_steered = *driven.yaw_period_s < kShortestYawPeriod_s;
    std::optional<estimation::Evidence> row = estimation::open_loop_horizon(
        driven, {.period_s = std::max(kShortestYawPeriod_s, *driven.yaw_period_s),
                 .motion = faster_than_steered
                               ? fmt::format("fastest steering, {:g} s (the yaw oscillation's, {:.2g} s, is shorter)",
                                             kShortestYawPeriod_s, *driven.yaw_period_s)
                               : "yaw oscillation"});
    if (row) rows.push_back(std::move(*row));
  }
  for (estimation::Evidence& row :
       estimation::open_loop_errors(driven, "sideways faster than twice forward, 50 rad/s of yaw"))
    rows.push_back(std::move(row));
  return rows;
}

}  // namespace veridyn::vehicle
