#include "veridyn/aircraft/identification/evidence/contradicted_flight.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/recording/grid_signals.hpp"
#include "veridyn/recording/segments.hpp"

namespace veridyn::aircraft {
namespace {

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

/// Whether a row has found a sensor wrong that the contradiction is about.
bool is_cause(const FlightEvidence& evidence, const Contradiction& contradiction) {
  static constexpr std::array<std::string_view, 2> kOfAttitude{"gyro", "attitude"};
  static constexpr std::array<std::string_view, 3> kOfVelocity{"accelerometer", "attitude", "ground velocity"};
  if (evidence.row.outcome != estimation::Outcome::kFailed) return false;
  const auto among = [&](const auto& sensors) {
    return std::ranges::find(sensors, evidence.row.about) != sensors.end();
  };
  if (contradiction.against == "gyro") return among(kOfAttitude);
  // A wrong gyro turns the attitude away too.
  return among(kOfVelocity) || evidence.row.about == "gyro";
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

FlightEvidence contradiction_row(const Contradiction& contradiction, double limit_s,
                                 std::span<const FlightEvidence> causes) {
  const auto cause =
      std::ranges::find_if(causes, [&](const FlightEvidence& evidence) { return is_cause(evidence, contradiction); });
  const bool named = cause != causes.end();
  return {{.name = "dead reckoning",
           .about = named ? cause->row.about : contradiction.channel,
           .outcome = estimation::Outcome::kFailed,
           .value = contradiction.span.duration(),
           .limit = limit_s,
           .scale = "s",
           .text = contradiction.statement,
           .bears_on = estimation::kAllPurposes,
           .advice = named ? fmt::format("mend what the row \"{}\" says of the {}", cause->row.name, cause->row.about)
                           : fmt::format("check unit, sign, axes, zero and stamps of {} and of what it contradicts, or "
                                         "leave out what follows: data.to = {:.0f}",
                                         contradiction.channel, std::floor(contradiction.span.begin))}};
}

}  // namespace veridyn::aircraft
