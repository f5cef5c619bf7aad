#include "veridyn/aircraft/identification/validation/open_loop.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "veridyn/aircraft/identification/output_error/missed_gusts.hpp"
#include "veridyn/aircraft/identification/output_error/output_error_model.hpp"
#include "veridyn/aircraft/model/natural_periods.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/open_loop/open_loop_forecast.hpp"
#include "veridyn/estimation/open_loop/open_loop_scores.hpp"
#include "veridyn/estimation/open_loop/open_loop_windows.hpp"
#include "veridyn/recording/grid_signals.hpp"

namespace veridyn::aircraft {
namespace {

using Eigen::Index;
using estimation::OpenLoopError;
using estimation::OpenLoopForecast;

/// Steps of the integration are at most this long [s]: a roll mode of 30 1/s is then right to 1e-7.
constexpr double kLongestStep_s = 0.002;

constexpr std::uint64_t kGustSeed = 80;

constexpr std::array<const char*, 8> kStates{"airspeed", "alpha", "beta", "p", "q", "r", "roll", "pitch"};

Axis axis_of_state(std::string_view name) {
  return name == "beta" || name == "p" || name == "r" || name == "roll" ? Axis::kLateral : Axis::kLongitudinal;
}

std::string group_of_state(std::string_view name) { return to_string(axis_of_state(name)); }

/// Where windows of an axis lie in a flight. A span that was excited but not found to be in the air is flown as far as
/// it goes.
std::vector<TimeSpan> windows_of(const PreparedFlight& flight, Axis axis, RowUse use,
                                 const estimation::OpenLoopTimes& times) {
  const AxisSegments& segments = flight.segments.of(axis);
  const std::span<const TimeSpan> seen =
      use == RowUse::kHoldout ? std::span<const TimeSpan>(segments.identification) : std::span<const TimeSpan>();
  return estimation::open_loop_windows(spans_of(segments, use), estimation::unseen(flight.segments.airborne, seen),
                                       times);
}

/// The error of a measured state; that of a smoothed signal hardly changes within seconds.
OpenLoopError error_of(std::string_view state, const FlightSignals& signals) {
  using F = FlightSignal;
  const auto of = [&](F which) {
    const double sigma = signals[which].sigma;
    return signals[which].error == ErrorKind::kBerkson ? OpenLoopError{0.0, sigma} : OpenLoopError{sigma, 0.0};
  };
  const auto attitude = [&](double smoothed, const std::vector<double>& angle) {
    if (smoothed > 0.0) return OpenLoopError{0.0, smoothed};
    return OpenLoopError{recording::noise_floor(angle, signals.grid.rate_Hz()), 0.0};
  };
  if (state == "airspeed") return of(F::kAirspeed);
  if (state == "alpha") return of(F::kAlpha);
  if (state == "beta") return of(F::kBeta);
  if (state == "p") return of(F::kP);
  if (state == "q") return of(F::kQ);
  if (state == "r") return of(F::kR);
  return state == "roll" ? attitude(signals.roll_sigma, signals.roll) : attitude(signals.pitch_sigma, signals.pitch);
}

/// The errors of the states that are simulated, none of them zero.
std::vector<OpenLoopError> errors_of(const OutputErrorModel& model, const FlightSignals& signals) {
  std::vector<OpenLoopError> errors;
  for (std::size_t j = 0; j < model.forecast_outputs(); ++j) {
    const estimation::ModelOutput& output = model.outputs()[j];
    OpenLoopError error = error_of(output.name, signals);
    // Where a signal has no error, rounding is one.
    if (!(error.white + error.lasting > 0.0)) error = {output.unit == "m/s" ? 1e-6 : 1e-8, 0.0};
    errors.push_back(error);
  }
  return errors;
}

/// View of one axis of a flight, with what is known of the model.
struct AxisFlight {
  const PreparedFlight& flight;
  Axis axis;
  const Subject& subject;
  std::span<const CoefficientModel> models;
  const Eigen::MatrixXd& covariance;  ///< of the models' parameters
  const OpenLoopOptions& options;
};

/// What drives a flight and is not among the inputs of its simulation.
MissedGusts missed_gusts(const AxisFlight& of, std::span<const TimeSpan> windows, bool gusts) {
  const FlightSignals& signals = of.flight.signals;
  double airspeed = 0.0, density = 0.0, count = 0.0;
  for (const TimeSpan& window : windows) {
    const auto [first, last] = signals.indices(window);
    for (std::size_t k = first; k < last; ++k) {
      const double Va = signals[FlightSignal::kAirspeed].value[k], rho = signals.air_density[k];
      if (!std::isfinite(Va + rho)) continue;
      airspeed += Va;
      density += rho;
      count += 1.0;
    }
  }
  airspeed = std::max(1.0, airspeed / std::max(1.0, count));
  density /= std::max(1.0, count);
  std::array<double, 3> noise{kInfinity, kInfinity, kInfinity};
  for (const SensorReport& sensor : of.flight.reconstruction.sensors) {
    if (!(sensor.rate_Hz > 0.0)) continue;
    const auto seen = [&](std::size_t axis, double sigma) { noise[axis] = 2.0 * sigma * sigma / sensor.rate_Hz; };
    if (sensor.channel == "airspeed") seen(0, sensor.sigma);
    if (sensor.channel == "dynamic_pressure" && density > 0.0) seen(0, sensor.sigma / (density * airspeed));
    if (sensor.channel == "beta") seen(1, sensor.sigma * airspeed);
    if (sensor.channel == "alpha") seen(2, sensor.sigma * airspeed);
  }
  // Who says that the air was calm is believed.
  const bool calm = of.options.gusts == false;
  const numerics::FirKernel input = gust_differentiator(signals.grid.rate_Hz());
  return {calm ? DrydenSettings{} : of.flight.reconstruction.turbulence, airspeed, noise, gusts ? &input : nullptr};
}

/// All windows of an axis of a flight.
std::vector<OpenLoopForecast> flown_axis(const AxisFlight& of, RowUse use, Progress& progress,
                                         std::vector<estimation::ModelOutput>& states) {
  const estimation::OpenLoopTimes times{of.options.duration_s, of.options.start_s};
  const std::vector<TimeSpan> windows = windows_of(of.flight, of.axis, use, times);
  const FlightSignals& signals = of.flight.signals;
  const bool gusts = of.options.gusts.value_or(signals.over_ground);
  const std::array spans{OutputErrorModel::FlownSpans{signals, windows, gusts, of.flight.name}};
  OutputErrorModel model(
      spans, of.subject, of.models,
      {.fixed_parameters = true,
       .stall = true,
       .own_thrust = true,
       .offsets = of.options.offsets,
       .steps_per_sample = std::max(1, static_cast<int>(std::ceil(signals.grid.step / kLongestStep_s - 1e-9)))});
  if (const MissedGusts missed = missed_gusts(of, windows, gusts); missed.any()) {
    // So many give a standard deviation to 8 %.
    constexpr std::size_t kDraws = 80;
    model.set_air_draws(kDraws, [missed](std::size_t segment, std::size_t draw, std::size_t points, double step_s) {
      numerics::RandomStream random(kGustSeed, kDraws * segment + draw);
      return missed.acceleration(points, step_s, random);
    });
  }
  states.assign(model.outputs().begin(), model.outputs().begin() + signed_index(model.forecast_outputs()));
  const std::vector<OpenLoopError> errors = errors_of(model, signals);
  std::vector<bool> judged;
  for (const estimation::ModelOutput& state : states) judged.push_back(axis_of_state(state.name) == of.axis);
  OutputErrorModel first = model;
  return estimation::open_loop_forecasts(model, first,
                                         {.covariance = of.covariance,
                                          .errors = errors,
                                          .judged = std::move(judged),
                                          .start_s = times.start_s,
                                          .stride = signals.stride,
                                          .recording = of.flight.name,
                                          .group = to_string(of.axis),
                                          .shift_s = of.flight.shift_s},
                                         progress);
}

/// The scores of the states in windows of their axis, longitudinal first.
std::vector<estimation::OpenLoopState> scored(std::span<const estimation::ModelOutput> states,
                                              std::span<const OpenLoopForecast> flown) {
  const std::array<std::string, 2> groups{to_string(Axis::kLongitudinal), to_string(Axis::kLateral)};
  return estimation::open_loop_scores(states, flown, groups, group_of_state);
}

/// The covariance of the parameters of all models, by name.
Eigen::MatrixXd covariance_of(std::span<const CoefficientModel> models, const estimation::Estimate& estimate) {
  std::vector<Index> place;
  for (const CoefficientModel& model : models) {
    for (const std::string& name : model.parameter_names()) {
      const auto found = std::ranges::find(estimate.parameters, name, &estimation::Parameter::name);
      place.push_back(found == estimate.parameters.end() ? -1 : found - estimate.parameters.begin());
    }
  }
  const auto n = signed_index(place.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      const Index a = place[i], b = place[j];
      if (a < 0 || b < 0 || a >= estimate.covariance.rows() || b >= estimate.covariance.rows()) continue;
      const double v = estimate.covariance(a, b);
      if (std::isfinite(v)) covariance(i, j) = v;
    }
  }
  return covariance;
}

/// The periods at the mean of what was flown.
NaturalPeriods periods_of(std::span<const PreparedFlight> flights, std::span<const OpenLoopForecast> flown,
                          const Subject& subject) {
  FlightSample<double> mean;
  double count = 0.0, rho = 0.0;
  for (const OpenLoopForecast& f : flown) {
    const auto flight = std::ranges::find(flights, f.window.recording, &PreparedFlight::name);
    const auto [first, last] = flight->signals.indices(f.window.span);
    for (std::size_t k = first; k < last; ++k) {
      const FlightSample<double> sample = flight->signals.sample(k);
      if (!std::isfinite(std::accumulate(sample.value.begin(), sample.value.end(), 0.0))) continue;
      for (std::size_t i = 0; i < kFlightSignals; ++i) mean.value[i] += sample.value[i];
      rho += flight->signals.air_density[k];
      count += 1.0;
    }
  }
  if (!(count > 0.0)) return {};
  for (std::size_t i = 0; i < kFlightSignals; ++i) mean.value[i] /= count;
  return natural_periods(subject, aero_variables(mean, subject, rho / count), rho / count);
}

/// The air that drives the model, and what the bands know of it.
std::string air_of(const OpenLoop& o, bool gusts) {
  if (gusts) return "reconstructed gusts";
  if (o.air_known) return "calm air";
  return o.air_in_bands ? "calm air, since no gusts are known: the bands hold what may have blown"
                        : "calm air, since no gusts are known: the bands do not hold them, and are too narrow";
}

std::string text_of(const OpenLoop& o, bool gusts, bool any_model) {
  if (!o.available())
    return fmt::format("nothing was flown open loop: {}",
                       any_model ? fmt::format("no unseen stretch lasts {:g} s with all signals",
                                               o.options.start_s + estimation::kLeastForecast_s)
                                 : "no coefficient that moves a state was identified");
  const std::size_t diverged = estimation::diverged_windows(o);
  return fmt::format(
      "{} window{} of {:.0f} s at most ({:.0f} s forecast in all) integrated from deflections and thrust alone on data "
      "that identification did not see; the first {:g} s of each give its initial state{}; {}{}{}",
      o.windows.size(), o.windows.size() == 1 ? "" : "s", o.options.duration_s, o.forecast_s, o.options.start_s,
      o.options.offsets.empty() ? "" : " and the constants of its own", air_of(o, gusts),
      o.driven.empty() ? ""
                       : fmt::format("; as measured, since no coefficient moves them: {}", fmt::join(o.driven, ", ")),
      diverged > 0 ? fmt::format("; {} diverged and were cut", diverged) : "");
}

}  // namespace

OpenLoop fly_open_loop(std::span<const PreparedFlight> flights, RowUse use, const Subject& subject,
                       std::span<const Coefficient> known, const estimation::Estimate& estimate,
                       const OpenLoopOptions& options, Progress& progress) {
  OpenLoop out;
  out.options = options;
  out.times = {options.duration_s, options.start_s};
  out.inputs = "deflections and thrust";
  if (!options.asked()) return out;
  std::vector<CoefficientModel> models;
  for (const Coefficient c : known)
    if (const CoefficientModel* model = subject.model.find(c)) models.push_back(*model);
  for (const Coefficient c : options.offsets)
    if (std::ranges::find(models, c, &CoefficientModel::coefficient) != models.end())
      out.offsets.emplace_back(name_of(c));
  const Eigen::MatrixXd covariance = covariance_of(models, estimate);
  std::vector<OpenLoopForecast> flown;
  std::vector<estimation::ModelOutput> states;
  bool gusts = false;
  for (const Axis axis : {Axis::kLongitudinal, Axis::kLateral}) {
    for (const PreparedFlight& flight : flights) {
      if (!flight.usable() || models.empty() || progress.interrupted()) continue;
      gusts = gusts || options.gusts.value_or(flight.signals.over_ground);
      const bool air = options.gusts.has_value() || flight.signals.over_ground;
      out.air_known = out.air_known && air;
      out.air_in_bands = out.air_in_bands && (air || !flight.reconstruction.turbulence.calm());
      const AxisFlight of{flight, axis, subject, models, covariance, options};
      for (OpenLoopForecast& f : flown_axis(of, use, progress, states)) flown.push_back(std::move(f));
    }
  }
  out.states = scored(states, flown);
  estimation::add_windows(flown, out);
  for (const char* name : kStates)
    if (!states.empty() && std::ranges::find(states, name, &estimation::ModelOutput::name) == states.end())
      out.driven.emplace_back(name);
  if (flights.size() > 1) {
    for (const PreparedFlight& flight : flights) {
      std::vector<OpenLoopForecast> own;
      std::ranges::copy_if(flown, std::back_inserter(own),
                           [&](const OpenLoopForecast& f) { return f.window.recording == flight.name; });
      if (!own.empty()) out.by_recording.push_back({flight.name, scored(states, own)});
    }
  }
  const NaturalPeriods periods = periods_of(flights, flown, subject);
  out.short_period_s = periods.short_period_s;
  out.dutch_roll_s = periods.dutch_roll_s;
  out.text = text_of(out, gusts, !models.empty());
  return out;
}

}  // namespace veridyn::aircraft
