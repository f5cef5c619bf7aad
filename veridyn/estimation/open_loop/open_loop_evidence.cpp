#include "veridyn/estimation/open_loop/open_loop_evidence.hpp"

#include <algorithm>
#include <utility>

#include "veridyn/estimation/judgement/check.hpp"
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
  const Tolerance& tolerance = info_of(Check::kOpenLoopHorizon).tolerance;
  const double periods = state.horizon_s / horizon.period_s;
  const bool to_the_end = 2 * state.held > state.windows;
  const bool large = state.normalised_rmse > horizon.large_error;
  const Outcome left = periods < tolerance.lowest && large ? Outcome::kFailed : Outcome::kCare;
  return {&state, periods, periods >= tolerance.low ? Outcome::kPassed : to_the_end ? Outcome::kNotVerified : left};
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
  const Tolerance& tolerance = info_of(Check::kOpenLoopHorizon).tolerance;
  Evidence row = row_of(Check::kOpenLoopHorizon, horizon.group, worst.outcome);
  row.value = worst.periods;
  row.limit = worst.outcome == Outcome::kFailed ? tolerance.lowest : tolerance.low;
  if (worst.outcome == Outcome::kCare || worst.outcome == Outcome::kFailed)
    row.cause = !horizon.air_known                    ? Cause::kMissing
                : state.normalised_rmse < kLargeError ? Cause::kNoise
                                                      : Cause::kMissingTerm;
  return std::move(row)
      .with("inputs", open_loop.inputs)
      .with("state", state.name)
      .with("horizon_s", state.horizon_s)
      .with("error", state.normalised_rmse)
      .with("motion", horizon.motion);
}

std::vector<Evidence> open_loop_errors(const OpenLoop& open_loop, const std::string& range) {
  std::vector<Evidence> rows;
  for (const OpenLoopState& state : open_loop.states)
    rows.push_back(row_of(Check::kOpenLoopAgainstMean, state.name, state.normalised_rmse)
                       .with("duration_s", open_loop.times.duration_s)
                       .with("rmse", state.fit.rmse)
                       .with("unit", state.unit));
  if (!open_loop.windows.empty())
    rows.push_back(row_of(Check::kOpenLoopDivergence, "", static_cast<double>(diverged_windows(open_loop)))
                       .with("windows", static_cast<double>(open_loop.windows.size()))
                       .with("range", range));
  return rows;
}

}  // namespace veridyn::estimation
