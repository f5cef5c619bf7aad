#include "veridyn/aircraft/identification/fit/flight_delays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "veridyn/aircraft/identification/fit/manoeuvre_delays.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/judgement/limits.hpp"
#include "veridyn/recording/time_order.hpp"

namespace veridyn::aircraft {
namespace {

constexpr SensorErrorKind kDelay = SensorErrorKind::kDelay;

bool is_surface(BudgetSensor sensor) {
  return sensor == BudgetSensor::kElevator || sensor == BudgetSensor::kAileron || sensor == BudgetSensor::kRudder;
}

DelayReport* report_of(std::vector<DelayReport>& reports, BudgetSensor sensor) {
  const auto found = std::ranges::find(reports, kBudgetSensorNames[sensor], &DelayReport::group);
  return found == reports.end() ? nullptr : &*found;
}

/// About the stamps as they are: what was given or aligned is off them.
SensorError prior_about_stamps(BudgetSensor sensor, const DelayAlignment& options, const KnownSensors& known) {
  SensorError prior = prior_of(sensor, kDelay, known);
  const bool given = options.given_for(kBudgetSensorNames[sensor]).has_value();
  if (!options.automatic || (given && known.find(sensor, kDelay) == nullptr)) prior.sigma = 0.0;
  if (given) prior.mean = 0.0;
  return prior;
}

/// The prior after what the alignment says of the sensor itself, not by way of others. A deflection that is aligned
/// while a vane is not may be far off: what it says is a place to look at, which the prior is moved to where the
/// deflection is recorded after its effect. Manoeuvres alone look for it near the prior's mean and, 50 ms late, find
/// the wrong side of it.
SensorError after_alignment(SensorError prior, const DelayReport* report) {
  /// Between samples, and by what moves with it.
  constexpr double kAlignedTo_s = 0.005;
  if (report == nullptr || !report->determined()) return prior;
  if (is_surface(prior.sensor)) {
    if (prior.sigma > 0.0 && recording::is_early(*report, {.early_s = prior.sigma})) {
      prior.mean = -report->delay_s;
      prior.sigma = std::hypot(prior.sigma, report->sigma_s);
    }
    return prior;
  }
  // Of the prior about zero, seen from the stamps, off which what was applied is.
  const double applied = report->applied() ? report->delay_s : 0.0;
  prior.mean -= applied;
  return updated(prior, report->delay_s - applied, std::hypot(report->sigma_s, kAlignedTo_s));
}

/// A surface's lag behind what is recorded of it; known, as all is, where nothing is to be estimated. What jumps from
/// one sample to the next is no position but a command.
SensorError lag_of(BudgetSensor surface, bool jumps, const DelayAlignment& options, const KnownSensors& known) {
  constexpr double kOfServo_s = 0.05, kOfServoSigma_s = 0.03;
  SensorError prior = prior_of(surface, SensorErrorKind::kLag, known);
  if (known.find(surface, SensorErrorKind::kLag) != nullptr) return prior;
  if (!options.automatic) prior.sigma = 0.0;
  if (jumps && prior.sigma > 0.0) prior.mean = kOfServo_s, prior.sigma = kOfServoSigma_s;
  return prior;
}

/// How much later the alignment found a surface's effect, and took off the stamps [s].
double aligned_by(PreparedFlight& flight, BudgetSensor surface) {
  const DelayReport* report = report_of(flight.delays, surface);
  return report != nullptr && report->applied() ? report->delay_s : 0.0;
}

/// Whether the effect of a surface comes later than what is recorded of it, by its lag or its stamps, beyond chance and
/// by more than a sample.
/// @param aligned  by how much its stamps were already found late
bool comes_later(const ManoeuvreDelays& found, BudgetSensor surface, double aligned, double step) {
  Eigen::VectorXd sign = Eigen::VectorXd::Zero(signed_index(found.errors.size()));
  double later = aligned;
  for (std::size_t i = 0; i < found.errors.size(); ++i) {
    const SensorError& e = found.errors[i];
    if (e.sensor != surface) continue;
    sign(signed_index(i)) = e.kind == SensorErrorKind::kLag ? 1.0 : -1.0;
    later += sign(signed_index(i)) * e.mean;
  }
  return later > std::max(step, estimation::kBeyondChance * std::sqrt(sign.dot(found.covariance * sign)));
}

/// A servo without lag jumps between two samples. When is not known, and the regression takes the effect of each jump
/// out (`take_out_jumps`): neither do its rows show a delay, nor does one matter to them.
bool jumps(const FlightSignals& signals, BudgetSensor sensor) {
  return std::ranges::any_of(signals.jumps, [&](const DeflectionJump& jump) {
    return std::ranges::find(signals_of(sensor), jump.control) != signals_of(sensor).end();
  });
}

void take_off(PreparedFlight& flight, const SensorError& error) {
  const std::string name(kBudgetSensorNames[error.sensor]);
  recording::take_off_delay(flight.aligned.recording, {name}, error.mean);
  DelayReport* report = report_of(flight.delays, error.sensor);
  if (report == nullptr) return;
  const double aligned = report->applied() ? report->delay_s : 0.0;
  // Of a surface the report says how much later its effect is.
  report->delay_s = aligned + (is_surface(error.sensor) ? -error.mean : error.mean);
  report->sigma_s = error.sigma;
  if (report->finding != recording::DelayFinding::kGiven) report->finding = recording::DelayFinding::kApplied;
}

}  // namespace

void align_by_manoeuvres(PreparedFlight& flight, const Subject& subject, const DelayAlignment& options,
                         const KnownSensors& known) {
  using enum BudgetSensor;
  const Recording& recording = flight.aligned.recording;
  for (const Axis axis : {Axis::kLongitudinal, Axis::kLateral}) {
    std::vector<SensorError> priors, not_aligned;
    for (const BudgetSensor sensor : axis == Axis::kLongitudinal
                                         ? std::vector{kAlpha, kElevator, kAccelerometer}
                                         : std::vector{kBeta, kAileron, kRudder, kAccelerometer})
      if (sensor == kAccelerometer || recording.has(kBudgetSensorNames[sensor])) {
        const DelayReport* report = report_of(flight.delays, sensor);
        if (is_surface(sensor)) priors.push_back(lag_of(sensor, jumps(flight.signals, sensor), options, known));
        // The other start is that of a surface without a lag.
        if (is_surface(sensor)) not_aligned.push_back({sensor, SensorErrorKind::kLag, 0.0, 0.0});
        priors.push_back(after_alignment(prior_about_stamps(sensor, options, known), report));
        not_aligned.push_back(priors.back());
        if (report != nullptr && report->finding == recording::DelayFinding::kApplied)
          not_aligned.back().mean = is_surface(sensor) ? report->delay_s : -report->delay_s;
      }
    const AxisSegments& segments = flight.segments.of(axis);
    ManoeuvreDelays found = delays_by_manoeuvres(flight.signals, segments, subject, priors, not_aligned);
    const auto jumps_only = [&](const SensorError& e) {
      return is_surface(e.sensor) && jumps(flight.signals, e.sensor) &&
             !comes_later(found, e.sensor, aligned_by(flight, e.sensor), flight.signals.grid.step);
    };
    // A surface does not lead what is recorded of it: then that is a position, and the lag none.
    const auto leads = [&](const SensorError& e) {
      const auto lag = std::ranges::find_if(
          found.errors, [&](const SensorError& f) { return f.sensor == e.sensor && f.kind == e.kind; });
      return e.kind == SensorErrorKind::kLag && lag != found.errors.end() && lag->mean < 0.0;
    };
    if (std::erase_if(priors, [&](const SensorError& e) { return jumps_only(e) || leads(e); }) > 0)
      found = delays_by_manoeuvres(flight.signals, segments, subject, priors, not_aligned);
    // The accelerometer's is a nuisance here: it is one for both axes.
    const auto last = std::ranges::find(found.errors, kAccelerometer, &SensorError::sensor);
    const Eigen::Index count = last - found.errors.begin();
    found.errors.resize(at(count));
    for (SensorError& error : found.errors) {
      if (error.kind != kDelay) continue;
      take_off(flight, error);
      error.mean = 0.0;
    }
    flight.budget.add(found.errors, found.covariance.topLeftCorner(count, count));
  }
  std::vector<SensorError> others{prior_about_stamps(kAccelerometer, options, known)};
  if (recording.has("airspeed") || recording.has("dynamic_pressure"))
    others.push_back(
        after_alignment(prior_about_stamps(kAirspeed, options, known), report_of(flight.delays, kAirspeed)));
  flight.budget.add(others);
}

std::vector<std::string> lag_notes(const SensorBudget& budget) {
  std::vector<std::string> notes;
  for (const SensorError& e : budget.errors)
    if (e.kind == SensorErrorKind::kLag && e.mean > 2.0 * e.sigma)
      notes.push_back(
          fmt::format("{}: what is recorded seems to be a command, which the surface follows with a lag of {:.3f} +- "
                      "{:.3f} s; it is taken into account",
                      kBudgetSensorNames[e.sensor], e.mean, e.sigma));
  return notes;
}

}  // namespace veridyn::aircraft
