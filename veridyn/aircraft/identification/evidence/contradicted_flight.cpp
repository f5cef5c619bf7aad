#include "veridyn/aircraft/identification/evidence/contradicted_flight.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/recording/grid_signals.hpp"
#include "veridyn/recording/segments.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Cause;
using estimation::Check;
using estimation::Evidence;
using estimation::Outcome;

std::vector<double> recorded_speed(const Recording& recording, const numerics::UniformGrid& grid) {
  const auto on_grid = [&](const char* name) { return recording::on_grid(recording.at(name), grid); };
  if (recording.has("airspeed")) return on_grid("airspeed");
  if (recording.has("dynamic_pressure")) {
    constexpr double kSeaLevelDensity = 1.225;
    std::vector<double> speed = on_grid("dynamic_pressure");
    for (double& v : speed) v = std::sqrt(2.0 * std::fmax(0.0, v) / kSeaLevelDensity);
    return speed;
  }
  std::vector<double> speed = on_grid("vel_north");
  const std::vector<double> east = on_grid("vel_east");
  for (std::size_t i = 0; i < speed.size(); ++i) speed[i] = std::hypot(speed[i], east[i]);
  return speed;
}

/// The sensors whose rows may be the cause of dead reckoning.
enum class Suspect { kGyro, kAttitude, kAccelerometer, kGroundVelocity };
constexpr std::array<std::pair<std::string_view, Suspect>, 4> kSuspects{
    {{"gyro", Suspect::kGyro},
     {"attitude", Suspect::kAttitude},
     {"accelerometer", Suspect::kAccelerometer},
     {"ground velocity", Suspect::kGroundVelocity}}};

std::optional<Suspect> suspect_of(const Evidence& row) {
  const auto found = std::ranges::find(kSuspects, row.about, &std::pair<std::string_view, Suspect>::first);
  return found == kSuspects.end() ? std::nullopt : std::optional(found->second);
}

/// Whether a row has found a sensor wrong that the contradiction is about.
bool is_cause(const Evidence& row, const Contradiction& contradiction) {
  const std::optional<Suspect> suspect = suspect_of(row);
  if ((row.outcome != Outcome::kFailed && row.outcome != Outcome::kCare) || !suspect) return false;
  // A wrong gyro turns the attitude away, and with it the force.
  return !contradiction.by_gyro || *suspect == Suspect::kGyro || *suspect == Suspect::kAttitude;
}

}  // namespace

Segments recorded_flight(const Recording& recording, double min_airspeed_mps) {
  constexpr double kStep_s = 0.1, kMerge_s = 2.0;
  const TimeSpan span = recording.at("gyro_x").span();
  const numerics::UniformGrid grid = numerics::UniformGrid::covering(span.begin, span.end, kStep_s);
  const std::vector<double> speed = recorded_speed(recording, grid);
  Segments segments;
  segments.airborne = recording::merged(
      recording::stretches(grid, grid.count, [&](std::size_t k) { return speed[k] > min_airspeed_mps; }), kMerge_s);
  return segments;
}

Evidence contradiction_row(const Contradiction& contradiction, double limit_s, std::span<const Evidence> causes) {
  // The worst of them: a sensor that is wrong with care only is refused as well.
  const Evidence* cause = nullptr;
  for (const Evidence& row : causes)
    if (is_cause(row, contradiction) && (cause == nullptr || row.outcome > cause->outcome)) cause = &row;
  const bool named = cause != nullptr;
  Evidence row =
      estimation::row_of(Check::kDeadReckoning, named ? cause->about : contradiction.channel, Outcome::kFailed);
  row.value = contradiction.span.duration();
  row.limit = limit_s;
  row.with("statement", contradiction.statement).with("channel", contradiction.channel);
  row.with("end", std::floor(contradiction.span.begin));
  if (named) {
    row.cause = cause->cause == Cause::kNone ? Cause::kScale : cause->cause;
    row.with("because", std::string(estimation::name_of(*cause)));
  }
  return row;
}

}  // namespace veridyn::aircraft
