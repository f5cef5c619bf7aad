#include "veridyn/estimation/open_loop/open_loop_evidence.hpp"

#include <optional>
#include <utility>

#include "veridyn/aircraft/identification/validation/open_loop.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Evidence;

/// Errors that are large, over the motion's standard deviation, where gusts may have moved the aircraft, which the
/// model was not given.
constexpr double kLargeErrorInGusts = 3.3;

/// The horizon of an axis by its worst state; nothing where it has no period or was not flown.
std::optional<Evidence> horizon_row(const OpenLoop& flown, Axis axis) {
  const bool longitudinal = axis == Axis::kLongitudinal;
  const std::optional<double>& period = longitudinal ? flown.short_period_s : flown.dutch_roll_s;
  if (!period) return std::nullopt;
  estimation::OpenLoopHorizon horizon{.group = to_string(axis),
                                      .period_s = *period,
                                      .motion = longitudinal ? "short-period motion" : "Dutch roll",
                                      .air_known = flown.air_known};
  if (!flown.air_known) horizon.large_error = kLargeErrorInGusts;
  return estimation::open_loop_horizon(flown, horizon);
}

}  // namespace

std::vector<Evidence> open_loop_evidence(const OpenLoop& flown) {
  std::vector<Evidence> rows;
  for (const Axis axis : {Axis::kLongitudinal, Axis::kLateral})
    if (std::optional<Evidence> row = horizon_row(flown, axis)) rows.push_back(std::move(*row));
  for (Evidence& row : estimation::open_loop_errors(flown, "80 deg, 2 m/s")) rows.push_back(std::move(row));
  return rows;
}

}  // namespace veridyn::aircraft
