#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "veridyn/aircraft/identification/open_loop.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Evidence;
using estimation::Outcome;
using estimation::Purpose;

/// Periods that a forecast has to hold: with care below the first, failed below the second where the error is large.
constexpr double kCarePeriods = 10.0, kFailedPeriods = 3.0;
/// Errors that are large, over the motion's standard deviation: where the air is known, and where gusts may have moved
/// the aircraft, which the model was not given.
constexpr double kLargeError = 0.25, kLargeErrorInGusts = 3.3;

/// How long a state was forecast, in periods, and what that amounts to.
struct Horizon {
  const OpenLoopState* state;
  double periods;
  Outcome outcome;
};

Horizon horizon_of(const OpenLoopState& state, double period_s, bool air_known) {
  const double periods = state.horizon_s / period_s;
  const bool to_the_end = 2 * state.held > state.windows;
  const bool large = state.normalised_rmse > (air_known ? kLargeError : kLargeErrorInGusts);
  const Outcome left = periods < kFailedPeriods && large ? Outcome::kFailed : Outcome::kCare;
  return {&state, periods, periods >= kCarePeriods ? Outcome::kPassed : to_the_end ? Outcome::kNotVerified : left};
}

/// The horizon of an axis by its worst state; nothing where it has no period or was not flown.
std::optional<Evidence> horizon_row(const OpenLoop& flown, Axis axis) {
  const bool longitudinal = axis == Axis::kLongitudinal;
  const std::optional<double>& period = longitudinal ? flown.short_period_s : flown.dutch_roll_s;
  std::vector<Horizon> all;
  if (!period) return std::nullopt;
  for (const OpenLoopState& state : flown.states)
    if (state.axis == axis) all.push_back(horizon_of(state, *period, flown.air_known));
  if (all.empty()) return std::nullopt;
  const Horizon& worst = *std::ranges::min_element(all, [](const Horizon& a, const Horizon& b) {
    return a.outcome != b.outcome ? a.outcome > b.outcome : a.periods < b.periods;
  });
  const char* motion = longitudinal ? "short-period motion" : "Dutch roll";
  const double horizon = worst.state->horizon_s;
  const bool left = worst.outcome == Outcome::kCare || worst.outcome == Outcome::kFailed;
  const std::string what =
      left ? fmt::format(
                 "leaves the 95 % band of {} after {:.1f} s, and misses it by {:.2f} times what the motion "
                 "varies",
                 worst.state->name, horizon, worst.state->normalised_rmse)
      : worst.outcome == Outcome::kNotVerified
          ? fmt::format("stays within its bands to the end of its windows, which are short ({:.1f} s)", horizon)
          : fmt::format("stays within its bands for {:.1f} s", horizon);
  return Evidence{
      .name = "open loop horizon",
      .about = to_string(axis),
      .outcome = worst.outcome,
      .value = worst.periods,
      .limit = kCarePeriods,
      .scale = longitudinal ? "short periods" : "Dutch rolls",
      .text = fmt::format("{}: integrated from deflections and thrust alone, the model {}: {:.1f} periods of the {}",
                          to_string(axis), what, worst.periods, motion),
      .bears_on = Purpose::kPrediction,
      .advice = !left ? ""
                : !flown.air_known
                    ? "record the ground velocity, so that gusts can be an input, or say that the air was calm "
                      "(validate.open_loop_gusts = false)"
                : worst.state->normalised_rmse < kLargeError
                    ? "trust its forecasts as far as the error found, not its "
                      "bands: these know parameters and sensors, not the gusts "
                      "that the reconstruction misses"
                    : "see in the report in which manoeuvre it leaves; a term "
                      "may be missing (identify.structure), or an air-data "
                      "sensor be wrong"};
}

}  // namespace

std::vector<Evidence> open_loop_evidence(const OpenLoop& flown) {
  std::vector<Evidence> rows;
  for (const Axis axis : {Axis::kLongitudinal, Axis::kLateral})
    if (std::optional<Evidence> row = horizon_row(flown, axis)) rows.push_back(std::move(*row));
  for (const OpenLoopState& state : flown.states) {
    const bool better = state.normalised_rmse <= 1.0;
    rows.push_back({.name = "open loop against the mean",
                    .about = state.name,
                    .outcome = estimation::passed_or(better, Outcome::kCare),
                    .value = state.normalised_rmse,
                    .limit = 1.0,
                    .scale = "error over the motion's standard deviation",
                    .text = fmt::format("flown open loop for up to {:.0f} s, the model misses {} by {:.2g} {} (RMSE), "
                                        "{:.2f} times what the motion varies{}",
                                        flown.options.duration_s, state.name, state.fit.rmse, state.unit,
                                        state.normalised_rmse, better ? "" : ": its mean is nearer"),
                    .bears_on = Purpose::kPrediction});
  }
  const auto diverged = std::ranges::count(flown.windows, true, &OpenLoopWindow::diverged);
  if (!flown.windows.empty())
    rows.push_back({.name = "open loop divergence",
                    .outcome = estimation::passed_or(diverged == 0, Outcome::kFailed),
                    .value = static_cast<double>(diverged),
                    .limit = 0.0,
                    .scale = "windows",
                    .text = fmt::format("{} of {} windows left the range of the model (80 deg, 2 m/s) open loop",
                                        diverged, flown.windows.size()),
                    .bears_on = Purpose::kPrediction});
  return rows;
}

}  // namespace veridyn::aircraft
