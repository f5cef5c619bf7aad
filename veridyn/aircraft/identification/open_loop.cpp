#include "veridyn/aircraft/identification/open_loop.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "veridyn/aircraft/identification/output_error_model.hpp"
#include "veridyn/aircraft/model/natural_periods.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/recording/grid_signals.hpp"

namespace veridyn::aircraft {
namespace {

using Eigen::Index;
using estimation::RowMatrix;

/// Steps of the integration are at most this long [s]: a roll mode of 30 1/s is then right to 1e-7.
constexpr double kLongestStep_s = 0.002;
/// A forecast that is shorter tells nothing [s].
constexpr double kLeastForecast_s = 2.0;
/// The band is left where over so long [s] ...
constexpr double kLeft_s = 0.5;
/// ... the error is larger than so many sigma (RMS): noise that is white over that time does not get there, and what
/// all of its samples share once in 370 times.
constexpr double kLeft_sigma = estimation::kBeyondChance;
constexpr double kBand95 = 1.959963984540054;

constexpr std::array<const char*, 8> kStates{"airspeed", "alpha", "beta", "p", "q", "r", "roll", "pitch"};

Axis axis_of_state(std::string_view name) {
  return name == "beta" || name == "p" || name == "r" || name == "roll" ? Axis::kLateral : Axis::kLongitudinal;
}

const char* shown_unit(std::string_view unit) { return unit == "rad" ? "deg" : unit == "rad/s" ? "deg/s" : "m/s"; }
double shown_factor(std::string_view unit) { return unit == "m/s" ? 1.0 : 1.0 / kDegree; }

/// The rest of `air` without `seen`.
std::vector<TimeSpan> unseen(std::span<const TimeSpan> air, std::span<const TimeSpan> seen) {
  std::vector<TimeSpan> left;
  for (TimeSpan span : air) {
    for (const TimeSpan& s : seen) {
      if (s.end <= span.begin || s.begin >= span.end) continue;
      if (s.begin > span.begin) left.push_back({span.begin, s.begin});
      span.begin = std::max(span.begin, s.end);
    }
    if (span.end > span.begin) left.push_back(span);
  }
  return left;
}

/// Where windows of an axis lie in a flight.
std::vector<TimeSpan> windows_of(const PreparedFlight& flight, Axis axis, RowUse use, const OpenLoopOptions& options) {
  const AxisSegments& segments = flight.segments.of(axis);
  const std::span<const TimeSpan> seen =
      use == RowUse::kHoldout ? std::span<const TimeSpan>(segments.identification) : std::span<const TimeSpan>();
  const std::vector<TimeSpan> free = unseen(flight.segments.airborne, seen);
  std::vector<TimeSpan> windows;
  double next = -kInfinity;
  for (const TimeSpan& span : spans_of(segments, use)) {
    double begin = std::max(span.begin, next);
    while (begin + options.start_s + kLeastForecast_s <= span.end) {
      // A span that was excited but not found to be in the air is flown as far as it goes.
      double end = span.end;
      for (const TimeSpan& f : free)
        if (f.begin <= begin && f.end >= begin) end = std::max(end, f.end);
      end = std::min(end, begin + options.duration_s);
      if (end - begin < options.start_s + kLeastForecast_s) break;
      windows.push_back({begin, end});
      next = begin = end;
    }
  }
  return windows;
}

/// The error of a measured state: its standard deviation [SI], and whether it hardly changes within seconds.
struct StateError {
  double sigma = 0.0;
  bool slow = false;
};

StateError error_of(std::string_view state, const FlightSignals& signals) {
  using F = FlightSignal;
  const auto of = [&](F which) {
    return StateError{signals[which].sigma, signals[which].error == ErrorKind::kBerkson};
  };
  const auto attitude = [&](double smoothed, const std::vector<double>& angle) {
    if (smoothed > 0.0) return StateError{smoothed, true};
    return StateError{recording::noise_floor(angle, signals.grid.rate_Hz()), false};
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
std::vector<StateError> errors_of(const OutputErrorModel& model, const FlightSignals& signals) {
  std::vector<StateError> errors;
  for (std::size_t j = 0; j < model.simulated_states(); ++j) {
    const estimation::ModelOutput& output = model.outputs()[j];
    StateError error = error_of(output.name, signals);
    // Where a signal has no error, rounding is one.
    if (!(error.sigma > 0.0)) error = {output.unit == "m/s" ? 1e-6 : 1e-8, false};
    errors.push_back(error);
  }
  return errors;
}

/// A window as it was flown: a row a sample, a column a state that is simulated.
struct Flown {
  OpenLoopWindow window;
  double shift_s = 0.0;
  std::vector<double> time;  ///< its flight's own
  RowMatrix measured, predicted, sigma;
};

/// View of one axis of a flight, with what is known of the model.
struct AxisFlight {
  const PreparedFlight& flight;
  Axis axis;
  const Subject& subject;
  std::span<const CoefficientModel> models;
  const Eigen::MatrixXd& covariance;  ///< of the models' parameters
  const OpenLoopOptions& options;
};

/// The parameters and the initial conditions at which a segment starts, before these are estimated.
Eigen::VectorXd start_of(const OutputErrorModel& model, std::size_t segment) {
  std::vector<double> theta;
  for (const estimation::ModelParameter& p : model.parameters()) theta.push_back(p.start);
  for (const estimation::ModelParameter& p : model.initial_conditions(segment)) theta.push_back(p.start);
  return Eigen::Map<const Eigen::VectorXd>(theta.data(), signed_index(theta.size()));
}

/// Derivatives of the states alone with respect to everything, (samples states) x unknowns; empty where it diverges.
struct Response {
  RowMatrix states;                        ///< samples x states
  Eigen::MatrixXd parameters, conditions;  ///< row k states + j
};

Response response_of(const OutputErrorModel& model, std::size_t segment, const Eigen::VectorXd& theta) {
  std::vector<Index> active(at(theta.size()));
  std::iota(active.begin(), active.end(), Index{0});
  estimation::ModelResponse all;
  if (!model.respond(segment, theta, active, all)) return {};
  const auto states = signed_index(model.simulated_states()), outputs = signed_index(model.outputs().size());
  const auto shared = signed_index(model.parameters().size());
  Response out{.states = all.output.leftCols(states),
               .parameters = Eigen::MatrixXd(all.output.rows() * states, shared),
               .conditions = Eigen::MatrixXd(all.output.rows() * states, theta.size() - shared)};
  for (Index k = 0; k < all.output.rows(); ++k) {
    const auto rows = all.sensitivity.middleRows(k * outputs, states);
    out.parameters.middleRows(k * states, states) = rows.leftCols(shared);
    out.conditions.middleRows(k * states, states) = rows.rightCols(theta.size() - shared);
  }
  return out;
}

/// What the first seconds of a window say of where it starts.
struct Start {
  Eigen::VectorXd theta;            ///< parameters, initial state, offsets
  Eigen::MatrixXd covariance;       ///< of initial state and offsets where the parameters are right
  Eigen::MatrixXd with_parameters;  ///< their change with the parameters, as they are fitted again
};

/// The covariance of what was fitted, and how it follows the parameters.
void add_covariance(const OutputErrorModel& model, std::size_t segment, const Eigen::VectorXd& weights,
                    std::span<const Index> rows, Start& start) {
  const auto states = signed_index(model.simulated_states());
  const auto shared = signed_index(model.parameters().size()), own = start.theta.size() - shared;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(own, own), cross = Eigen::MatrixXd::Zero(own, shared);
  for (Index i = 0; i < own; ++i)
    information(i, i) = std::pow(model.initial_conditions(segment)[at(i)].prior_sigma, -2.0);
  const Response r = response_of(model, segment, start.theta);
  if (r.states.rows() > 0) {
    for (const Index k : rows) {
      const auto A = r.conditions.middleRows(k * states, states), B = r.parameters.middleRows(k * states, states);
      information += A.transpose() * weights.asDiagonal() * A;
      cross += A.transpose() * weights.asDiagonal() * B;
    }
  }
  const Eigen::LDLT<Eigen::MatrixXd> solver(information);
  start.covariance = solver.solve(Eigen::MatrixXd::Identity(own, own));
  start.with_parameters = -solver.solve(cross);
}

/// Initial states and offsets of all windows, from their first seconds.
std::vector<Start> starts_of(const OutputErrorModel& model, const AxisFlight& of, std::span<const StateError> errors,
                             Progress& progress) {
  OutputErrorModel first = model;
  const auto states = signed_index(errors.size());
  const auto stride = signed_index(of.flight.signals.stride);
  std::vector<RowMatrix> measured = model.measured();
  std::vector<std::vector<Index>> rows(model.segments());
  std::vector<Start> starts;
  for (std::size_t s = 0; s < model.segments(); ++s) {
    starts.push_back({.theta = start_of(model, s), .covariance = {}, .with_parameters = {}});
    const auto wanted = static_cast<Index>(std::round(of.options.start_s / model.sample_interval_s())) + 1;
    first.shorten(s, std::min(wanted, model.samples(s)));
    first.shorten(s, std::max<Index>(1, first.samples_before_divergence(s, starts[s].theta)));
    // Samples within the filters' memory of each other tell the same.
    for (Index k = 0; k < first.samples(s); k += stride) rows[s].push_back(k);
    RowMatrix thinned = RowMatrix::Constant(first.samples(s), measured[s].cols(), kNaN);
    for (const Index k : rows[s]) thinned.row(k).head(states) = measured[s].row(k).head(states);
    measured[s] = std::move(thinned);
  }
  const double count = static_cast<double>(std::ranges::max(rows, {}, &std::vector<Index>::size).size());
  estimation::OutputErrorOptions fit;
  fit.noise = estimation::OutputNoise::kGiven;
  fit.covariance = estimation::CovarianceKind::kWhite;
  fit.noise_start = Eigen::VectorXd::Ones(signed_index(model.outputs().size()));
  for (std::size_t j = 0; j < errors.size(); ++j)
    fit.noise_start(signed_index(j)) = errors[j].sigma * (errors[j].slow ? std::sqrt(count) : 1.0);
  const estimation::OutputErrorEstimate fitted = estimation::output_error(first, measured, fit, progress);
  if (fitted.has_estimate()) {
    std::vector<Index> place(model.segments(), signed_index(model.parameters().size()));
    for (const estimation::SegmentParameter& p : fitted.segment_parameters)
      starts[p.segment].theta(place[p.segment]++) = p.value;
  }
  const Eigen::VectorXd weights = fit.noise_start.head(states).cwiseAbs2().cwiseInverse();
  for (std::size_t s = 0; s < model.segments(); ++s) add_covariance(first, s, weights, rows[s], starts[s]);
  return starts;
}

/// The sample at which the band is left, looking `ahead` samples on; the number of all where that never happens.
Index samples_inside(const Eigen::VectorXd& error, const Eigen::VectorXd& sigma, Index from, Index ahead) {
  const Eigen::VectorXd squares = error.cwiseQuotient(sigma).cwiseAbs2();
  const double limit = kLeft_sigma * kLeft_sigma * static_cast<double>(ahead);
  for (Index k = from; k + ahead <= squares.size(); ++k)
    if (squares.segment(k, ahead).sum() > limit) return k;
  return squares.size();
}

/// A window from its start on.
Flown flown_window(OutputErrorModel& model, std::size_t segment, const Start& start, const RowMatrix& measured,
                   std::span<const StateError> errors, const AxisFlight& of) {
  const auto states = signed_index(errors.size());
  const double interval = model.sample_interval_s();
  Flown out;
  out.shift_s = of.flight.shift_s;
  OpenLoopWindow& window = out.window;
  window.flight = of.flight.name;
  window.axis = of.axis;
  window.span = model.segment_span(segment);
  window.forecast_from = std::min(window.span.end, window.span.begin + of.options.start_s);
  const Index flown = model.samples_before_divergence(segment, start.theta);
  window.diverged = flown < model.samples(segment);
  model.shorten(segment, std::max<Index>(1, flown));
  std::size_t i = model.parameters().size();
  for (const estimation::ModelParameter& p : model.initial_conditions(segment))
    window.start.push_back({segment, p.name, p.unit, start.theta(signed_index(i++))});
  const Response r = response_of(model, segment, start.theta);
  const Index n = r.states.rows();
  out.measured = measured.topLeftCorner(n, states);
  out.predicted = r.states;
  out.sigma = RowMatrix::Zero(n, states);
  for (Index k = 0; k < n; ++k) {
    out.time.push_back(window.span.begin + interval * static_cast<double>(k));
    const Eigen::MatrixXd S = r.conditions.middleRows(k * states, states);
    const Eigen::MatrixXd g = r.parameters.middleRows(k * states, states) + S * start.with_parameters;
    for (Index j = 0; j < states; ++j) {
      const double parameters = g.row(j).dot(of.covariance * g.row(j).transpose());
      const double beginning = S.row(j).dot(start.covariance * S.row(j).transpose());
      const double sensor = errors[at(j)].sigma;
      out.sigma(k, j) = std::sqrt(std::max(0.0, parameters) + std::max(0.0, beginning) + sensor * sensor);
    }
  }
  window.first_left_s = kInfinity;
  const auto from = static_cast<Index>(std::round(of.options.start_s / interval));
  const auto ahead = std::max<Index>(1, static_cast<Index>(std::round(kLeft_s / interval)));
  for (Index j = 0; j < states; ++j) {
    const Index inside = samples_inside(out.predicted.col(j) - out.measured.col(j), out.sigma.col(j), from, ahead);
    window.horizon_s.push_back(interval * static_cast<double>(std::max<Index>(0, std::min(inside, n - 1) - from)));
    if (axis_of_state(model.outputs()[at(j)].name) == of.axis)
      window.first_left_s = std::min(window.first_left_s, window.horizon_s.back());
  }
  return out;
}

/// All windows of an axis of a flight.
std::vector<Flown> flown_axis(const AxisFlight& of, RowUse use, Progress& progress,
                              std::vector<estimation::ModelOutput>& states) {
  const std::vector<TimeSpan> windows = windows_of(of.flight, of.axis, use, of.options);
  const FlightSignals& signals = of.flight.signals;
  const bool gusts = of.options.gusts.value_or(signals.over_ground);
  const std::array spans{OutputErrorModel::FlownSpans{signals, windows, gusts, of.flight.name}};
  OutputErrorModel model(
      spans, of.subject, of.models,
      {.fixed_parameters = true,
       .stall = true,
       .offsets = of.options.offsets,
       .steps_per_sample = std::max(1, static_cast<int>(std::ceil(signals.grid.step / kLongestStep_s - 1e-9)))});
  states.assign(model.outputs().begin(), model.outputs().begin() + signed_index(model.simulated_states()));
  if (model.segments() == 0) return {};
  const std::vector<StateError> errors = errors_of(model, signals);
  const std::vector<Start> starts = starts_of(model, of, errors, progress);
  const std::vector<RowMatrix> measured = model.measured();
  std::vector<Flown> flown(model.segments());
  estimation::for_each_segment(model, progress.threads(), [&](std::size_t s) {
    flown[s] = flown_window(model, s, starts[s], measured[s], errors, of);
  });
  // Stretches between holes that are too short to forecast anything.
  std::erase_if(flown, [&](const Flown& f) {
    return f.window.span.end - f.window.forecast_from < kLeastForecast_s && !f.window.diverged;
  });
  return flown;
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
      const Index a = place[at(i)], b = place[at(j)];
      if (a < 0 || b < 0 || a >= estimate.covariance.rows() || b >= estimate.covariance.rows()) continue;
      const double v = estimate.covariance(a, b);
      if (std::isfinite(v)) covariance(i, j) = v;
    }
  }
  return covariance;
}

double median_of(std::vector<double> values) {
  std::ranges::sort(values);
  return values.empty() ? kNaN : numerics::quantile_of_sorted(values, 0.5);
}

/// The scores of one state over windows.
OpenLoopState scored(const estimation::ModelOutput& output, std::size_t column, std::span<const Flown> flown) {
  const auto j = signed_index(column);
  OpenLoopState state{.name = output.name, .unit = shown_unit(output.unit), .axis = axis_of_state(output.name)};
  const double factor = shown_factor(output.unit);
  std::vector<double> measured, predicted, horizons;
  double inside = 0.0;
  for (const Flown& f : flown) {
    if (f.window.axis != state.axis) continue;
    ++state.windows;
    const double horizon = f.window.horizon_s[column];
    horizons.push_back(horizon);
    if (!f.window.diverged && f.window.forecast_from + horizon >= f.window.span.end - 1e-6) ++state.held;
    for (Index k = 0; k < f.measured.rows(); ++k) {
      const double t = f.time[at(k)];
      const bool forecast = t >= f.window.forecast_from;
      state.time.push_back(t + f.shift_s);
      state.measured.push_back(f.measured(k, j));
      state.predicted.push_back(f.predicted(k, j));
      state.sigma.push_back(forecast ? f.sigma(k, j) : kNaN);
      if (!forecast) continue;
      measured.push_back(factor * f.measured(k, j));
      predicted.push_back(factor * f.predicted(k, j));
      if (std::abs(f.measured(k, j) - f.predicted(k, j)) <= kBand95 * f.sigma(k, j)) inside += 1.0;
    }
    // A gap between windows, so that no line is drawn across the restart.
    state.time.push_back(f.time.back() + f.shift_s);
    for (auto* series : {&state.measured, &state.predicted, &state.sigma}) series->push_back(kNaN);
  }
  state.fit = numerics::fit_measures(measured, predicted);
  state.shares = numerics::theil_shares(measured, predicted);
  state.normalised_rmse = std::sqrt(std::max(0.0, 1.0 - state.fit.r2));
  state.inside = inside / std::max(1.0, static_cast<double>(measured.size()));
  state.horizon_s = median_of(std::move(horizons));
  return state;
}

std::vector<OpenLoopState> scored(std::span<const estimation::ModelOutput> outputs, std::span<const Flown> flown) {
  std::vector<OpenLoopState> states;
  for (const Axis axis : {Axis::kLongitudinal, Axis::kLateral}) {
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      if (axis_of_state(outputs[i].name) != axis) continue;
      OpenLoopState state = scored(outputs[i], i, flown);
      if (state.fit.count > 0) states.push_back(std::move(state));
    }
  }
  return states;
}

/// The periods at the mean of what was flown.
NaturalPeriods periods_of(std::span<const PreparedFlight> flights, std::span<const Flown> flown,
                          const Subject& subject) {
  FlightSample<double> mean;
  double count = 0.0, rho = 0.0;
  for (const Flown& f : flown) {
    const auto flight = std::ranges::find(flights, f.window.flight, &PreparedFlight::name);
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

std::string text_of(const OpenLoop& o, bool gusts, bool any_model) {
  if (!o.available())
    return fmt::format(
        "nothing was flown open loop: {}",
        any_model ? fmt::format("no unseen stretch lasts {:g} s with all signals", o.options.start_s + kLeastForecast_s)
                  : "no coefficient that moves a state was identified");
  const auto diverged = std::ranges::count(o.windows, true, &OpenLoopWindow::diverged);
  return fmt::format(
      "{} windows of {:.0f} s at most ({:.0f} s forecast in all) integrated from deflections and thrust alone on data "
      "that identification did not see; the first {:g} s of each give its initial state{}; {}{}{}",
      o.windows.size(), o.options.duration_s, o.forecast_s, o.options.start_s,
      o.options.offsets.empty() ? "" : " and the constants of its own", gusts ? "reconstructed gusts" : "calm air",
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
  if (!options.asked()) return out;
  std::vector<CoefficientModel> models;
  for (const Coefficient c : known)
    if (const CoefficientModel* model = subject.model.find(c)) models.push_back(*model);
  std::ranges::copy_if(options.offsets, std::back_inserter(out.offsets), [&](Coefficient c) {
    return std::ranges::find(models, c, &CoefficientModel::coefficient) != models.end();
  });
  const Eigen::MatrixXd covariance = covariance_of(models, estimate);
  std::vector<Flown> flown;
  std::vector<estimation::ModelOutput> states;
  bool gusts = false;
  for (const Axis axis : {Axis::kLongitudinal, Axis::kLateral}) {
    for (const PreparedFlight& flight : flights) {
      if (!flight.usable() || models.empty() || progress.interrupted()) continue;
      gusts = gusts || options.gusts.value_or(flight.signals.over_ground);
      out.air_known = out.air_known && (options.gusts.has_value() || flight.signals.over_ground);
      const AxisFlight of{flight, axis, subject, models, covariance, options};
      for (Flown& f : flown_axis(of, use, progress, states)) flown.push_back(std::move(f));
    }
  }
  out.states = scored(states, flown);
  for (const Flown& f : flown) {
    out.windows.push_back(f.window);
    out.forecast_s += f.window.span.end - f.window.forecast_from;
  }
  for (const char* name : kStates)
    if (!states.empty() && std::ranges::find(states, name, &estimation::ModelOutput::name) == states.end())
      out.driven.emplace_back(name);
  if (flights.size() > 1) {
    for (const PreparedFlight& flight : flights) {
      std::vector<Flown> own;
      std::ranges::copy_if(flown, std::back_inserter(own),
                           [&](const Flown& f) { return f.window.flight == flight.name; });
      if (!own.empty()) out.by_flight.push_back({flight.name, scored(states, own)});
    }
  }
  const NaturalPeriods periods = periods_of(flights, flown, subject);
  out.short_period_s = periods.short_period_s;
  out.dutch_roll_s = periods.dutch_roll_s;
  out.text = text_of(out, gusts, !models.empty());
  return out;
}

}  // namespace veridyn::aircraft
