#include "veridyn/aircraft/identification/output_error/output_error_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "veridyn/aircraft/identification/output_error/missed_gusts.hpp"
#include "veridyn/core/assert.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/filters.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::aircraft {
namespace {

/// Grids at least this fast are integrated two points at a time.
constexpr double kFastGrid_Hz = 80.0;
/// A shorter stretch holds less information than its initial state takes.
constexpr double kLeastDuration_s = 2.0;
/// Prior of a constant that is added to a coefficient.
constexpr double kConstantSigma = 0.05;

constexpr std::array<const char*, 8> kStateNames{"airspeed", "alpha", "beta", "p", "q", "r", "roll", "pitch"};
constexpr std::array<const char*, 8> kStateUnits{"m/s", "rad", "rad", "rad/s", "rad/s", "rad/s", "rad", "rad"};
constexpr std::array<const char*, 3> kForceNames{"accel_x", "accel_y", "accel_z"};

/// Whether one step goes over two intervals of the grid.
bool steps_over_two(const FlightSignals& signals, const OutputErrorModel::Simulation& simulation) {
  return simulation.steps_per_sample == 0 && signals.grid.rate_Hz() >= kFastGrid_Hz;
}

/// Rate of change of the air's velocity at the aircraft, body axes: from the air that the reconstruction found
/// (ground velocity less velocity relative to the air), low-passed.
std::array<std::vector<double>, 3> air_acceleration(const FlightSignals& s) {
  const std::size_t n = s.size();
  std::array<std::vector<double>, 3> wind;
  for (auto& w : wind) w.assign(n, 0.0);
  for (std::size_t k = 0; k < n; ++k) {
    const FlightSample<double> x = s.sample(k);
    const double a = s.alpha_smoothed[k], b = s.beta_smoothed[k], Va = x[FlightSignal::kAirspeed];
    const Eigen::Vector3d relative(Va * std::cos(a) * std::cos(b), Va * std::sin(b), Va * std::sin(a) * std::cos(b));
    const Eigen::Matrix3d R_BN = numerics::R_body_from_ned(s.roll[k], s.pitch[k], s.yaw[k]);
    const Eigen::Vector3d air =
        Eigen::Vector3d(s.vel_north[k], s.vel_east[k], s.vel_down[k]) - R_BN.transpose() * relative;
    for (std::size_t i = 0; i < 3; ++i) wind[i][k] = air(i);
  }
  const numerics::FirKernel kernel = gust_differentiator(s.grid.rate_Hz());
  for (auto& w : wind) w = numerics::filter(w, kernel);
  for (std::size_t k = 0; k < n; ++k) {
    const Eigen::Matrix3d R_BN = numerics::R_body_from_ned(s.roll[k], s.pitch[k], s.yaw[k]);
    const Eigen::Vector3d body = R_BN * Eigen::Vector3d(wind[0][k], wind[1][k], wind[2][k]);
    for (std::size_t i = 0; i < 3; ++i) wind[i][k] = body(i);
  }
  return wind;
}

}  // namespace

OutputErrorModel::OutputErrorModel(const FlightSignals& signals, std::span<const TimeSpan> spans,
                                   const Subject& subject, std::span<const CoefficientModel> coefficients, bool gusts)
    : OutputErrorModel(std::array{FlownSpans{signals, spans, gusts}}, subject, coefficients) {}

OutputErrorModel::OutputErrorModel(std::span<const FlownSpans> flights, const Subject& subject,
                                   std::span<const CoefficientModel> coefficients)
    : OutputErrorModel(flights, subject, coefficients, Simulation{}) {}

OutputErrorModel::OutputErrorModel(std::span<const FlownSpans> flights, const Subject& subject,
                                   std::span<const CoefficientModel> coefficients, Simulation simulation)
    : subject_(subject), coefficients_(coefficients.begin(), coefficients.end()), simulation_(std::move(simulation)) {
  which_.fill(-1);
  constant_.fill(-1);
  for (std::size_t i = 0; i < coefficients_.size(); ++i) {
    const CoefficientModel& model = coefficients_[i];
    const Coefficient c = model.coefficient;
    which_[c] = static_cast<int>(i);
    offset_[c] = parameters_.size();
    for (std::size_t j = 0; j < model.size(); ++j) {
      parameters_.push_back({.name = parameter_name(model.coefficient, model.terms[j]),
                             .unit = model.terms[j].parameter_unit(),
                             .start = std::isfinite(model.values[j]) ? model.values[j] : 0.0,
                             .fixed = simulation_.fixed_parameters});
    }
  }
  for (const Coefficient c : simulation_.offsets) {
    if (modelled(c) == nullptr) continue;
    constant_[c] = static_cast<int>(constants_.size());
    constants_.push_back(c);
  }
  const auto has = [&](Coefficient c) { return modelled(c) != nullptr; };
  simulated_ = {has(Coefficient::kCD), has(Coefficient::kCL), has(Coefficient::kCY), has(Coefficient::kCl),
                has(Coefficient::kCm), has(Coefficient::kCn), has(Coefficient::kCl), has(Coefficient::kCm)};
  forces_ = {has(Coefficient::kCL) && has(Coefficient::kCD), has(Coefficient::kCY), has(Coefficient::kCL)};
  for (std::size_t i = 0; i < kStates; ++i)
    if (simulated_[i]) outputs_.push_back({kStateNames[i], kStateUnits[i]});
  for (std::size_t i = 0; i < 3; ++i)
    if (forces_[i]) outputs_.push_back({kForceNames[i], "m/s^2"});

  const FlightSignals& first = flights.front().signals;
  step_ = steps_over_two(first, simulation_) ? 2.0 * first.grid.step : first.grid.step;
  for (const FlownSpans& flight : flights) add_flight(flight);
}

void OutputErrorModel::add_flight(const FlownSpans& flight) {
  const FlightSignals& signals = flight.signals;
  const AirAcceleration air = flight.gusts ? air_acceleration(signals) : AirAcceleration{};
  for (const TimeSpan& span : flight.spans) {
    const auto [first, last] = signals.indices(span);
    std::size_t begin = first;
    for (std::size_t k = first; k < last; ++k) {
      if (complete(inputs_at(signals, air, k))) continue;
      add_segment(flight, air, begin, k);
      begin = k + 1;
    }
    if (begin < last) add_segment(flight, air, begin, last);
  }
}

OutputErrorModel::GridInputs OutputErrorModel::inputs_at(const FlightSignals& signals, const AirAcceleration& air,
                                                         std::size_t k) const {
  using F = FlightSignal;
  GridInputs d;
  const FlightSample<double> s = signals.sample(k);
  d.state = {s[F::kAirspeed], s[F::kAlpha], s[F::kBeta],     s[F::kP],
             s[F::kQ],        s[F::kR],     signals.roll[k], signals.pitch[k]};
  d.de = s[F::kElevator];
  d.da = s[F::kAileron];
  d.dr = s[F::kRudder];
  d.thrust = s[F::kThrust];
  d.torque = signals.torque.empty() ? 0.0 : signals.torque[k];
  d.rho = signals.air_density[k];
  if (simulation_.own_thrust && !signals.thrust_per_airspeed.empty())
    d.thrust_per_airspeed = signals.thrust_per_airspeed[k];
  d.measured = measured_coefficients(s, subject_, d.rho, d.torque);
  d.force = {s[F::kAx], s[F::kAy], s[F::kAz]};
  if (!air[0].empty()) d.air_acceleration = {air[0][k], air[1][k], air[2][k]};
  return d;
}

bool OutputErrorModel::complete(const GridInputs& d) {
  double sum = d.de + d.da + d.dr + d.thrust + d.torque + d.rho;
  for (const double v : d.state) sum += v;
  for (const double v : d.force) sum += v;
  for (const double v : d.air_acceleration) sum += v;
  for (const double v : {d.measured.CL, d.measured.CD, d.measured.CY, d.measured.Cl, d.measured.Cm, d.measured.Cn})
    sum += v;
  return std::isfinite(sum);
}

OutputErrorModel::GridInputs OutputErrorModel::between(const GridInputs& a, const GridInputs& b, double share) {
  GridInputs m = a;
  const auto mean = [share](double x, double y) { return x + share * (y - x); };
  for (std::size_t i = 0; i < kStates; ++i) m.state[i] = mean(a.state[i], b.state[i]);
  m.de = mean(a.de, b.de);
  m.da = mean(a.da, b.da);
  m.dr = mean(a.dr, b.dr);
  m.thrust = mean(a.thrust, b.thrust);
  m.torque = mean(a.torque, b.torque);
  m.thrust_per_airspeed = mean(a.thrust_per_airspeed, b.thrust_per_airspeed);
  m.rho = mean(a.rho, b.rho);
  m.measured.CL = mean(a.measured.CL, b.measured.CL);
  m.measured.CD = mean(a.measured.CD, b.measured.CD);
  m.measured.CY = mean(a.measured.CY, b.measured.CY);
  m.measured.Cl = mean(a.measured.Cl, b.measured.Cl);
  m.measured.Cm = mean(a.measured.Cm, b.measured.Cm);
  m.measured.Cn = mean(a.measured.Cn, b.measured.Cn);
  for (std::size_t i = 0; i < 3; ++i) m.air_acceleration[i] = mean(a.air_acceleration[i], b.air_acceleration[i]);
  return m;
}

void OutputErrorModel::add_segment(const FlownSpans& flight, const AirAcceleration& air, std::size_t begin,
                                   std::size_t end) {
  const FlightSignals& signals = flight.signals;
  if (static_cast<double>(end - begin) * signals.grid.step < kLeastDuration_s) return;
  const auto at = [&](std::size_t k) { return inputs_at(signals, air, k); };
  Segment segment;
  segment.begin = inputs_.size();
  segment.from_s = signals.grid.at(begin);
  segment.of_flight = flight.name.empty() ? std::string() : " of " + flight.name;
  if (steps_over_two(signals, simulation_)) {
    const std::size_t count = (end - begin - 1) / 2 + 1;
    for (std::size_t k = 0; k + 1 < 2 * count; ++k) inputs_.push_back(at(begin + k));
    segment.samples = static_cast<Eigen::Index>(count);
  } else {
    GridInputs last = at(begin);
    inputs_.push_back(last);
    for (std::size_t k = begin + 1; k < end; ++k) {
      const GridInputs next = at(k);
      inputs_.push_back(between(last, next, 0.5));
      inputs_.push_back(next);
      last = next;
    }
    segment.samples = static_cast<Eigen::Index>(end - begin);
  }
  segment.to_s = segment.from_s + step_ * static_cast<double>(segment.samples - 1);
  for (std::size_t i = 0; i < kStates; ++i) {
    if (!simulated_[i]) continue;
    segment.initial.push_back(
        {.name = fmt::format("{} at {:.1f} s{}", kStateNames[i], segment.from_s, segment.of_flight),
         .unit = kStateUnits[i],
         .start = inputs_[segment.begin].state[i]});
  }
  for (const Coefficient c : constants_) {
    segment.initial.push_back(
        {.name = fmt::format("{} added from {:.1f} s on{}", name_of(c), segment.from_s, segment.of_flight),
         .prior_sigma = kConstantSigma});
  }
  segments_.push_back(std::move(segment));
}

std::string OutputErrorModel::segment_name(std::size_t segment) const {
  const Segment& s = segments_[segment];
  return fmt::format("the segment from {:.1f} to {:.1f} s{}", s.from_s, s.to_s, s.of_flight);
}

TimeSpan OutputErrorModel::segment_span(std::size_t segment) const {
  const Segment& s = segments_[segment];
  return {s.from_s, s.to_s};
}

Eigen::Index OutputErrorModel::samples_before_divergence(std::size_t segment, const Eigen::VectorXd& theta) const {
  estimation::RowMatrix output = estimation::RowMatrix::Constant(samples(segment), outputs_.size(), kNaN);
  (void)simulate(segment, theta, output);
  Eigen::Index flown = 0;
  while (flown < output.rows() && output.row(flown).allFinite()) ++flown;
  return flown;
}

std::vector<estimation::RowMatrix> OutputErrorModel::disturbances(std::size_t segment,
                                                                  const Eigen::VectorXd& theta) const {
  // The difference between two simulations needs no fine steps.
  constexpr double kStep_s = 0.01;
  const int steps = std::max(1, static_cast<int>(std::ceil(step_ / kStep_s - 1e-9)));
  const auto rows = samples(segment), columns = signed_index(outputs_.size()),
             states = signed_index(forecast_outputs());
  std::vector<estimation::RowMatrix> changes(draw_air_ ? air_draws_ : 0);
  estimation::RowMatrix calm(rows, columns), drawn(rows, columns);
  if (changes.empty() || !simulate_in(segment, theta, {}, steps, calm)) return changes;
  for (std::size_t draw = 0; draw < changes.size(); ++draw) {
    const std::vector<std::array<double, 3>> air =
        draw_air_(segment, draw, 2 * static_cast<std::size_t>(rows) - 1, 0.5 * step_);
    if (!simulate_in(segment, theta, air, steps, drawn)) continue;
    changes[draw] = (drawn - calm).leftCols(states);
  }
  return changes;
}

void OutputErrorModel::shorten(std::size_t segment, Eigen::Index samples) {
  Segment& s = segments_[segment];
  VERIDYN_ASSERT(samples >= 1 && samples <= s.samples);
  s.samples = samples;
  s.to_s = s.from_s + step_ * static_cast<double>(samples - 1);
}

std::vector<estimation::RowMatrix> OutputErrorModel::measured() const {
  std::vector<estimation::RowMatrix> tables;
  for (const Segment& s : segments_) {
    estimation::RowMatrix z(s.samples, outputs_.size());
    for (Eigen::Index k = 0; k < s.samples; ++k) {
      const GridInputs& d = inputs_[s.begin + 2 * static_cast<std::size_t>(k)];
      Eigen::Index column = 0;
      for (std::size_t i = 0; i < kStates; ++i)
        if (simulated_[i]) z(k, column++) = d.state[i];
      for (std::size_t i = 0; i < 3; ++i)
        if (forces_[i]) z(k, column++) = d.force[i];
    }
    tables.push_back(std::move(z));
  }
  return tables;
}

}  // namespace veridyn::aircraft
