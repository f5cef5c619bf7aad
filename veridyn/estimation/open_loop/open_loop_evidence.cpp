#include "veridyn/estimation/open_loop/open_loop_evidence.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/estimation/open_loop/open_loop_scores.hpp"

namespace veridyn::estimation {
namespace {

/// How long a state was forecast, in periods, and what that amounts to.
struct Held {
  const OpenLoopState* state;
  double periods;
  Outcome outcome;
};

Held held(const OpenLoopState& state, const OpenLoopHorizon& horizon) {
  const double periods = state.horizon_s / horizon.period_s;
  const bool to_the_end = 2 * state.held > state.windows;
  const bool large = state.normalised_rmse > horizon.large_error;
  const Outcome left = periods < kFailedPeriods && large ? Outcome::kFailed : Outcome::kCare;
  return {&state, periods, periods >= kCarePeriods ? Outcome::kPassed : to_the_end ? Outcome::kNotVerified : left};
}

}  // namespace

std::optional<Evidence> open_loop_horizon(const OpenLoop& open_loop, const OpenLoopHorizon& horizon) {
  std::vector<Held> all;
  for (const OpenLoopState& state : open_loop.states)
    if (state.group == horizon.group) all.push_back(held(state, horizon));
  if (all.empty()) return std::nullopt;
  const Held& worst = *std::ranges::min_element(all, [](const Held& a, const Held& b) {
    return a.outcome != b.outcome ? a.outcome > b.outcome : a.periods < b.periods;
  });
  const OpenLoopState& state = *worst.state;
  const bool left = worst.outcome == Outcome::kCare || worst.outcome == Outcome::kFailed;
  const std::string what =
      left ? fmt::format(
                 "leaves the 95 % band of {} after {:.1f} s, and misses it by {:.2f} times what the motion varies",
                 state.name, state.horizon_s, state.normalised_rmse)
      : worst.outcome == Outcome::kNotVerified
          ? fmt::format("stays within its bands to the end of its windows, which are short ({:.1f} s)", state.horizon_s)
          : fmt::format("stays within its bands for {:.1f} s", state.horizon_s);
  return Evidence{
      .name = "open loop horizon",
      .about = horizon.group,
      .outcome = worst.outcome,
      .value = worst.periods,
      .limit = kCarePeriods,
      .scale = horizon.scale,
      .text = fmt::format("{}{}integrated from {} alone, the model {}: {:.1f} periods of the {}", horizon.group,
                          horizon.group.empty() ? "" : ": ", open_loop.inputs, what, worst.periods, horizon.motion),
      .bears_on = Purpose::kPrediction,
      .advice = !left                                 ? ""
                : state.normalised_rmse < kLargeError ? horizon.advice_small
                                                      : horizon.advice_large};
}

std::vector<Evidence> open_loop_errors(const OpenLoop& open_loop, const std::string& range) {
  std::vector<Evidence> rows;
  for (const OpenLoopState& state : open_loop.states) {
    const bool better = state.normalised_rmse <= 1.0;
    rows.push_back(
        {.name = "open loop against the mean",
         .about = state.name,
         .outcome = passed_or(better, Outcome::kCare),
         .value = state.normalised_rmse,
         .limit = 1.0,
         .scale = "error over the motion's standard deviation",
         .text = fmt::format("integrated open loop for up to {:.0f} s, the model misses {} by {:.2g} {} (RMSE), "
                             "{:.2f} times what the motion varies{}",
                             open_loop.times.duration_s, state.name, state.fit.rmse, state.unit, state.normalised_rmse,
                             better ? "" : ": its mean is nearer"),
         .bears_on = Purpose::kPrediction});
  }
  const std::size_t diverged = diverged_windows(open_loop);
  if (!open_loop.windows.empty())
    rows.push_back({.name = "open loop divergence",
                    .outcome = passed_or(diverged == 0, Outcome::kFailed),
                    .value = static_cast<double>(diverged),
                    .limit = 0.0,
                    .scale = "windows",
                    .text = fmt::format("{} of {} windows left the range of the model ({}) open loop", diverged,
                                        open_loop.windows.size(), range),
                    .bears_on = Purpose::kPrediction});
  return rows;
}

}  // namespace veridyn::estimation
